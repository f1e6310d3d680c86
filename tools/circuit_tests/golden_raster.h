// Spikes as a text that is kept beside a test: exact, short, and good to read in a diff.
//
//   # tectum raster 1: --scenario jump --duration 2 --seed 1
//   # ticks of 0.5 ms; each line: a bin of 10 ms, population, spikes, then tick:neurons (# checksum where they are
//   many) 1030 ms  EBN.right   14  2068:0-3,9 2069:4-8 2075:0-3 1030 ms  OPN         92  #5d0c1be2a90f7731
//
// Neurons count from 0 within their population. The lines follow time, then the order of the populations, and a bin
// without a spike has none, so that a change of one spike changes one line. More than 40 spikes in a line become their
// number and a checksum of ticks and neurons: still exact.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/record/recording.h"

namespace tectum {

struct RasterSelection {
  std::vector<std::size_t> populations;  // by index into the recording's
  double begin_s = 0, end_s = 0;         // half-open
};

/// `world` says what ran, for the first line.
[[nodiscard]] std::string golden_raster(const Recording& recording, const RasterSelection& selection,
                                        const std::string& world);

struct RasterChange {
  std::size_t lines = 0;    // that are in one of the two only
  std::string first_place;  // "1030 ms, EBN.right"
  std::string before, now;  // the rest of the first line that differs; empty when one has no such line
};

/// Nothing when they are the same.
[[nodiscard]] std::optional<RasterChange> compare_rasters(const std::string& golden, const std::string& now);
/// "34 lines differ, the first at 1030 ms, EBN.right: `…` instead of `…`"
[[nodiscard]] std::string change_text(const RasterChange& change);

}  // namespace tectum
