// A circuit without synapses and a world that can be told what to do, turn by turn.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "runtime/loop/control_loop.h"
#include "tests/support/test_network.h"

namespace tectum {

inline constexpr TimeNs kMs = 1'000'000;

/// Two eyes of two fields each (left half, right half). Neurons 0 and 1 are the left eye's, 2 and 3 the right eye's;
/// each fires every millisecond while its field is active. One degree of left_eye_pan for each left eye's right-field
/// neuron at full rate, one of left_eye_tilt for each right eye's left-field neuron.
inline SpikeImage two_eyed_image(double tick_ms = 1.0) {
  test::TestNetwork network;
  network.tick_ms = tick_ms;
  network.add("left_fields", {ModelKind::FieldSource, 2, {{"rate", {1000.0}}}, {}, false});
  network.add("right_fields", {ModelKind::FieldSource, 2, {{"rate", {1000.0}}}, {}, false});
  ImageContents contents = lower_network(network);
  for (const std::uint32_t eye : {0U, 1U}) {
    contents.retinas.push_back({contents.add_string(eye == 0 ? "left_eye" : "right_eye"), static_cast<Eye>(eye), 10, 10,
                                40.0, LitChannel::Red, 100, 0.0, 2 * eye, 2, 2 * eye, 0});
    contents.fields.push_back({0, 0, 5, 10});
    contents.fields.push_back({5, 0, 10, 10});
  }
  const auto window_ticks = static_cast<std::uint32_t>(10 / tick_ms);
  contents.outputs.push_back({contents.add_string("pan"), OutputKind::Position, 0, 1, 0b01, window_ticks, 0.0});
  contents.output_terms.push_back({1, 1, 1.0 / 1000});
  contents.outputs.push_back({contents.add_string("tilt"), OutputKind::Position, 1, 1, 0b10, window_ticks, 0.0});
  contents.output_terms.push_back({2, 1, 1.0 / 1000});
  contents.joints.push_back({Joint::LeftEyePan, 0, -30, 30, 0});
  contents.joints.push_back({Joint::LeftEyeTilt, 0, -20, 20, 0});
  LoadedImage loaded = load_image(write_image(contents));
  return loaded.image.value();
}

using Log = std::vector<std::string>;

/// Shows a 10 x 10 picture whose left and right half are lit or not.
class ScriptedCamera final : public Camera {
 public:
  explicit ScriptedCamera(std::string name = "", Log* log = nullptr) : name_(std::move(name)), log_(log) {}

  CameraStatus status = CameraStatus::NewFrame;
  bool is_left_lit = false, is_right_lit = false;
  int side_px = 10;
  TimeNs latency_ns = 5 * kMs;

  [[nodiscard]] CameraStatus read(TimeNs now_ns, Frame& out) noexcept override {
    if (log_ != nullptr) {
      log_->push_back("read " + name_);
    }
    if (status == CameraStatus::NewFrame) {
      const auto side = static_cast<std::size_t>(side_px);
      pixels_.assign(3 * side * side, 0);
      for (std::size_t i = 0; i < side * side; ++i) {
        pixels_[3 * i + 2] = (i % side < side / 2 ? is_left_lit : is_right_lit) ? 255 : 0;
      }
      out = {pixels_.data(), side_px, side_px, 3 * side, now_ns - latency_ns, ++frames_};
    }
    return status;
  }

 private:
  std::string name_;
  Log* log_;
  std::vector<std::uint8_t> pixels_;
  std::uint64_t frames_ = 0;
};

/// Joints are where they were told to be.
class ScriptedServos final : public ServoBus {
 public:
  explicit ScriptedServos(Log* log = nullptr) : log_(log) {}
  bool is_writable = true;
  std::uint32_t fresh_mask = 0b111111;
  std::vector<ServoCommand> commands;
  std::array<double, kJointCount> position_deg{};

  [[nodiscard]] bool write(const ServoCommand& command) noexcept override {
    if (log_ != nullptr) {
      log_->push_back("write");
    }
    commands.push_back(command);
    position_deg = command.goal_deg;
    return is_writable;
  }
  void read(TimeNs now_ns, ServoFeedback& out) noexcept override {
    if (log_ != nullptr) {
      log_->push_back("read servos");
    }
    out = {now_ns, position_deg, fresh_mask};
  }

 private:
  Log* log_;
};

/// Time passes while the loop sleeps, and by `late_ns` more on request.
class ManualClock final : public Clock {
 public:
  explicit ManualClock(Log* log = nullptr) : log_(log) {}
  TimeNs time_ns = 5'000 * kMs;
  std::deque<TimeNs> late_ns;
  std::vector<TimeNs> wakes_ns;

  [[nodiscard]] TimeNs now_ns() noexcept override { return time_ns; }
  void sleep_until(TimeNs when_ns) noexcept override {
    if (log_ != nullptr) {
      log_->push_back("sleep");
    }
    wakes_ns.push_back(when_ns);
    time_ns = std::max(time_ns, when_ns);
    if (!late_ns.empty()) {
      time_ns += late_ns.front();
      late_ns.pop_front();
    }
  }

 private:
  Log* log_;
};

class SpikeLog final : public SpikeSink {
 public:
  explicit SpikeLog(Log* log = nullptr) : log_(log) {}
  std::uint64_t ticks = 0;
  std::vector<RecordedSpike> spikes;

  void take(std::uint64_t tick, std::span<const NeuronId> fired) noexcept override {
    if (log_ != nullptr && (log_->empty() || log_->back() != "ticks")) {
      log_->push_back("ticks");
    }
    ++ticks;
    for (const NeuronId neuron : fired) {
      spikes.push_back({tick, static_cast<std::uint32_t>(neuron)});
    }
  }

 private:
  Log* log_;
};

}  // namespace tectum
