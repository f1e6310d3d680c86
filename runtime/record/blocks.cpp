#include "runtime/record/blocks.h"

namespace tectum {
namespace {

constexpr std::string_view kDescription = R"(Tectum recording, version 3. Little-endian; u8 u32 u64 i64 f64 are numbers.
text = u32 bytes, UTF-8. list<T> = u32 count, T...
File: 8 bytes magic, u32 version, u32 zero, blocks.
Block: u32 kind, u32 payload bytes, u64 checksum, payload.
Checksum: FNV-1a, 64 bit, over kind, payload bytes and payload.

Kind 1, Description: this text.
Kind 2, Run:
  text circuit_name, text scenario, u64 seed, u64 image_checksum, u64 tick_ns, i64 frame_period_ns, f64 wall_distance_m
  guard: 6 x f64 neutral_deg, f64 approach_speed_deg_s, f64 ease_speed_deg_s,
         i64 hold_after_ns, ease_after_ns, servo_lost_after_ns, max_step_ns
  u8 learns: weights changed while it ran
  list<population>: text name, text nucleus, u32 first_neuron, u32 size
  list<retina>: text name, u32 eye (0 left, 1 right), f64 field_of_view_deg, u32 frame_width, u32 frame_height
                (reference pixels), list<field>: 4 x f32 x0 y0 x1 y1, half-open, reference pixels, y down
Kind 3, Spikes: u64 first_tick, list<spike>: u32 tick - first_tick, u32 neuron. Ascending by tick, then neuron.
Kind 4, Frames, list<frame>:
  u64 tick: first tick run with this frame
  i64 time_ns: when the loop took the frame
  2 x i64 captured_ns: left eye, right eye
  2 x list<u32> active_fields: of the left and the right eye, counted through that eye's retinas
  6 x f64 decoded_deg: before the guard
  6 x f64 goal_deg: what the servos were told
  6 x f64 position_deg: what they measured at time_ns
    joints: left_eye_pan left_eye_tilt right_eye_pan right_eye_tilt neck_pan neck_tilt; right and up are positive
  u32 fresh_mask: joints measured since the frame before, bit 0 = left_eye_pan
  i64 camera_age_ns: of the newer eye's newest frame
  u8 request: 0 none, 1 park, 2 stop, 3 release
  u8 guard_state: 0 waiting, 1 approaching, 2 tracking, 3 holding, 4 easing, 5 parking, 6 stopped, 7 released
  u8 has_command: goal_deg was handed to the servos
  i64 late_ns: behind the schedule
  5 x i64 stage_ns: read, encode, step, decode, write; zeros when not measured
  u8 has_truth; if 1:
    2 x f64 target_on_wall_m: right, up
    2 x eye: f64 target_pan_deg target_tilt_deg error_pan_deg error_tilt_deg gaze_pan_deg gaze_tilt_deg,
             2 x f64 gaze_on_wall_m: right, up
Kind 5, End: f64 duration_s.
Kind 6, Image: the image file that ran, byte for byte. Before the first frame, or not there.
Kind 7, Positions, list<position>: i64 time_ns, 6 x f64 position_deg. Joints between the frames, where they were sampled.
)";

constexpr std::size_t kSmallestFrameBytes = 8 + 8 + 16 + 8 + 18 * 8 + 4 + 8 + 3 + 8 + 5 * 8 + 1;
constexpr std::size_t kTruthBytes = 2 * 8 + 2 * 8 * 8;
constexpr std::size_t kSpikeBytes = 8;

void put_truth(const EyeTruth& eye, BlockWriter& out) {
  out.put_all(std::array{eye.target_pan_deg, eye.target_tilt_deg, eye.error_pan_deg, eye.error_tilt_deg,
                         eye.gaze_pan_deg, eye.gaze_tilt_deg, eye.gaze_on_wall_m[0], eye.gaze_on_wall_m[1]});
}

void get_truth(BlockReader& in, EyeTruth& eye) {
  for (double* value : {&eye.target_pan_deg, &eye.target_tilt_deg, &eye.error_pan_deg, &eye.error_tilt_deg,
                        &eye.gaze_pan_deg, &eye.gaze_tilt_deg, &eye.gaze_on_wall_m[0], &eye.gaze_on_wall_m[1]}) {
    in.get(*value);
  }
}

bool get_retina(BlockReader& in, RecordedRetina& retina) {
  in.get_text(retina.name);
  const auto eye = in.get<std::uint32_t>();
  if (eye >= kEyeCount) {
    return false;
  }
  retina.eye = static_cast<Eye>(eye);
  in.get(retina.field_of_view_deg);
  in.get(retina.frame_width);
  in.get(retina.frame_height);
  retina.fields.resize(in.get_count(sizeof(FieldRecord)));
  for (FieldRecord& field : retina.fields) {
    for (float* value : {&field.x0, &field.y0, &field.x1, &field.y1}) {
      in.get(*value);
    }
  }
  return in.is_whole();
}

void get_frame(BlockReader& in, RecordedFrame& frame) {
  in.get(frame.tick);
  in.get(frame.time_ns);
  in.get_all(frame.captured_ns);
  for (std::vector<std::uint32_t>& fields : frame.active_fields) {
    fields.resize(in.get_count(sizeof(std::uint32_t)));
    in.get_all(fields);
  }
  in.get_all(frame.decoded_deg);
  in.get_all(frame.goal_deg);
  in.get_all(frame.position_deg);
  in.get(frame.fresh_mask);
  in.get(frame.camera_age_ns);
  in.get(frame.request);
  in.get(frame.guard_state);
  frame.has_command = in.get<std::uint8_t>() != 0;
  in.get(frame.late_ns);
  in.get_all(frame.stage_ns);
  frame.has_truth = in.get<std::uint8_t>() != 0;
  if (frame.has_truth) {
    in.get_all(frame.target_on_wall_m);
    for (EyeTruth& eye : frame.eye) {
      get_truth(in, eye);
    }
  }
}

}  // namespace

