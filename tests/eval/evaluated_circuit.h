// The shipped circuit and its protocols, for the tests of evaluations.
#pragma once

#include "runtime/image/load_image.h"
#include "tools/evaluate/protocol.h"

namespace tectum {

/// circuits/oculomotor.json, compiled once.
[[nodiscard]] const SpikeImage& oculomotor_image();
/// circuits/protocols/NAME.json.
[[nodiscard]] Protocol shipped_protocol(const std::string& name);

}  // namespace tectum
