// What a circuit's retinas make of the pictures that another circuit's eyes saw.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/image/load_image.h"
#include "runtime/record/recording.h"
#include "runtime/sense/retina.h"

namespace tectum {

/// Input neurons that are lit, by frame; ascending.
using LitNeurons = std::vector<std::vector<std::uint32_t>>;

inline constexpr std::uint32_t kNoRetina = ~std::uint32_t{0};

/// For each retina of `b`, the one of `a` that has its name and the same fields over the same picture, or kNoRetina.
[[nodiscard]] std::vector<std::uint32_t> same_retinas(const SpikeImage& a, const SpikeImage& b);

/// What the second circuit's retinas make of the pictures that the first one's eyes see.
class PictureTap {
 public:
  /// Only the retinas without a twin need pictures.
  PictureTap(const SpikeImage& a, const SpikeImage& b);
  [[nodiscard]] bool needs_pictures() const;
  void see(std::size_t frame, const Frame& left, const Frame& right);
  /// After the run. Retinas that had no pictures are lit as the one of their name was, field by field.
  [[nodiscard]] LitNeurons lit_neurons(const Recording& recording_a) const;

 private:
  const SpikeImage& a_;
  const SpikeImage& b_;
  std::vector<std::uint32_t> twin_;
  std::vector<Retina> retinas_;
  std::vector<bool> is_prepared_;
  std::vector<std::vector<std::vector<std::uint32_t>>> seen_;  // [retina of b][frame]
};

/// Neurons of `a` that its retinas light in a frame, ascending.
[[nodiscard]] std::vector<std::uint32_t> lit_in(const SpikeImage& a, const RecordedFrame& frame);
/// The same as RecordedFrame::active_fields has them.
[[nodiscard]] std::array<std::vector<std::uint32_t>, kEyeCount> fields_of(const SpikeImage& image,
                                                                          const std::vector<std::uint32_t>& lit);

}  // namespace tectum
