#include "runtime/engine/delivery.h"

#include <algorithm>

namespace tectum {

TouchedNeurons::HotArrays hot_arrays_of(const UpdateGroup& group) {
  const std::vector<const void*> arrays = group.hot_arrays();
  TouchedNeurons::HotArrays hot{};
  for (std::size_t h = 0; h < hot.size() && !arrays.empty(); ++h) {
    hot[h] = static_cast<const std::uint32_t*>(arrays[std::min(h, arrays.size() - 1)]);
  }
  return hot;
}

}  // namespace tectum
