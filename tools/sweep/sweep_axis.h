// What `-p NAME=VALUES` of a sweep means: a parameter and the values that it takes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tectum {

/// The axis of this name is the seed of the simulated world; every other one is a parameter of the circuit.
inline constexpr std::string_view kSeedAxis = "seed";
inline constexpr std::size_t kMostPoints = 100'000;

struct SweepAxis {
  std::string name;
  std::vector<std::string> values;  // as `-p` of the other commands takes them: "0.5 nA"
};

struct ReadAxis {
  std::optional<SweepAxis> axis;
  std::string error;  // one line, when there is none
};

/// NAME=ITEM,ITEM... where an item is a value, A..B (whole numbers, both ends in) or A..B:N (N values, evenly spaced,
/// both ends in). A unit may stand at either end: 0.2..0.4nA:5.
[[nodiscard]] ReadAxis read_axis(const std::string& text);

/// Why these cannot be swept together; empty when they can.
[[nodiscard]] std::string axes_problem(const std::vector<SweepAxis>& axes);

/// One value an axis, by its place; the first axis changes slowest.
using SweepPoint = std::vector<std::size_t>;
[[nodiscard]] std::vector<SweepPoint> points_of(const std::vector<SweepAxis>& axes);

}  // namespace tectum
