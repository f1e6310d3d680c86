#include "tools/diff/open_loop_run.h"

#include <algorithm>

#include "runtime/record/recording_file.h"

namespace tectum {
namespace {

GuardOptions guard_options(const RecordedGuard& guard) {
  return {guard.neutral_deg,   guard.approach_speed_deg_s, guard.ease_speed_deg_s, guard.hold_after_ns,
          guard.ease_after_ns, guard.servo_lost_after_ns,  guard.max_step_ns};
}

}  // namespace

void FieldSwitch::set(SpikeEngine& engine, const std::vector<std::uint32_t>& lit) {
  for (const std::uint32_t neuron : lit_) {
    if (!std::binary_search(lit.begin(), lit.end(), neuron)) {
      engine.set_field_active(NeuronId{neuron}, false);
    }
  }
  for (const std::uint32_t neuron : lit) {
    if (!std::binary_search(lit_.begin(), lit_.end(), neuron)) {
      engine.set_field_active(NeuronId{neuron}, true);
    }
  }
  lit_ = lit;
}

std::uint64_t end_tick(const Recording& recording, std::size_t frame, std::uint64_t tick_ns) {
  const auto turns = static_cast<std::uint64_t>(frame) + 1;
  return turns * static_cast<std::uint64_t>(recording.frame_period_ns) / tick_ns;
}

OpenLoopRun::OpenLoopRun(const SpikeImage& image, const Recording& input, const LitNeurons& lit)
    : image_(image),
      input_(input),
      lit_(lit),
      engine_(image),
      decoder_(image),
      guard_(image, guard_options(input.guard)),
      recording_(describe_run(image)) {
  recording_.scenario = input.scenario;
  recording_.seed = input.seed;
  recording_.frame_period_ns = input.frame_period_ns;
  recording_.duration_s = input.duration_s;
  recording_.guard = input.guard;
}

void OpenLoopRun::run_frame(std::size_t frame) {
  const RecordedFrame& seen = input_.frames[frame];
  RecordedFrame now;
  now.tick = engine_.tick();
  now.time_ns = seen.time_ns;
  now.position_deg = seen.position_deg;
  now.fresh_mask = seen.fresh_mask;
  now.camera_age_ns = seen.camera_age_ns;
  now.request = seen.request;
  now.active_fields = fields_of(image_, lit_[frame]);
  fields_.set(engine_, lit_[frame]);
  const std::uint64_t end = end_tick(input_, frame, image_.header.tick_ns);
  while (engine_.tick() < end) {
    const std::uint64_t tick = engine_.tick();
    engine_.step();
    decoder_.tick(engine_.spikes());
    for (const NeuronId neuron : engine_.spikes()) {
      recording_.spikes.push_back({tick, static_cast<std::uint32_t>(neuron)});
    }
  }
  decoder_.decode(now.decoded_deg);
  now.has_command = guard_.decide({.now_ns = seen.time_ns,
                                   .decoded_deg = now.decoded_deg,
                                   .feedback = {seen.time_ns, seen.position_deg, seen.fresh_mask},
                                   .camera_age_ns = seen.camera_age_ns,
                                   .request = static_cast<GuardRequest>(seen.request)},
                                  command_);
  now.guard_state = static_cast<std::uint8_t>(guard_.state());
  if (now.has_command) {
    decoder_.accept(command_.goal_deg);
  }
  now.goal_deg = now.has_command ? command_.goal_deg : seen.position_deg;
  recording_.frames.push_back(std::move(now));
}

}  // namespace tectum
