// Builds the rows of an image neuron by neuron, without ever holding an edge list.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/image/image_contents.h"

namespace tectum::bench {

/// Small and good enough for wiring: Steele, Lea & Flood 2014, doi:10.1145/2660193.2660195.
class SplitMix {
 public:
  explicit SplitMix(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  /// In [0, count).
  std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>((static_cast<unsigned __int128>(next()) * count) >> 64U);
  }

 private:
  std::uint64_t state_;
};

struct RowSynapse {
  std::uint32_t slot;
  std::int32_t quanta;
};

/// Appends the row of the next neuron: one segment of one delay. Sorts `synapses`.
void append_row(std::vector<RowSynapse>& synapses, std::uint32_t delay_ticks, ImageContents& image);
/// Closes the rows; neurons without one get an empty row.
void finish_rows(ImageContents& image);

}  // namespace tectum::bench
