// What a run has learned: as a small circuit file over the one that ran, and as lines to read.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "runtime/image/load_image.h"

namespace tectum {

/// A circuit file that extends `circuit_path`, to be written to `path`, whose weights start where `scales` (one a
/// plastic synapse of the image, in 2^-kScaleBits) has come to. Compiled, it gives exactly these weights. Pathways in
/// which nothing changed are left out.
[[nodiscard]] std::string learned_overlay(const SpikeImage& image, std::span<const std::int32_t> scales,
                                          const std::string& circuit_path, const std::string& path);

/// One line a pathway that learns: how its weights stand to the declared ones.
[[nodiscard]] std::string learned_text(const SpikeImage& image, std::span<const std::int32_t> scales);

}  // namespace tectum
