#include "tests/support/reference_simulator.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/image/models.h"

namespace tectum::test {
namespace {

struct Neuron {
  double v = 0;
  double u = 0;                             // Izhikevich recovery, alif adaptation
  std::vector<double> current;              // by receptor
  std::vector<std::vector<double>> window;  // boxcar: the last k ticks' input, newest last
  long refractory_ticks = 0;
};

class Reference {
 public:
  explicit Reference(const TestNetwork& network) : network_(network) {
    for (std::size_t p = 0; p < network.populations.size(); ++p) {
      const ModelPhysics& physics = network.populations[p].physics;
      for (std::uint32_t i = 0; i < physics.size; ++i) {
        Neuron neuron;
        neuron.current.resize(physics.receptors.size());
        neuron.window.resize(physics.receptors.size());
        neuron.v = initial_v(physics, i);
        neuron.u = physics.model == ModelKind::Izhikevich
                       ? get(physics, i, "u_init", get(physics, i, "b", 0.2) * neuron.v)
                       : 0.0;
        neurons_.push_back(std::move(neuron));
      }
    }
    fired_.resize(neurons_.size());
    for (const TestSynapse& synapse : network.synapses) {
      longest_ = std::max(longest_, synapse.delay_ticks);
    }
  }

  ReferenceRun run(std::uint64_t ticks);

 private:
  static double get(const ModelPhysics& physics, std::uint32_t i, const char* name, double fallback) {
    const auto found = physics.parameters.find(name);
    if (found == physics.parameters.end()) {
      return fallback;
    }
    return found->second.size() == 1 ? found->second[0] : found->second[i];
  }
  static double initial_v(const ModelPhysics& physics, std::uint32_t i) {
    if (physics.model == ModelKind::Izhikevich) {
      return get(physics, i, "V_init", get(physics, i, "c", -65));
    }
    return find_model(physics.model)->may_sleep ? get(physics, i, "V_init", get(physics, i, "E_L", -70)) : 0.0;
  }

  double arrived(std::uint32_t neuron, std::size_t receptor, std::uint64_t tick) const;
  double point_input(Neuron& neuron, const ModelPhysics& physics, std::uint32_t n, std::uint64_t tick) const;
  bool update_membrane(const ModelPhysics& physics, std::uint32_t i, std::uint32_t n, std::uint64_t tick);
  bool update_izhikevich(const ModelPhysics& physics, std::uint32_t i, std::uint32_t n, std::uint64_t tick);
  bool update_threshold(const ModelPhysics& physics, std::uint32_t i, std::uint32_t n, std::uint64_t tick);
  bool update(std::size_t p, std::uint32_t i, std::uint32_t n, std::uint64_t tick);

