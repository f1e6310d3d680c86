// The reward off the retina.
#include "runtime/learn/retinal_reward.h"

#include <doctest/doctest.h>

#include "tests/loop/loop_fixture.h"

namespace tectum::test {
namespace {

using Fields = std::array<std::vector<std::uint32_t>, kEyeCount>;

bool is_given(const RewardSample& sample, RewardChannel channel) {
  return ((sample.given >> static_cast<std::uint32_t>(channel)) & 1U) != 0;
}
double value(const RewardSample& sample, RewardChannel channel) {
  return sample.value[static_cast<std::size_t>(channel)];
}

/// Four fields of 2 by 2 pixels along the diagonal of an 8 by 8 frame of the left eye, top left first.
SpikeImage diagonal_image() {
  TestNetwork network;
  network.add("fields", {ModelKind::FieldSource, 4, {{"rate", {100.0}}}, {}, false});
  ImageContents contents = lower_network(network);
  contents.retinas.push_back(
      {contents.add_string("left"), Eye::Left, 8, 8, 40.0, LitChannel::Red, 100, 0.0, 0, 4, 0, 0});
  for (const float at : {0.F, 2.F, 4.F, 6.F}) {
    contents.fields.push_back({at, at, at + 2, at + 2});
  }
  return load_image(write_image(contents)).image.value();
}

}  // namespace

TEST_CASE("the reward falls from 1 in the middle to 0 at the edge, alike on both sides") {
  const RetinalReward reward(diagonal_image());
  for (const auto& [field, expected] : {std::pair{0U, 0.25}, {1U, 0.75}, {2U, 0.75}, {3U, 0.25}}) {
    CAPTURE(field);
    const RewardSample sample = reward.sample(Fields{{{field}, {}}});
    CHECK(value(sample, RewardChannel::LeftEyePan) == expected);
    CHECK(value(sample, RewardChannel::LeftEyeTilt) == expected);
    CHECK(value(sample, RewardChannel::Pan) == expected);
    CHECK_FALSE(is_given(sample, RewardChannel::RightEyePan));
  }
  CHECK(value(reward.sample(Fields{{{1, 2}, {}}}), RewardChannel::Pan) == 1.0);
}

TEST_CASE("a reward of one direction is negative once the target lies on the other side") {
  const RetinalReward reward(diagonal_image());
  const RewardSample top_left = reward.sample(Fields{{{0}, {}}});
  CHECK(value(top_left, RewardChannel::Leftward) == 0.25);
  CHECK(value(top_left, RewardChannel::Rightward) == -0.25);
  CHECK(value(top_left, RewardChannel::Upward) == 0.25);
  CHECK(value(top_left, RewardChannel::Downward) == -0.25);
  const RewardSample bottom_right = reward.sample(Fields{{{3}, {}}});
  CHECK(value(bottom_right, RewardChannel::Rightward) == 0.25);
  CHECK(value(bottom_right, RewardChannel::Upward) == -0.25);
  const RewardSample middle = reward.sample(Fields{{{1, 2}, {}}});
  CHECK(value(middle, RewardChannel::Rightward) == 0.0);
  CHECK(is_given(middle, RewardChannel::Rightward));
}

TEST_CASE("what no eye sees gives no reward, and a field that is none is no target") {
  const RetinalReward reward(diagonal_image());
  CHECK(reward.sample(Fields{}).given == 0);
  CHECK(reward.sample(Fields{{{99}, {0}}}).given == 0);
}

TEST_CASE("of two eyes the reward is the mean of those that see the target") {
  const RetinalReward reward(two_eyed_image());
  CHECK(value(reward.sample(Fields{{{0}, {0, 1}}}), RewardChannel::Pan) == 0.75);
  CHECK(value(reward.sample(Fields{{{0}, {}}}), RewardChannel::Pan) == 0.5);
  CHECK(value(reward.sample(Fields{{{0}, {0, 1}}}), RewardChannel::Leftward) == 0.75);
}

}  // namespace tectum::test
