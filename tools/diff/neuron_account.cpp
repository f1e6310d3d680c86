#include "tools/diff/neuron_account.h"

#include <algorithm>
#include <cmath>

namespace tectum {
namespace {

/// One current of a membrane over one tick:  I <- decay I + arrivals;  v gains `gain` times what I was before.
struct Current {
  double decay = 0;
  double gain = 0;
};

/// tau_m dv/dt = -v + R_m I,  tau_r dI/dt = -I  over h: Rotter & Diesmann 1999, doi:10.1007/s004220050570.
Current exponential_current(double tau_m_ms, double resistance_mohm, double tau_ms, double h_ms) {
  const double leak = std::exp(-h_ms / tau_m_ms), decay = std::exp(-h_ms / tau_ms);
  const bool is_equal = std::abs(tau_m_ms - tau_ms) < 1e-9 * tau_m_ms;
  return {decay, is_equal ? resistance_mohm * h_ms / tau_m_ms * leak
                          : resistance_mohm * tau_ms / (tau_m_ms - tau_ms) * (leak - decay)};
}

/// Arrivals of one input, summed by tick, in ticks [0, last].
std::vector<double> arrivals_by_tick(const PathwayInput& input, std::uint32_t last) {
  std::vector<double> sums(std::size_t{last} + 1, 0.0);
  for (const Arrival& arrival : input.arrivals) {
    if (arrival.tick <= last) {
      sums[arrival.tick] += arrival.weight;
    }
  }
  return sums;
}

std::uint32_t refractory_ticks(const NeuronSetup& setup) {
  return static_cast<std::uint32_t>(std::llround(setup.value("t_ref") / setup.tick_ms));
}

/// What a receptor makes of the arrivals, at one tick, without a membrane behind it.
double input_now(const ReceptorView& receptor, const PathwayInput& input, std::uint32_t tick, double tick_ms) {
  double sum = 0;
  for (const Arrival& arrival : input.arrivals) {
    if (arrival.tick > tick) {
      continue;
    }
    const std::uint32_t age = tick - arrival.tick;
    switch (receptor.kind) {
      case ReceptorKind::Instantaneous:
        sum += age == 0 ? arrival.weight : 0;
        break;
      case ReceptorKind::Boxcar:
        sum += age < receptor.window_ticks ? arrival.weight : 0;
        break;
      case ReceptorKind::Exponential:
        sum += arrival.weight * std::exp(-age * tick_ms / receptor.tau_ms);
        break;
    }
  }
  return sum;
}

class MembraneAccount {
 public:
  MembraneAccount(const NeuronSetup& setup, std::uint32_t tick) : setup_(setup), tick_(tick) {
    const double tau_m_ms = setup.value("tau_m"), resistance = setup.value("R_m");
    leak_ = std::exp(-setup.tick_ms / tau_m_ms);
    rest_mv_ = setup.value("E_L") + resistance * setup.value("I_bias");
    for (const ReceptorView& receptor : setup.receptors) {
      receptors_.push_back(receptor.kind == ReceptorKind::Exponential
                               ? exponential_current(tau_m_ms, resistance, receptor.tau_ms, setup.tick_ms)
                               : Current{});
    }
    if (setup.model == "alif") {
      adaptation_ = exponential_current(tau_m_ms, resistance, setup.value("tau_w"), setup.tick_ms);
    }
  }

  NeuronAccount run() {
    account_.has_potential = true;
    account_.unit = "mV";
    account_.threshold = setup_.value("V_th");
    account_.shares.resize(setup_.inputs.size());
    for (const PathwayInput& input : setup_.inputs) {
      arrivals_.push_back(arrivals_by_tick(input, tick_));
    }
    own_mv_ = setup_.value("V_init") - rest_mv_;
    const std::uint32_t silent_ticks = refractory_ticks(setup_);
    std::size_t next_spike = 0;
    std::uint32_t silent_left = 0;
    for (std::uint32_t t = 0; t <= tick_; ++t) {
      step(t);
      const bool is_last = t == tick_;
      account_.is_refractory = silent_left > 0;
      const bool fired = next_spike < setup_.own_spikes.size() && setup_.own_spikes[next_spike] == t;
      if (silent_left > 0 || (fired && !is_last)) {
        reset();
      }
      silent_left -= silent_left > 0 ? 1U : 0U;
      if (fired) {
        ++next_spike;
        silent_left = silent_ticks;
        adaptation_now_ += setup_.value("b_w");
      }
    }
    account_.own = rest_mv_ + own_mv_;
    account_.potential = account_.own;
    for (const InputShare& share : account_.shares) {
      account_.potential += share.potential;
    }
    return std::move(account_);
  }