std::string_view recording_description() { return kDescription; }

std::uint64_t block_checksum(std::uint32_t kind, std::span<const std::byte> payload) {
  // FNV-1a, http://www.isthe.com/chongo/tech/comp/fnv/: written out in the file's own description, so that a reader
  // without this source can check it too.
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto mix = [&hash](std::byte byte) {
    hash ^= static_cast<std::uint64_t>(byte);
    hash *= 0x100000001b3ULL;
  };
  const auto size = static_cast<std::uint32_t>(payload.size());
  for (const std::uint32_t word : {kind, size}) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      mix(static_cast<std::byte>(word >> shift & 0xFFU));
    }
  }
  for (const std::byte byte : payload) {
    mix(byte);
  }
  return hash;
}

void put_run(const Recording& run, BlockWriter& out) {
  out.put_text(run.circuit_name);
  out.put_text(run.scenario);
  out.put(run.seed);
  out.put(run.image_checksum);
  out.put(run.tick_ns);
  out.put(run.frame_period_ns);
  out.put(run.wall_distance_m);
  const RecordedGuard& guard = run.guard;
  out.put_all(guard.neutral_deg);
  out.put_all(std::array{guard.approach_speed_deg_s, guard.ease_speed_deg_s});
  out.put_all(std::array{guard.hold_after_ns, guard.ease_after_ns, guard.servo_lost_after_ns, guard.max_step_ns});
  out.put(static_cast<std::uint8_t>(run.learns ? 1 : 0));
  out.put(static_cast<std::uint32_t>(run.populations.size()));
  for (const RecordedPopulation& population : run.populations) {
    out.put_text(population.name);
    out.put_text(population.nucleus);
    out.put(population.first_neuron);
    out.put(population.size);
  }
  out.put(static_cast<std::uint32_t>(run.retinas.size()));
  for (const RecordedRetina& retina : run.retinas) {
    out.put_text(retina.name);
    out.put(static_cast<std::uint32_t>(retina.eye));
    out.put(retina.field_of_view_deg);
    out.put(retina.frame_width);
    out.put(retina.frame_height);
    out.put(static_cast<std::uint32_t>(retina.fields.size()));
    for (const FieldRecord& field : retina.fields) {
      out.put_all(std::array{field.x0, field.y0, field.x1, field.y1});
    }
  }
}

