// The generator lives with the image, because the compiler draws from it too.
#pragma once

#include "runtime/image/philox.h"
