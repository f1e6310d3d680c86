#include "runtime/act/decoder.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

using namespace tectum;

namespace {

constexpr std::uint32_t kLeftPan = 0, kRightPan = 2, kNeckPan = 4;

std::uint32_t mask(std::initializer_list<std::uint32_t> joints) {
  std::uint32_t bits = 0;
  for (const std::uint32_t j : joints) {
    bits |= 1U << j;
  }
  return bits;
}

struct Term {
  std::uint32_t first, size;
  double gain;
};

/// An image of outputs alone, with a tick of 1 ms.
class Outputs {
 public:
  Outputs& add(OutputKind kind, std::uint32_t joints, std::uint32_t window_ticks, double offset_deg,
               const std::vector<Term>& terms) {
    outputs_.push_back({.name = kNoString,
                        .kind = kind,
                        .first_term = static_cast<std::uint32_t>(terms_.size()),
                        .term_count = static_cast<std::uint32_t>(terms.size()),
                        .joint_mask = joints,
                        .window_ticks = window_ticks,
                        .offset_deg = offset_deg});
    for (const Term& t : terms) {
      terms_.push_back({.first_neuron = t.first, .size = t.size, .gain = t.gain});
    }
    return *this;
  }
  [[nodiscard]] Decoder decoder() const {
    SpikeImage image;
    image.header.tick_ns = 1'000'000;
    image.outputs = outputs_;
    image.output_terms = terms_;
    return Decoder(image);
  }

 private:
  std::vector<OutputRecord> outputs_;
  std::vector<OutputTermRecord> terms_;
};

void tick(Decoder& decoder, std::initializer_list<std::uint32_t> neurons) {
  std::vector<NeuronId> spikes;
  for (const std::uint32_t n : neurons) {
    spikes.push_back(NeuronId{n});
  }
  decoder.tick(spikes);
}

std::array<double, kJointCount> goals(const Decoder& decoder) {
  std::array<double, kJointCount> goal{};
  goal.fill(99);
  decoder.decode(goal);
  return goal;
}

}  // namespace

TEST_CASE("a position output is its offset plus gain times the mean rate of its neurons") {
  // Two neurons, window 10 ms: one spike is 50 Hz of mean rate.
  Decoder decoder = Outputs().add(OutputKind::Position, mask({kLeftPan}), 10, 3.0, {{4, 2, 0.1}}).decoder();
  CHECK(goals(decoder)[kLeftPan] == 3.0);
  tick(decoder, {4});
  CHECK(goals(decoder)[kLeftPan] == doctest::Approx(3.0 + 0.1 * 50));
  tick(decoder, {4, 5});
  CHECK(goals(decoder)[kLeftPan] == doctest::Approx(3.0 + 0.1 * 150));
}

TEST_CASE("a spike counts for exactly the window and then no more") {
  Decoder decoder = Outputs().add(OutputKind::Position, mask({kLeftPan}), 3, 0.0, {{0, 1, 1.0}}).decoder();
  tick(decoder, {0});
  tick(decoder, {});
  tick(decoder, {});
  CHECK(goals(decoder)[kLeftPan] == doctest::Approx(1000.0 / 3));
  tick(decoder, {});
  CHECK(goals(decoder)[kLeftPan] == 0.0);
}

TEST_CASE("opponent terms subtract, and spikes of other neurons do not count") {
  Decoder decoder =
      Outputs().add(OutputKind::Position, mask({kLeftPan}), 10, 0.0, {{2, 2, 0.5}, {4, 2, -0.5}}).decoder();
  tick(decoder, {0, 1, 6, 7});
  CHECK(goals(decoder)[kLeftPan] == 0.0);
  tick(decoder, {2, 3, 4});
  CHECK(goals(decoder)[kLeftPan] == doctest::Approx(0.5 * 100 - 0.5 * 50));
}

