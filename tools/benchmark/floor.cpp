#include "tools/benchmark/floor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/engine/group_parameters.h"
#include "runtime/engine/spike_engine.h"

namespace tectum {
namespace {

constexpr std::uint32_t kLeapTicks = 8192;  // longer leaps are as good as forever

bool is_source(ModelKind model) {
  return model == ModelKind::Poisson || model == ModelKind::SpikeList || model == ModelKind::FieldSource;
}

bool has_shared_parameters(const GroupParameters& parameters) {
  for (std::uint32_t p = 0; p < lif_parameter::kLifCount; ++p) {
    if (p != lif_parameter::kInitialV && parameters.varies(p)) {
      return false;
    }
  }
  return true;
}

// A unit current's share in v after h ms.
double gain(double tau_m_ms, double tau_ms, double h_ms) {
  return tau_ms / (tau_ms - tau_m_ms) * (std::exp(-h_ms / tau_ms) - std::exp(-h_ms / tau_m_ms));
}

struct SweepConstants {
  float decay, gain_ex, decay_ex, gain_in, decay_in, threshold, reset;
  std::int32_t refractory_ticks;
};

// All arrays apart from each other, so that the compiler makes vectors of it.
void sweep_two(const SweepConstants c, std::uint32_t size, float* __restrict v, float* __restrict ex,
               float* __restrict in, float* __restrict arrived_ex, float* __restrict arrived_in,
               std::int32_t* __restrict refractory, std::int32_t* __restrict fires) {
  for (std::uint32_t i = 0; i < size; ++i) {
    float next = c.decay * v[i] + c.gain_ex * ex[i] + c.gain_in * in[i];
    ex[i] = c.decay_ex * ex[i] + arrived_ex[i];
    in[i] = c.decay_in * in[i] + arrived_in[i];
    arrived_ex[i] = 0;
    arrived_in[i] = 0;
    const std::int32_t left = refractory[i];
    next = left > 0 ? c.reset : next;
    const std::int32_t fired = next >= c.threshold ? -1 : 0;
    v[i] = fired != 0 ? c.reset : next;
    refractory[i] = fired != 0 ? c.refractory_ticks : (left > 0 ? left - 1 : 0);
    fires[i] = fired;
  }
}

void sweep_one(const SweepConstants c, std::uint32_t size, float* __restrict v, float* __restrict ex,
               float* __restrict arrived_ex, std::int32_t* __restrict refractory, std::int32_t* __restrict fires) {
  for (std::uint32_t i = 0; i < size; ++i) {
    float next = c.decay * v[i] + c.gain_ex * ex[i];
    ex[i] = c.decay_ex * ex[i] + arrived_ex[i];
    arrived_ex[i] = 0;
    const std::int32_t left = refractory[i];
    next = left > 0 ? c.reset : next;
    const std::int32_t fired = next >= c.threshold ? -1 : 0;
    v[i] = fired != 0 ? c.reset : next;
    refractory[i] = fired != 0 ? c.refractory_ticks : (left > 0 ? left - 1 : 0);
    fires[i] = fired;
  }
}

}  // namespace

namespace {

Stimulus record(const SpikeImage& image, std::uint64_t ticks, const std::vector<bool>& is_wanted) {
  Stimulus spikes;
  spikes.begin.push_back(0);
  SpikeEngine engine(image);
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    engine.step();
    for (const NeuronId neuron : engine.spikes()) {
      if (is_wanted[static_cast<std::uint32_t>(neuron)]) {
        spikes.neurons.push_back(static_cast<std::uint32_t>(neuron));
      }
    }
    spikes.begin.push_back(static_cast<std::uint32_t>(spikes.neurons.size()));
  }
  return spikes;
}

}  // namespace

Stimulus record_stimulus(const SpikeImage& image, std::uint64_t ticks) {
  std::vector<bool> is_stimulus(image.header.neuron_count);
  for (const GroupRecord& group : image.groups) {
    std::fill_n(is_stimulus.begin() + group.first_neuron, group.size, is_source(group.model));
  }
  return record(image, ticks, is_stimulus);
}