  const TestNetwork& network_;
  std::vector<Neuron> neurons_;
  std::vector<std::vector<bool>> fired_;  // [neuron][tick]
  std::uint32_t longest_ = 0;
};

double Reference::arrived(std::uint32_t neuron, std::size_t receptor, std::uint64_t tick) const {
  double sum = 0;
  for (const TestSynapse& synapse : network_.synapses) {
    if (synapse.post == neuron && synapse.receptor == receptor && synapse.delay_ticks <= tick &&
        fired_[synapse.pre][tick - synapse.delay_ticks]) {
      sum += synapse.weight;
    }
  }
  return sum;
}

double Reference::point_input(Neuron& neuron, const ModelPhysics& physics, std::uint32_t n, std::uint64_t tick) const {
  double sum = 0;
  for (std::size_t r = 0; r < physics.receptors.size(); ++r) {
    const ReceptorPhysics& receptor = physics.receptors[r];
    const double input = arrived(n, r, tick);
    if (receptor.kind == ReceptorKind::Exponential) {
      neuron.current[r] = neuron.current[r] * std::exp(-network_.tick_ms / receptor.tau_ms) + input;
      sum += neuron.current[r];
    } else {
      const std::size_t window = receptor.kind == ReceptorKind::Boxcar ? receptor.window_ticks : 1;
      neuron.window[r].push_back(input);
      if (neuron.window[r].size() > window) {
        neuron.window[r].erase(neuron.window[r].begin());
      }
      sum += std::accumulate(neuron.window[r].begin(), neuron.window[r].end(), 0.0);
    }
  }
  return sum;
}

bool Reference::update_membrane(const ModelPhysics& physics, std::uint32_t i, std::uint32_t n, std::uint64_t tick) {
  Neuron& neuron = neurons_[n];
  const double h = network_.tick_ms;
  const double tau_m = get(physics, i, "tau_m", 20);
  const double r_m = get(physics, i, "R_m", 10);
  const double rest = get(physics, i, "E_L", -70) + r_m * get(physics, i, "I_bias", 0);
  const double decay = std::exp(-h / tau_m);
  // A unit current's share in v after one tick.
  const auto gain = [&](double tau) {
    return std::abs(tau - tau_m) < 1e-9 ? r_m * h / tau_m * decay
                                        : r_m * tau / (tau - tau_m) * (std::exp(-h / tau) - decay);
  };
  double v = rest + (neuron.v - rest) * decay;
  if (physics.model == ModelKind::Alif) {
    const double tau_w = get(physics, i, "tau_w", 100);
    v -= gain(tau_w) * neuron.u;
    neuron.u *= std::exp(-h / tau_w);
  }
  for (std::size_t r = 0; r < physics.receptors.size(); ++r) {
    if (physics.model == ModelKind::LifDelta) {
      v += arrived(n, r, tick);
    } else {
      v += gain(physics.receptors[r].tau_ms) * neuron.current[r];
      neuron.current[r] = neuron.current[r] * std::exp(-h / physics.receptors[r].tau_ms) + arrived(n, r, tick);
    }
  }
  const double reset = get(physics, i, "V_reset", -65);
  neuron.v = v;
  if (neuron.refractory_ticks > 0) {
    --neuron.refractory_ticks;
    neuron.v = reset;
    return false;
  }
  if (v < get(physics, i, "V_th", -50)) {
    return false;
  }
  neuron.v = reset;
  neuron.refractory_ticks = std::lround(get(physics, i, "t_ref", 2) / h);
  neuron.u += physics.model == ModelKind::Alif ? get(physics, i, "b_w", 0.1) : 0;
  return true;
}

bool Reference::update_izhikevich(const ModelPhysics& physics, std::uint32_t i, std::uint32_t n, std::uint64_t tick) {
  Neuron& neuron = neurons_[n];
  const auto p = [&](const char* name, double fallback) { return get(physics, i, name, fallback); };
  double input = point_input(neuron, physics, n, tick) + p("I_bias", 0);
  if (p("rectify", 0) != 0) {
    input = std::max(input, 0.0);
  }
  const double h = network_.tick_ms * p("time_scale", 1);
  const double v = neuron.v;
  neuron.v = v + h * (p("k2", 0.04) * (v * v) + p("k1", 5) * v + p("k0", 140) - neuron.u + input);
  neuron.u += h * (p("a", 0.02) * (p("b", 0.2) * neuron.v - neuron.u));
  if (neuron.v > p("V_peak", 30)) {
    neuron.v = p("c", -65);
    neuron.u += p("d", 8);
    return true;
  }
  return false;
}

bool Reference::update_threshold(const ModelPhysics& physics, std::uint32_t i, std::uint32_t n, std::uint64_t tick) {
  Neuron& neuron = neurons_[n];
  const double input = point_input(neuron, physics, n, tick);
  if (neuron.refractory_ticks > 0) {
    --neuron.refractory_ticks;
    return false;
  }
  if (input >= get(physics, i, "theta", 1)) {
    neuron.refractory_ticks = std::lround(get(physics, i, "t_ref", 0) / network_.tick_ms);
    return true;
  }
  return false;
}

bool Reference::update(std::size_t p, std::uint32_t i, std::uint32_t n, std::uint64_t tick) {
  const TestPopulation& population = network_.populations[p];
  switch (population.physics.model) {
    case ModelKind::LifDelta:
    case ModelKind::LifExp:
    case ModelKind::Alif:
      return update_membrane(population.physics, i, n, tick);
    case ModelKind::Izhikevich:
      return update_izhikevich(population.physics, i, n, tick);
    case ModelKind::Threshold:
      return update_threshold(population.physics, i, n, tick);
    default:
      return std::find(population.spikes.begin(), population.spikes.end(),
                       std::pair{static_cast<std::uint32_t>(tick), i}) != population.spikes.end();
  }
}

ReferenceRun Reference::run(std::uint64_t ticks) {
  ReferenceRun result;
  std::vector<std::uint32_t> order = network_.update_order;
  if (order.empty()) {
    order.resize(network_.populations.size());
    std::iota(order.begin(), order.end(), 0U);
  }
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    for (auto& history : fired_) {
      history.push_back(false);
    }
    for (const std::uint32_t p : order) {
      const std::uint32_t first = network_.first_neuron(p);
      for (std::uint32_t i = 0; i < network_.populations[p].physics.size; ++i) {
        fired_[first + i][tick] = update(p, i, first + i, tick);
      }
    }
    result.v_mv.emplace_back();
    for (std::uint32_t n = 0; n < neurons_.size(); ++n) {
      result.v_mv.back().push_back(neurons_[n].v);
      if (fired_[n][tick]) {
        result.raster.emplace_back(tick, n);
      }
    }
  }
  return result;
}

}  // namespace

ReferenceRun run_reference(const TestNetwork& network, std::uint64_t ticks) { return Reference(network).run(ticks); }

}  // namespace tectum::test
