// A small image that has something in every section.
#pragma once

#include "runtime/image/image_contents.h"

namespace tectum::test {

[[nodiscard]] ImageContents example_contents();

}  // namespace tectum::test
