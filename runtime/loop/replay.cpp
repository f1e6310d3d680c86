#include "runtime/loop/replay.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "runtime/act/decoder.h"
#include "runtime/act/servo_guard.h"
#include "runtime/learn/learner.h"
#include "runtime/learn/retinal_reward.h"
#include "runtime/record/recording_file.h"

namespace tectum {
namespace {

GuardOptions guard_options(const RecordedGuard& guard) {
  return {.neutral_deg = guard.neutral_deg,
          .approach_speed_deg_s = guard.approach_speed_deg_s,
          .ease_speed_deg_s = guard.ease_speed_deg_s,
          .hold_after_ns = guard.hold_after_ns,
          .ease_after_ns = guard.ease_after_ns,
          .servo_lost_after_ns = guard.servo_lost_after_ns,
          .max_step_ns = guard.max_step_ns};
}

/// Bit for bit, so that one NaN equals itself and -0 is not 0.
bool same_bits(const std::array<double, kJointCount>& a, const std::array<double, kJointCount>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

class Replay {
 public:
  Replay(const SpikeImage& image, const Recording& recording, const ReplayOptions& options)
      : recording_(recording),
        options_(options),
        engine_(image, options.engine),
        learner_(recording.learns ? std::make_optional<Learner>(image) : std::nullopt),
        reward_(image),
        decoder_(image),
        guard_(image, guard_options(recording.guard)) {
    for (std::size_t e = 0; e < kEyeCount; ++e) {
      for (const RetinaRecord& retina : image.retinas) {
        for (std::uint32_t field = 0; field < retina.field_count && static_cast<std::size_t>(retina.eye) == e;
             ++field) {
          neuron_of_field_[e].push_back(NeuronId{retina.first_neuron + field});
        }
      }
    }
  }

  ReplayResult run() {
    result_.is_same = true;
    for (std::size_t k = 0; k < recording_.frames.size() && result_.is_same; ++k) {
      if (!turn(k)) {
        return result_;
      }
      if (options_.progress && k % 16 == 0) {
        options_.progress(static_cast<double>(k) / static_cast<double>(recording_.frames.size()));
      }
    }
    for (std::size_t s = 0; learner_ && s < learner_->scales().size(); ++s) {
      result_.learned += learner_->scales()[s] == learner_->initial_scale(s) ? 0 : 1;
    }
    return result_;
  }

 private:
  bool fail(std::size_t k, const std::string& why) {
    result_.error = "frame " + std::to_string(k) + " " + why;
    result_.is_same = false;
    return false;
  }
  void differ(std::size_t k, const std::string& what) {
    if (result_.is_same) {
      result_.is_same = false;
      result_.difference = "frame " + std::to_string(k) + ": " + what;
    }
  }

  /// False when the recording makes no sense for this image.
  bool turn(std::size_t k) {
    const RecordedFrame& frame = recording_.frames[k];
    if (frame.tick != engine_.tick()) {
      return fail(k, "starts at tick " + std::to_string(frame.tick) + ", not " + std::to_string(engine_.tick()));
    }
    for (std::size_t e = 0; e < kEyeCount; ++e) {
      if (!drive(e, frame.active_fields[e])) {
        return fail(k, "lights a field that the circuit does not have");
      }
    }
    if (learner_) {
      learner_->take_reward(engine_.tick(), reward_.sample(frame.active_fields), engine_.plastic_weights());
    }
    const auto turn_count = static_cast<TimeNs>(k) + 1;
    const auto end =
        static_cast<std::uint64_t>(turn_count * recording_.frame_period_ns / static_cast<TimeNs>(recording_.tick_ns));
    while (engine_.tick() < end) {
      const std::uint64_t tick = engine_.tick();
      engine_.step();
      decoder_.tick(engine_.spikes());
      if (learner_) {
        learner_->take_spikes(engine_.spikes());
      }
      compare_spikes(k, tick);
    }
    compare_command(k, frame);
    ++result_.frames;
    return true;
  }

  bool drive(std::size_t eye, const std::vector<std::uint32_t>& active) {
    const std::vector<NeuronId>& neurons = neuron_of_field_[eye];
    if (std::any_of(active.begin(), active.end(), [&](std::uint32_t field) { return field >= neurons.size(); })) {
      return false;
    }
    for (const std::uint32_t field : was_active_[eye]) {
      if (!std::binary_search(active.begin(), active.end(), field)) {
        engine_.set_field_active(neurons[field], false);
      }
    }
    for (const std::uint32_t field : active) {
      if (!std::binary_search(was_active_[eye].begin(), was_active_[eye].end(), field)) {
        engine_.set_field_active(neurons[field], true);
      }
    }
    was_active_[eye] = active;
    std::sort(was_active_[eye].begin(), was_active_[eye].end());
    return true;
  }

  [[nodiscard]] std::string neuron_name(std::uint32_t neuron) const {
    for (const RecordedPopulation& population : recording_.populations) {
      if (neuron - population.first_neuron < population.size) {
        return population.name + "[" + std::to_string(neuron - population.first_neuron) + "]";
      }
    }
    return "neuron " + std::to_string(neuron);
  }

  void compare_spikes(std::size_t k, std::uint64_t tick) {
    const std::vector<RecordedSpike>& recorded = recording_.spikes;
    for (const NeuronId neuron : engine_.spikes()) {
      const RecordedSpike fired{tick, static_cast<std::uint32_t>(neuron)};
      ++result_.spikes;
      if (next_spike_ >= recorded.size() || recorded[next_spike_] != fired) {
        differ(k, neuron_name(fired.neuron) + " fires at tick " + std::to_string(tick) +
                      ", which the recording does not say");
        return;
      }
      ++next_spike_;
    }
    if (next_spike_ < recorded.size() && recorded[next_spike_].tick <= tick) {
      differ(k, neuron_name(recorded[next_spike_].neuron) + " does not fire at tick " +
                    std::to_string(recorded[next_spike_].tick) + ", as it did in the recording");
    }
  }

  void compare_command(std::size_t k, const RecordedFrame& frame) {
    std::array<double, kJointCount> decoded_deg{};
    decoder_.decode(decoded_deg);
    const ServoFeedback feedback{frame.time_ns, frame.position_deg, frame.fresh_mask};
    const bool has_command = guard_.decide({.now_ns = frame.time_ns,
                                            .decoded_deg = decoded_deg,
                                            .feedback = feedback,
                                            .camera_age_ns = frame.camera_age_ns,
                                            .request = static_cast<GuardRequest>(frame.request)},
                                           command_);
    if (has_command) {
      decoder_.accept(command_.goal_deg);
    }
    result_.commands += has_command ? 1 : 0;
    const auto state = static_cast<std::uint8_t>(guard_.state());
    if (!same_bits(decoded_deg, frame.decoded_deg)) {
      differ(k, "the decoder says other angles");
    } else if (state != frame.guard_state) {
      differ(k, std::string("the guard is ") + kGuardStateNames[state] + ", and was another");
    } else if (has_command != frame.has_command || (has_command && !same_bits(command_.goal_deg, frame.goal_deg))) {
      differ(k, "another command is sent");
    }
  }

  const Recording& recording_;
  const ReplayOptions& options_;
  SpikeEngine engine_;
  std::optional<Learner> learner_;
  RetinalReward reward_;
  Decoder decoder_;
  ServoGuard guard_;
  std::array<std::vector<NeuronId>, kEyeCount> neuron_of_field_;
  std::array<std::vector<std::uint32_t>, kEyeCount> was_active_;
  ServoCommand command_;
  std::size_t next_spike_ = 0;
  ReplayResult result_;
};

bool has_same_populations(const SpikeImage& image, const Recording& recording) {
  const std::vector<RecordedPopulation> now = describe_run(image).populations;
  return std::equal(now.begin(), now.end(), recording.populations.begin(), recording.populations.end(),
                    [](const RecordedPopulation& a, const RecordedPopulation& b) {
                      return a.name == b.name && a.first_neuron == b.first_neuron && a.size == b.size;
                    });
}

}  // namespace

ReplayResult replay(const SpikeImage& image, const Recording& recording, const ReplayOptions& options) {
  ReplayResult refused;
  const bool is_other = recording.image_checksum != image.header.checksum;
  refused.is_other_circuit = is_other;
  if (is_other && !options.takes_other_circuit) {
    refused.error = "it was made with another circuit, another seed or another compiler";
  } else if (is_other && !has_same_populations(image, recording)) {
    refused.error = "its populations are not the circuit's: their spikes cannot be compared one by one";
  } else if (recording.tick_ns != image.header.tick_ns || recording.tick_ns == 0 || recording.frame_period_ns <= 0) {
    refused.error = "its ticks are not the circuit's";
  } else {
    ReplayResult result = Replay(image, recording, options).run();
    result.is_other_circuit = is_other;
    return result;
  }
  return refused;
}

}  // namespace tectum
