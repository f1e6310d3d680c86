// The meaning of an image's bytes, for people.
#pragma once

#include <cstddef>
#include <string>

#include "runtime/image/load_image.h"

namespace tectum {

struct DescribeOptions {
  bool in_full = false;              // every record of every array
  std::size_t records_an_array = 8;  // otherwise the first so many
};

/// Byte ranges and their meaning, in the order of the file. Needs: an image that load_image
/// accepted. Ends with a newline.
[[nodiscard]] std::string describe_image(const SpikeImage& image, const DescribeOptions& options = {});

}  // namespace tectum