Stimulus record_raster(const SpikeImage& image, std::uint64_t ticks) {
  return record(image, ticks, std::vector<bool>(image.header.neuron_count, true));
}

std::optional<Floor> Floor::make(const SpikeImage& image) {
  using namespace lif_parameter;
  Floor floor;
  floor.image_ = &image;
  const double h_ms = static_cast<double>(image.header.tick_ns) * 1e-6;
  std::vector<float> quantum(image.header.slot_count);
  for (const GroupRecord& record : image.groups) {
    const GroupParameters parameters(image, record);
    for (std::uint32_t r = 0; r < record.receptor_count; ++r) {
      std::fill_n(quantum.begin() + record.first_slot + r * record.size, record.size,
                  static_cast<float>(parameters.quantum(r)));
    }
    if (is_source(record.model)) {
      continue;
    }
    if (record.model != ModelKind::LifExp || record.receptor_count > 2 || !has_shared_parameters(parameters)) {
      return std::nullopt;
    }
    const double tau_m_ms = parameters.value(kTauM);
    const double r_m_mohm = parameters.value(kResistance);
    const double rest_mv = parameters.value(kRestV) + r_m_mohm * parameters.value(kBias);
    const auto relative = [&](double v_mv) { return static_cast<float>(v_mv - rest_mv); };
    const std::size_t taus = record.parameter_begin + kLifCount;
    const double tau_ex_ms = image.parameters[taus];
    const double tau_in_ms = record.receptor_count > 1 ? image.parameters[taus + 1] : 1.0;
    if (tau_ex_ms == tau_m_ms || tau_in_ms == tau_m_ms) {
      return std::nullopt;
    }
    Group group{};
    group.first_neuron = record.first_neuron;
    group.size = record.size;
    group.first_slot = record.first_slot;
    group.rest_mv = static_cast<float>(rest_mv);
    group.threshold_mv = relative(parameters.value(kThresholdV));
    group.reset_mv = relative(parameters.value(kResetV));
    group.refractory_ticks = static_cast<std::int32_t>(parameters.ticks(kRefractory));
    group.has_inhibition = record.receptor_count > 1;
    group.decay = static_cast<float>(std::exp(-h_ms / tau_m_ms));
    group.decay_ex = static_cast<float>(std::exp(-h_ms / tau_ex_ms));
    group.decay_in = static_cast<float>(std::exp(-h_ms / tau_in_ms));
    group.gain_ex = static_cast<float>(r_m_mohm * gain(tau_m_ms, tau_ex_ms, h_ms));
    group.gain_in = static_cast<float>(r_m_mohm * gain(tau_m_ms, tau_in_ms, h_ms));
    for (std::uint32_t n = 0; n < kLeapTicks; ++n) {
      group.leap_decay.push_back(static_cast<float>(std::exp(-h_ms * n / tau_m_ms)));
      group.leap_gain.push_back(static_cast<float>(r_m_mohm * gain(tau_m_ms, tau_ex_ms, h_ms * n)));
      group.leap_decay_ex.push_back(static_cast<float>(std::exp(-h_ms * n / tau_ex_ms)));
      group.peak_ex = std::max(group.peak_ex, group.leap_gain.back());
    }
    for (std::uint32_t i = 0; i < record.size; ++i) {
      group.initial_mv.push_back(relative(parameters.value(kInitialV, i)));
    }
    floor.groups_.push_back(std::move(group));
  }
  floor.weights_.resize(image.targets.size());
  for (std::uint32_t neuron = 0; neuron < image.header.neuron_count; ++neuron) {
    const std::uint32_t s = image.row_begin[neuron];
    const std::uint32_t count = image.row_begin[neuron + 1] - s;
    if (count > 1) {
      return std::nullopt;
    }
    Row row{0, 0, 1, 0};
    if (count == 1) {
      const SegmentRecord& segment = image.segments[s];
      const bool has_one = (segment.flags & kSegmentOneWeight) != 0;
      row = {segment.target_begin, image.segments[s + 1].target_begin, segment.delay_ticks,
             std::numeric_limits<float>::quiet_NaN()};
      for (std::uint32_t t = row.begin; t < row.end; ++t) {
        const std::int32_t quanta = image.weights[segment.weight_begin + (has_one ? 0 : t - row.begin)];
        floor.weights_[t] = static_cast<float>(quanta) * quantum[image.targets[t]];
      }
      const bool is_uniform = std::all_of(floor.weights_.begin() + row.begin, floor.weights_.begin() + row.end,
                                          [&](float w) { return w == floor.weights_[row.begin]; });
      row.one_weight = is_uniform ? floor.weights_[row.begin] : row.one_weight;
    }
    floor.rows_.push_back(row);
  }
  floor.due_.resize(image.header.max_delay_ticks + 1);
  floor.inputs_.resize(image.header.slot_count);
  floor.reset();
  return floor;
}

