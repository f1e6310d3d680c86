// Circuits as text, compiled and run.
#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "compiler/compile.h"
#include "runtime/image/load_image.h"

namespace tectum::test {

/// Compiles `text` as the file circuit.json; other files come from `options.read`. Fails the test on any error.
[[nodiscard]] ImageContents compile_text(const std::string& text, const CompileOptions& options = {});
[[nodiscard]] SpikeImage image_of(const ImageContents& contents);

/// (tick, population and side, number within it), ascending: the same whatever order the neurons were laid out in.
/// A dot in a name counts as `_`, so that "gen.EBN.left" and "gen_EBN_left" are one name.
using NamedRaster = std::vector<std::tuple<std::uint64_t, std::string, std::uint32_t>>;
[[nodiscard]] NamedRaster named_raster(const ImageContents& contents, std::uint64_t ticks);

/// "times": ["0.5 ms", ...] of a spike list whose spikes are `period_ticks` apart, at ticks of 0.1 ms.
[[nodiscard]] std::string spike_times(std::uint32_t first_tick, std::uint32_t period_ticks, std::uint32_t ticks);

}  // namespace tectum::test
