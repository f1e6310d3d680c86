// Checks everything that readers of an image rely on.
#pragma once

#include <string>

#include "runtime/image/load_image.h"

namespace tectum {

/// Empty when every index, range, order and enumerator of every section is right; otherwise one
/// line that says what is wrong and where. Reads every array once. Looks at no checksum.
[[nodiscard]] std::string verify_image(const SpikeImage& image);

}  // namespace tectum