void Floor::reset() {
  tick_ = 0;
  std::fill(inputs_.begin(), inputs_.end(), 0.0F);
  for (std::vector<std::uint32_t>& due : due_) {
    due.clear();
  }
  for (Group& group : groups_) {
    group.v_mv = group.initial_mv;
    group.ex.assign(group.size, 0);
    group.in.assign(group.size, 0);
    group.refractory.assign(group.size, 0);
    group.fires.assign(group.size, 0);
    group.awake.clear();
    group.touched.clear();
    group.is_awake.assign(group.size, 0);
    group.is_touched.assign(group.size, 0);
    group.valid_after.assign(group.size, 0);
  }
}

void Floor::send(std::uint32_t neuron) {
  const Row& row = rows_[neuron];
  if (row.begin != row.end) {
    due_[(tick_ + row.delay_ticks) % due_.size()].push_back(neuron);
  }
}

Floor::Group& Floor::group_of_slot(std::uint32_t slot) {
  std::size_t g = groups_.size() - 1;
  while (groups_[g].first_slot > slot) {
    --g;
  }
  return groups_[g];
}

void Floor::deliver(bool lists_targets) {
  std::vector<std::uint32_t>& due = due_[tick_ % due_.size()];
  const std::uint32_t* const targets = image_->targets.data();
  float* const inputs = inputs_.data();
  for (const std::uint32_t neuron : due) {
    const Row& row = rows_[neuron];
    if (std::isnan(row.one_weight)) {
      for (std::uint32_t t = row.begin; t < row.end; ++t) {
        inputs[targets[t]] += weights_[t];
      }
    } else {
      for (std::uint32_t t = row.begin; t < row.end; ++t) {
        inputs[targets[t]] += row.one_weight;
      }
    }
    if (!lists_targets) {
      continue;
    }
    Group& group = group_of_slot(targets[row.begin]);
    for (std::uint32_t t = row.begin; t < row.end; ++t) {
      const std::uint32_t i = targets[t] - group.first_slot;
      if (!group.is_touched[i]) {
        group.is_touched[i] = 1;
        group.touched.push_back(i);
      }
    }
  }
  due.clear();
}

void Floor::sweep(Group& group, float* ex, float* in) {
  const std::uint32_t size = group.size;
  const SweepConstants constants{group.decay,    group.gain_ex,      group.decay_ex, group.gain_in,
                                 group.decay_in, group.threshold_mv, group.reset_mv, group.refractory_ticks};
  if (group.has_inhibition) {
    sweep_two(constants, size, group.v_mv.data(), group.ex.data(), group.in.data(), ex, in, group.refractory.data(),
              group.fires.data());
  } else {
    sweep_one(constants, size, group.v_mv.data(), group.ex.data(), ex, group.refractory.data(), group.fires.data());
  }
  const std::int32_t* const fires = group.fires.data();
  for (std::uint32_t i = 0; i < size; i += 16) {
    const std::uint32_t end = std::min(i + 16, size);
    std::int32_t any = 0;
    for (std::uint32_t k = i; k < end; ++k) {
      any |= fires[k];
    }
    for (std::uint32_t k = i; any != 0 && k < end; ++k) {
      if (fires[k] != 0) {
        fired_.push_back(group.first_neuron + k);
      }
    }
  }
}