bool get_run(BlockReader& in, Recording& out) {
  in.get_text(out.circuit_name);
  in.get_text(out.scenario);
  in.get(out.seed);
  in.get(out.image_checksum);
  in.get(out.tick_ns);
  in.get(out.frame_period_ns);
  in.get(out.wall_distance_m);
  RecordedGuard& guard = out.guard;
  in.get_all(guard.neutral_deg);
  for (double* speed : {&guard.approach_speed_deg_s, &guard.ease_speed_deg_s}) {
    in.get(*speed);
  }
  for (TimeNs* time : {&guard.hold_after_ns, &guard.ease_after_ns, &guard.servo_lost_after_ns, &guard.max_step_ns}) {
    in.get(*time);
  }
  std::uint8_t learns = 0;
  in.get(learns);
  out.learns = learns != 0;
  out.populations.resize(in.get_count(4 * sizeof(std::uint32_t)));
  for (RecordedPopulation& population : out.populations) {
    in.get_text(population.name);
    in.get_text(population.nucleus);
    in.get(population.first_neuron);
    in.get(population.size);
  }
  out.retinas.resize(in.get_count(7 * sizeof(std::uint32_t)));
  for (RecordedRetina& retina : out.retinas) {
    if (!get_retina(in, retina)) {
      return false;
    }
  }
  return in.is_whole() && in.is_at_end();
}

void put_frame(const RecordedFrame& frame, BlockWriter& out) {
  out.put(frame.tick);
  out.put(frame.time_ns);
  out.put_all(frame.captured_ns);
  for (const std::vector<std::uint32_t>& fields : frame.active_fields) {
    out.put(static_cast<std::uint32_t>(fields.size()));
    out.put_all(fields);
  }
  out.put_all(frame.decoded_deg);
  out.put_all(frame.goal_deg);
  out.put_all(frame.position_deg);
  out.put(frame.fresh_mask);
  out.put(frame.camera_age_ns);
  out.put(frame.request);
  out.put(frame.guard_state);
  out.put(static_cast<std::uint8_t>(frame.has_command ? 1 : 0));
  out.put(frame.late_ns);
  out.put_all(frame.stage_ns);
  out.put(static_cast<std::uint8_t>(frame.has_truth ? 1 : 0));
  if (frame.has_truth) {
    out.put_all(frame.target_on_wall_m);
    for (const EyeTruth& eye : frame.eye) {
      put_truth(eye, out);
    }
  }
}

std::size_t largest_frame_bytes(const Recording& run) {
  std::size_t bytes = kSmallestFrameBytes + kTruthBytes;
  for (const RecordedRetina& retina : run.retinas) {
    bytes += retina.fields.size() * sizeof(std::uint32_t);
  }
  return bytes;
}

bool get_frames(BlockReader& in, Recording& out) {
  const std::uint32_t count = in.get_count(kSmallestFrameBytes);
  for (std::uint32_t i = 0; i < count && in.is_whole(); ++i) {
    get_frame(in, out.frames.emplace_back());
  }
  return in.is_whole() && in.is_at_end();
}

bool get_spikes(BlockReader& in, Recording& out) {
  const auto first_tick = in.get<std::uint64_t>();
  const std::uint32_t count = in.get_count(kSpikeBytes);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto tick_offset = in.get<std::uint32_t>();
    out.spikes.push_back({first_tick + tick_offset, in.get<std::uint32_t>()});
  }
  return in.is_whole() && in.is_at_end();
}

void put_positions(const RecordedPositions& positions, BlockWriter& out) {
  out.put(positions.time_ns);
  out.put_all(positions.position_deg);
}

bool get_positions(BlockReader& in, Recording& out) {
  const std::uint32_t count = in.get_count(kPositionsBytes);
  for (std::uint32_t i = 0; i < count; ++i) {
    RecordedPositions& positions = out.positions.emplace_back();
    in.get(positions.time_ns);
    in.get_all(positions.position_deg);
  }
  return in.is_whole() && in.is_at_end();
}

}  // namespace tectum
