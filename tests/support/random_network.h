// Circuits that nobody would draw: for properties that hold for every circuit.
#pragma once

#include <cstdint>

#include "runtime/image/image_contents.h"

namespace tectum::test {

/// One to six populations of any model with random parameters, wired at random with delays from 0 (only
/// forwards, so that no cycle comes of it) to thousands of ticks. One seed in 32 makes groups that are
/// large enough to be divided among threads. The same seed gives the same circuit on every machine.
[[nodiscard]] ImageContents random_image(std::uint64_t seed);

}  // namespace tectum::test