 private:
  void step(std::uint32_t t) {
    own_mv_ = leak_ * own_mv_ - adaptation_.gain * adaptation_now_;
    adaptation_now_ *= adaptation_.decay;
    for (std::size_t k = 0; k < arrivals_.size(); ++k) {
      InputShare& share = account_.shares[k];
      const std::uint32_t r = setup_.inputs[k].receptor;
      share.potential *= leak_;
      if (setup_.receptors[r].kind == ReceptorKind::Exponential) {
        share.potential += receptors_[r].gain * share.input;
        share.input = receptors_[r].decay * share.input + arrivals_[k][t];
      } else {  // delta synapses: the weight is a step of the potential
        share.input = arrivals_[k][t];
        share.potential += share.input;
      }
    }
  }
  void reset() {
    own_mv_ = setup_.value("V_reset") - rest_mv_;
    for (InputShare& share : account_.shares) {
      share.potential = 0;
    }
  }

  const NeuronSetup& setup_;
  std::uint32_t tick_;
  double leak_ = 0, rest_mv_ = 0, own_mv_ = 0, adaptation_now_ = 0;
  std::vector<Current> receptors_;
  Current adaptation_;
  std::vector<std::vector<double>> arrivals_;
  NeuronAccount account_;
};

bool is_membrane(const std::string& model) { return model == "lif_exp" || model == "lif_delta" || model == "alif"; }

}  // namespace

SpikeTicks spike_ticks(const std::vector<RecordedSpike>& spikes, std::uint32_t neuron_count) {
  SpikeTicks ticks(neuron_count);
  for (const RecordedSpike& spike : spikes) {
    if (spike.neuron < neuron_count) {
      ticks[spike.neuron].push_back(static_cast<std::uint32_t>(spike.tick));
    }
  }
  return ticks;
}

double NeuronSetup::value(const std::string& parameter) const {
  for (const ParameterView& own : parameters) {
    if (own.name == parameter) {
      return own.values.front();
    }
  }
  return 0;
}

NeuronSetup neuron_setup(const CircuitView& view, const SpikeTicks& spikes, std::uint32_t neuron,
                         std::uint32_t last_tick) {
  const std::uint32_t p = view.population_of(neuron);
  const PopulationView& population = view.populations[p];
  const std::uint32_t index = neuron - population.first_neuron;
  NeuronSetup setup;
  setup.model = population.model;
  setup.tick_ms = view.tick_ms();
  setup.is_silenced = std::binary_search(population.silenced.begin(), population.silenced.end(), index);
  for (const ParameterView& parameter : population.parameters) {
    setup.parameters.push_back({parameter.name, parameter.unit, {parameter.of(index)}});
  }
  setup.receptors = population.receptors;
  setup.own_spikes = spikes[neuron];
  for (std::uint32_t w = 0; w < view.pathways.size(); ++w) {
    const PathwayView& pathway = view.pathways[w];
    if (pathway.post_population != p) {
      continue;
    }
    PathwayInput input{w, pathway.receptor, {}};
    const std::uint32_t first_pre = view.populations[pathway.pre_population].first_neuron;
    for (const SynapseView& synapse : pathway.synapses) {
      if (synapse.post != index) {
        continue;
      }
      for (const std::uint32_t fired : spikes[first_pre + synapse.pre]) {
        if (fired + synapse.delay_ticks > last_tick) {
          break;
        }
        input.arrivals.push_back({fired + synapse.delay_ticks, synapse.weight, first_pre + synapse.pre});
      }
    }
    setup.inputs.push_back(std::move(input));
  }
  return setup;
}

NeuronAccount account_of(const NeuronSetup& setup, std::uint32_t tick) {
  if (is_membrane(setup.model)) {
    return MembraneAccount(setup, tick).run();
  }
  NeuronAccount account;
  for (const PathwayInput& input : setup.inputs) {
    const double now = input_now(setup.receptors[input.receptor], input, tick, setup.tick_ms);
    account.shares.push_back({now, now});
    account.potential += now;
  }
  account.has_potential = setup.model == "threshold";
  account.threshold = setup.value("theta");
  const std::uint32_t silent_ticks = refractory_ticks(setup);
  for (const std::uint32_t fired : setup.own_spikes) {
    account.is_refractory = account.is_refractory || (fired < tick && tick - fired <= silent_ticks);
  }
  return account;
}

double mean_input(const NeuronSetup& setup, const PathwayInput& input, std::uint32_t from, std::uint32_t to) {
  const ReceptorView& receptor = setup.receptors[input.receptor];
  const bool is_exponential = receptor.kind == ReceptorKind::Exponential;
  const double decay = is_exponential ? std::exp(-setup.tick_ms / receptor.tau_ms) : 0;
  const std::uint32_t lasts = receptor.kind == ReceptorKind::Boxcar ? receptor.window_ticks : 1;
  double sum = 0;
  for (const Arrival& arrival : input.arrivals) {
    if (arrival.tick >= to) {
      continue;
    }
    const std::uint32_t begin = std::max(arrival.tick, from);
    if (is_exponential) {
      sum +=
          arrival.weight * (std::pow(decay, begin - arrival.tick) - std::pow(decay, to - arrival.tick)) / (1 - decay);
    } else {
      const std::uint32_t end = std::min(arrival.tick + lasts, to);
      sum += end > begin ? arrival.weight * (end - begin) : 0;
    }
  }
  return sum / (to - from);
}

}  // namespace tectum
