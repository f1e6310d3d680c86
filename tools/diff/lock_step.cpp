#include "tools/diff/lock_step.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "runtime/engine/spike_engine.h"
#include "tools/diff/open_loop_run.h"

namespace tectum {
namespace {

bool is_other(double a, double b) { return std::bit_cast<std::uint64_t>(a) != std::bit_cast<std::uint64_t>(b); }

std::vector<std::uint32_t> counterparts(const CircuitView& a, const CircuitView& b, const Correspondence& match) {
  std::vector<std::uint32_t> of(a.image.header.neuron_count, kNoMatch);
  for (std::uint32_t neuron = 0; neuron < of.size(); ++neuron) {
    of[neuron] = counterpart(a, b, match, neuron);
  }
  return of;
}

class LockStepper {
 public:
  LockStepper(const CircuitView& a, const CircuitView& b, const Correspondence& match, const Recording& recording_a,
              const Recording& recording_b)
      : a_(a),
        b_(b),
        recording_a_(recording_a),
        recording_b_(recording_b),
        in_b_(counterparts(a, b, match)),
        in_a_(b.image.header.neuron_count, kNoMatch),
        bucket_ns_(std::max(a.image.header.tick_ns, b.image.header.tick_ns)) {
    for (std::uint32_t neuron = 0; neuron < in_b_.size(); ++neuron) {
      if (in_b_[neuron] != kNoMatch) {
        in_a_[in_b_[neuron]] = neuron;
      }
    }
  }

  LockStep run(const std::function<void(std::size_t)>& produce_b, double follow_s) {
    for (std::size_t k = 0; k < recording_a_.frames.size(); ++k) {
      if (produce_b) {
        produce_b(k);
      }
      if (k >= recording_b_.frames.size()) {
        break;
      }
      compare_fields(k);
      compare_spikes(k);
      compare_commands(k);
      result_.run_s = static_cast<double>(k + 1) * static_cast<double>(recording_a_.frame_period_ns) * 1e-9;
      if (!result_.is_same() && !follow_until_s_) {
        follow_until_s_ = result_.run_s + follow_s;
      }
      if (follow_until_s_ && result_.run_s >= *follow_until_s_) {
        break;
      }
    }
    for (const auto& [population, first] : first_spikes_) {
      result_.spikes.push_back(first);
    }
    std::stable_sort(result_.spikes.begin(), result_.spikes.end(),
                     [](const FirstSpike& x, const FirstSpike& y) { return x.time_ns < y.time_ns; });
    return std::move(result_);
  }

 private:
  struct Event {
    std::uint64_t bucket;
    std::uint32_t neuron;  // of b
    auto operator<=>(const Event&) const = default;
  };

  [[nodiscard]] std::uint64_t frame_ns(std::size_t frame) const {
    return static_cast<std::uint64_t>(frame) * static_cast<std::uint64_t>(recording_a_.frame_period_ns);
  }

  void compare_fields(std::size_t k) {
    if (result_.field) {
      return;
    }
    const std::vector<std::uint32_t> lit_a = lit_in(a_.image, recording_a_.frames[k]);
    const std::vector<std::uint32_t> lit_b = lit_in(b_.image, recording_b_.frames[k]);
    const auto note = [&](std::uint32_t neuron_a, std::uint32_t neuron_b, bool is_lit_in_a) {
      // The ticks of a frame begin on the tick before its time.
      const std::uint64_t first_tick = k == 0 ? 0 : end_tick(recording_a_, k - 1, a_.image.header.tick_ns);
      result_.field = FirstField{k, first_tick * a_.image.header.tick_ns, neuron_a, neuron_b, is_lit_in_a};
    };
    for (const std::uint32_t neuron : lit_a) {
      const std::uint32_t other = in_b_[neuron];
      if (other == kNoMatch || !std::binary_search(lit_b.begin(), lit_b.end(), other)) {
        note(neuron, other, true);
        return;
      }
    }
    for (const std::uint32_t neuron : lit_b) {
      const std::uint32_t other = in_a_[neuron];
      if (other == kNoMatch || !std::binary_search(lit_a.begin(), lit_a.end(), other)) {
        note(other, neuron, false);
        return;
      }
    }
  }

  void compare_spikes(std::size_t k) {
    std::vector<Event> fired_a, fired_b;
    const std::uint64_t end_a = end_tick(recording_a_, k, a_.image.header.tick_ns);
    for (; next_a_ < recording_a_.spikes.size() && recording_a_.spikes[next_a_].tick < end_a; ++next_a_) {
      const RecordedSpike& spike = recording_a_.spikes[next_a_];
      if (spike.neuron < in_b_.size() && in_b_[spike.neuron] != kNoMatch) {
        fired_a.push_back({spike.tick * a_.image.header.tick_ns / bucket_ns_, in_b_[spike.neuron]});
      }
    }
    const std::uint64_t end_b = end_tick(recording_b_, k, b_.image.header.tick_ns);
    for (; next_b_ < recording_b_.spikes.size() && recording_b_.spikes[next_b_].tick < end_b; ++next_b_) {
      const RecordedSpike& spike = recording_b_.spikes[next_b_];
      if (spike.neuron < in_a_.size() && in_a_[spike.neuron] != kNoMatch) {
        fired_b.push_back({spike.tick * b_.image.header.tick_ns / bucket_ns_, spike.neuron});
      }
    }
    std::sort(fired_a.begin(), fired_a.end());
    std::sort(fired_b.begin(), fired_b.end());
    std::vector<Event> only;
    std::set_difference(fired_a.begin(), fired_a.end(), fired_b.begin(), fired_b.end(), std::back_inserter(only));
    for (const Event& event : only) {
      note_spike(event, true);
    }
    only.clear();
    std::set_difference(fired_b.begin(), fired_b.end(), fired_a.begin(), fired_a.end(), std::back_inserter(only));
    for (const Event& event : only) {
      note_spike(event, false);
    }
  }

