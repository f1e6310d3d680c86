#include "runtime/learn/retinal_reward.h"

#include <algorithm>
#include <cmath>

namespace tectum {
namespace {

void give(RewardSample& sample, RewardChannel channel, double value) noexcept {
  const auto number = static_cast<std::uint32_t>(channel);
  sample.value[number] = value;
  sample.given |= 1U << number;
}

double side_of(double place) noexcept { return place > 0 ? 1.0 : place < 0 ? -1.0 : 0.0; }

}  // namespace

RetinalReward::RetinalReward(const SpikeImage& image) {
  for (const RetinaRecord& retina : image.retinas) {
    const double half_width = retina.frame_width / 2.0;
    const double half_height = retina.frame_height / 2.0;
    for (const FieldRecord& field : image.fields.subspan(retina.first_field, retina.field_count)) {
      const double x =
          (0.5 * (static_cast<double>(field.x0) + static_cast<double>(field.x1)) - half_width) / half_width;
      const double y =
          (half_height - 0.5 * (static_cast<double>(field.y0) + static_cast<double>(field.y1))) / half_height;
      fields_[static_cast<std::size_t>(retina.eye)].push_back({std::clamp(x, -1.0, 1.0), std::clamp(y, -1.0, 1.0)});
    }
  }
}

RewardSample RetinalReward::sample(
    const std::array<std::vector<std::uint32_t>, kEyeCount>& active_fields) const noexcept {
  RewardSample sample;
  double pan_reward = 0, tilt_reward = 0, x_of_both = 0, y_of_both = 0;
  int eyes = 0;
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    double x = 0, y = 0;
    int count = 0;
    for (const std::uint32_t field : active_fields[e]) {
      if (field < fields_[e].size()) {
        x += fields_[e][field].x;
        y += fields_[e][field].y;
        ++count;
      }
    }
    if (count == 0) {
      continue;
    }
    x /= count;
    y /= count;
    const double pan = 1 - std::abs(x);
    const double tilt = 1 - std::abs(y);
    const bool is_left = e == static_cast<std::size_t>(Eye::Left);
    give(sample, is_left ? RewardChannel::LeftEyePan : RewardChannel::RightEyePan, pan);
    give(sample, is_left ? RewardChannel::LeftEyeTilt : RewardChannel::RightEyeTilt, tilt);
    pan_reward += pan;
    tilt_reward += tilt;
    x_of_both += x;
    y_of_both += y;
    ++eyes;
  }
  if (eyes == 0) {
    return sample;
  }
  give(sample, RewardChannel::Pan, pan_reward / eyes);
  give(sample, RewardChannel::Tilt, tilt_reward / eyes);
  const double rightward = side_of(x_of_both) * pan_reward / eyes;
  const double upward = side_of(y_of_both) * tilt_reward / eyes;
  give(sample, RewardChannel::Rightward, rightward);
  give(sample, RewardChannel::Leftward, -rightward);
  give(sample, RewardChannel::Upward, upward);
  give(sample, RewardChannel::Downward, -upward);
  return sample;
}

}  // namespace tectum