std::span<const std::uint32_t> Floor::step_dense(std::span<const std::uint32_t> stimulus) {
  fired_.clear();
  deliver(false);
  for (Group& group : groups_) {
    float* const ex = inputs_.data() + group.first_slot;
    sweep(group, ex, group.has_inhibition ? ex + group.size : nullptr);
  }
  for (const std::uint32_t neuron : fired_) {
    send(neuron);
  }
  for (const std::uint32_t neuron : stimulus) {
    send(neuron);
  }
  ++tick_;
  return fired_;
}

void Floor::fire(Group& group, std::uint32_t i) {
  group.v_mv[i] = group.reset_mv;
  group.refractory[i] = group.refractory_ticks;
  fired_.push_back(group.first_neuron + i);
}

// From where they fell asleep through this tick.
void Floor::wake_touched(Group& group, float* ex) {
  for (const std::uint32_t i : group.touched) {
    group.is_touched[i] = 0;
    if (group.is_awake[i] != 0) {
      continue;
    }
    const std::uint32_t n =
        std::min<std::uint32_t>(static_cast<std::uint32_t>(tick_) + 1 - group.valid_after[i], kLeapTicks - 1);
    group.v_mv[i] = group.leap_decay[n] * group.v_mv[i] + group.leap_gain[n] * group.ex[i];
    group.ex[i] = group.leap_decay_ex[n] * group.ex[i] + ex[i];
    ex[i] = 0;
    if (group.v_mv[i] >= group.threshold_mv) {
      fire(group, i);
    }
    const float bound = std::max(group.v_mv[i], 0.0F) + std::max(group.peak_ex * group.ex[i], 0.0F);
    if (bound >= group.threshold_mv || group.refractory[i] > 0) {
      group.is_awake[i] = 1;
      group.awake.push_back(i);
    } else {
      group.valid_after[i] = static_cast<std::uint32_t>(tick_) + 1;
    }
  }
  group.touched.clear();
}

void Floor::advance_awake(Group& group, float* ex) {
  std::size_t kept = 0;
  for (const std::uint32_t i : group.awake) {
    const float next = group.decay * group.v_mv[i] + group.gain_ex * group.ex[i];
    group.ex[i] = group.decay_ex * group.ex[i] + ex[i];
    ex[i] = 0;
    if (group.refractory[i] > 0) {
      --group.refractory[i];
      group.v_mv[i] = group.reset_mv;
    } else if (next >= group.threshold_mv) {
      fire(group, i);
    } else {
      group.v_mv[i] = next;
    }
    const float bound = std::max(group.v_mv[i], 0.0F) + std::max(group.peak_ex * group.ex[i], 0.0F);
    if (bound >= group.threshold_mv || group.refractory[i] > 0) {
      group.awake[kept++] = i;
    } else {
      group.is_awake[i] = 0;
      group.valid_after[i] = static_cast<std::uint32_t>(tick_) + 1;
    }
  }
  group.awake.resize(kept);
}

std::span<const std::uint32_t> Floor::step_silent(std::span<const std::uint32_t> stimulus) {
  fired_.clear();
  deliver(true);
  for (Group& group : groups_) {
    float* const ex = inputs_.data() + group.first_slot;
    advance_awake(group, ex);
    wake_touched(group, ex);
  }
  for (const std::uint32_t neuron : fired_) {
    send(neuron);
  }
  for (const std::uint32_t neuron : stimulus) {
    send(neuron);
  }
  ++tick_;
  return fired_;
}

}  // namespace tectum
