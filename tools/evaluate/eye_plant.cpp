#include "tools/evaluate/eye_plant.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/act/decoder.h"

namespace tectum {
namespace {

constexpr std::array<std::array<Joint, 2>, kEyeCount> kEyeJoints = {
    {{Joint::LeftEyePan, Joint::LeftEyeTilt}, {Joint::RightEyePan, Joint::RightEyeTilt}}};

}  // namespace

EyePlant::EyePlant(double step_s, double start_deg) : muscle_deg_(start_deg), eye_deg_(start_deg) {
  const auto [first_s, second_s] = kEyePlantPolesS;
  kept_ = {std::exp(-step_s / first_s), std::exp(-step_s / second_s)};
  carried_ = first_s / (first_s - second_s) * (kept_[0] - kept_[1]);
}

double EyePlant::step(double drive_deg) {
  const double muscle_off_deg = muscle_deg_ - drive_deg;
  eye_deg_ = drive_deg + kept_[1] * (eye_deg_ - drive_deg) + carried_ * muscle_off_deg;
  muscle_deg_ = drive_deg + kept_[0] * muscle_off_deg;
  return eye_deg_;
}

std::array<AngleTrace, kEyeCount> eye_movements(const SpikeImage& image, const Recording& recording) {
  std::vector<OutputRecord> outputs(image.outputs.begin(), image.outputs.end());
  for (OutputRecord& output : outputs) {
    output.window_ticks = 1;
  }
  SpikeImage unwindowed = image;
  unwindowed.outputs = outputs;
  Decoder decoder(unwindowed);
  const double tick_s = static_cast<double>(recording.tick_ns) * 1e-9;
  const auto ticks_each = static_cast<std::uint64_t>(std::max(1.0, std::round(kEyeSampleS / tick_s)));
  const auto samples = static_cast<std::size_t>(recording.duration_s / kEyeSampleS);
  std::array<std::array<EyePlant, 2>, kEyeCount> plants = {
      {{EyePlant(tick_s), EyePlant(tick_s)}, {EyePlant(tick_s), EyePlant(tick_s)}}};
  std::array<AngleTrace, kEyeCount> traces;
  std::vector<NeuronId> now;
  std::size_t next = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    std::array<std::array<double, 2>, kEyeCount> angle_deg{};
    for (std::uint64_t tick = k * ticks_each; tick < (k + 1) * ticks_each; ++tick) {
      now.clear();
      for (; next < recording.spikes.size() && recording.spikes[next].tick == tick; ++next) {
        now.push_back(NeuronId{recording.spikes[next].neuron});
      }
      decoder.tick(now);
      std::array<double, kJointCount> drive_deg{};
      decoder.decode(drive_deg);
      for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
          angle_deg[eye][axis] = plants[eye][axis].step(drive_deg[static_cast<std::size_t>(kEyeJoints[eye][axis])]);
        }
      }
    }
    for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
      traces[eye].time_s.push_back(static_cast<double>(k) * kEyeSampleS);
      traces[eye].pan_deg.push_back(angle_deg[eye][0]);
      traces[eye].tilt_deg.push_back(angle_deg[eye][1]);
    }
  }
  return traces;
}

}  // namespace tectum
