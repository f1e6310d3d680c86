// The reward: how near to the middle of the retina the target is seen.
//
//   R = 1 - |x|      x from 0 in the middle to 1 at the edge: the mean of the centres of the eye's active fields
//
// (Balachandar & Michmizos 2020, arXiv:2002.07534, Fig. 2; absolute on both sides, which the authors' program is not.)
// A channel of both eyes is the mean of those that see the target. A channel of one direction is that mean while the
// target still lies there, and its negative once it lies on the other side (by the mean of x), as in the authors'
// program: it tells a movement that was too small from one that was too large. While nothing is seen, nothing is given.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/image/load_image.h"
#include "runtime/learn/learner.h"

namespace tectum {

class RetinalReward {
 public:
  /// Not real-time safe.
  explicit RetinalReward(const SpikeImage& image);

  /// Active fields of each eye, counted through that eye's retinas; a number that no field has counts as none.
  /// Real-time safe.
  [[nodiscard]] RewardSample sample(
      const std::array<std::vector<std::uint32_t>, kEyeCount>& active_fields) const noexcept;

 private:
  struct Place {
    double x, y;  // right and up, 1 at the edge
  };
  std::array<std::vector<Place>, kEyeCount> fields_;
};

}  // namespace tectum