  void note_spike(const Event& event, bool is_in_a) {
    const std::uint32_t population = b_.population_of(event.neuron);
    const std::uint64_t time_ns = event.bucket * bucket_ns_;
    auto [entry, is_new] = first_spikes_.try_emplace(
        population, FirstSpike{population, time_ns, in_a_[event.neuron], event.neuron, is_in_a, 1});
    FirstSpike& first = entry->second;
    if (is_new || time_ns > first.time_ns) {
      return;
    }
    const bool is_earlier = time_ns < first.time_ns || event.neuron < first.neuron_b;
    const std::size_t at_once = time_ns < first.time_ns ? 1 : first.neurons_at_once + 1;
    if (is_earlier) {
      first = {population, time_ns, in_a_[event.neuron], event.neuron, is_in_a, at_once};
    }
    first.neurons_at_once = at_once;
  }

  void compare_commands(std::size_t k) {
    const RecordedFrame &x = recording_a_.frames[k], &y = recording_b_.frames[k];
    for (std::size_t j = 0; j < kJointCount; ++j) {
      const bool is_known = std::any_of(result_.commands.begin(), result_.commands.end(),
                                        [&](const FirstCommand& command) { return command.joint == j; });
      if (is_known) {
        continue;
      }
      // The command leaves when the ticks of the frame are done.
      if (is_other(x.decoded_deg[j], y.decoded_deg[j])) {
        result_.commands.push_back({j, frame_ns(k + 1), x.decoded_deg[j], y.decoded_deg[j], true});
      } else if (x.has_command && y.has_command && is_other(x.goal_deg[j], y.goal_deg[j])) {
        result_.commands.push_back({j, frame_ns(k + 1), x.goal_deg[j], y.goal_deg[j], false});
      }
    }
  }

  const CircuitView& a_;
  const CircuitView& b_;
  const Recording& recording_a_;
  const Recording& recording_b_;
  std::vector<std::uint32_t> in_b_, in_a_;  // counterparts
  std::uint64_t bucket_ns_;                 // spikes within one are at one time: the longer of the two ticks
  std::size_t next_a_ = 0, next_b_ = 0;
  std::map<std::uint32_t, FirstSpike> first_spikes_;
  std::optional<double> follow_until_s_;
  LockStep result_;
};

}  // namespace

std::uint32_t counterpart(const CircuitView& a, const CircuitView& b, const Correspondence& match,
                          std::uint32_t neuron) {
  const std::uint32_t p = a.population_of(neuron);
  const std::uint32_t q = match.population_of_a[p];
  if (q == kNoMatch) {
    return kNoMatch;
  }
  const std::uint32_t index = neuron - a.populations[p].first_neuron;
  return index < b.populations[q].size ? b.populations[q].first_neuron + index : kNoMatch;
}

LockStep lock_step(const CircuitView& a, const CircuitView& b, const Correspondence& match,
                   const Recording& recording_a, const Recording& recording_b,
                   const std::function<void(std::size_t frame)>& produce_b, double follow_s) {
  return LockStepper(a, b, match, recording_a, recording_b).run(produce_b, follow_s);
}

std::optional<FirstPotential> first_potential(const CircuitView& a, const CircuitView& b, const Correspondence& match,
                                              const Recording& recording_a, const Recording& recording_b) {
  constexpr double kWorthNamingMv = 1e-6;  // rounding of the propagators' float32 lies below
  if (a.image.header.tick_ns != b.image.header.tick_ns) {
    return std::nullopt;
  }
  SpikeEngine engine_a(a.image), engine_b(b.image);
  FieldSwitch fields_a, fields_b;
  const std::vector<std::uint32_t> in_b = counterparts(a, b, match);
  for (std::size_t k = 0; k < std::min(recording_a.frames.size(), recording_b.frames.size()); ++k) {
    fields_a.set(engine_a, lit_in(a.image, recording_a.frames[k]));
    fields_b.set(engine_b, lit_in(b.image, recording_b.frames[k]));
    const std::uint64_t end = end_tick(recording_a, k, a.image.header.tick_ns);
    while (engine_a.tick() < end) {
      engine_a.advance(end - engine_a.tick());
    }
    while (engine_b.tick() < end) {
      engine_b.advance(end - engine_b.tick());
    }
    std::optional<FirstPotential> widest;
    for (std::uint32_t neuron = 0; neuron < in_b.size(); ++neuron) {
      if (in_b[neuron] == kNoMatch) {
        continue;
      }
      const double x = engine_a.probe(NeuronId{neuron}, 0), y = engine_b.probe(NeuronId{in_b[neuron]}, 0);
      const double gap = std::abs(x - y);
      if (gap > kWorthNamingMv && (!widest || gap > std::abs(widest->a - widest->b))) {
        widest = FirstPotential{neuron, in_b[neuron], end * a.image.header.tick_ns, x, y};
      }
    }
    if (widest) {
      return widest;
    }
  }
  return std::nullopt;
}

}  // namespace tectum