TEST_CASE("outputs add up on the joints that they name, and a joint without an output stays at 0") {
  Decoder decoder = Outputs()
                        .add(OutputKind::Position, mask({kLeftPan, kRightPan}), 1, 5.0, {})  // conjugate
                        .add(OutputKind::Position, mask({kLeftPan}), 1, 2.0, {})             // vergence
                        .add(OutputKind::Position, mask({kRightPan}), 1, -2.0, {})
                        .decoder();
  CHECK(goals(decoder) == std::array<double, kJointCount>{7, 0, 3, 0, 0, 0});
}

TEST_CASE("a velocity output integrates from its offset") {
  // One neuron that fires in every tick of 1 ms: 1000 Hz, 0.02 deg/s/Hz, so 20 deg/s.
  Decoder decoder = Outputs().add(OutputKind::Velocity, mask({kNeckPan}), 1, 4.0, {{0, 1, 0.02}}).decoder();
  CHECK(goals(decoder)[kNeckPan] == 4.0);
  for (int i = 0; i < 500; ++i) {
    tick(decoder, {0});
  }
  CHECK(goals(decoder)[kNeckPan] == doctest::Approx(14.0));
  tick(decoder, {});
  CHECK(goals(decoder)[kNeckPan] == doctest::Approx(14.0));
}

TEST_CASE("a velocity joint held by the guard comes back at once when its drive turns round") {
  Decoder decoder =
      Outputs().add(OutputKind::Velocity, mask({kNeckPan}), 1, 0.0, {{0, 1, 0.02}, {1, 1, -0.02}}).decoder();
  for (int i = 0; i < 100; ++i) {
    tick(decoder, {0});
    std::array<double, kJointCount> guarded = goals(decoder);
    guarded[kNeckPan] = std::min(guarded[kNeckPan], 1.0);
    decoder.accept(guarded);
  }
  tick(decoder, {1});
  CHECK(goals(decoder)[kNeckPan] == doctest::Approx(1.0 - 0.02));
}

TEST_CASE("a slewed position output does not move the integral beside it") {
  Decoder decoder = Outputs()
                        .add(OutputKind::Velocity, mask({kNeckPan}), 1, 0.0, {{0, 1, 0.02}})
                        .add(OutputKind::Position, mask({kNeckPan}), 1, 0.0, {{1, 1, 0.01}})
                        .decoder();
  tick(decoder, {0, 1});  // 0.02 deg integrated, 10 deg of position
  CHECK(goals(decoder)[kNeckPan] == doctest::Approx(10.02));
  std::array<double, kJointCount> guarded{};
  guarded[kNeckPan] = 6.0;  // the slew limit lets 6 of 10 deg through
  decoder.accept(guarded);
  CHECK(goals(decoder)[kNeckPan] == doctest::Approx(10.0));  // only this turn's 0.02 deg are taken back
  decoder.accept(guarded);
  CHECK(goals(decoder)[kNeckPan] == doctest::Approx(10.0));
}

TEST_CASE("a guarded angle that is no number leaves the integral alone") {
  Decoder decoder = Outputs().add(OutputKind::Velocity, mask({kNeckPan}), 1, 4.0, {{0, 1, 0.02}}).decoder();
  std::array<double, kJointCount> guarded{};
  guarded.fill(std::numeric_limits<double>::quiet_NaN());
  decoder.accept(guarded);
  CHECK(goals(decoder)[kNeckPan] == 4.0);
}

TEST_CASE("reset forgets the window and the integral") {
  Decoder decoder = Outputs()
                        .add(OutputKind::Velocity, mask({kNeckPan}), 5, 4.0, {{0, 1, 0.02}})
                        .add(OutputKind::Position, mask({kLeftPan}), 5, 1.0, {{0, 1, 0.1}})
                        .decoder();
  for (int i = 0; i < 7; ++i) {
    tick(decoder, {0});
  }
  decoder.reset();
  CHECK(goals(decoder) == std::array<double, kJointCount>{1, 0, 0, 0, 4, 0});
  tick(decoder, {});
  CHECK(goals(decoder)[kLeftPan] == 1.0);
}
