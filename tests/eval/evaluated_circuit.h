// The shipped circuit and its protocols, for the tests of evaluations.
#pragma once

#include <string>

#include "compiler/compile.h"
#include "runtime/image/load_image.h"
#include "tools/evaluate/protocol.h"

namespace tectum {

/// Of a file under circuits/.
[[nodiscard]] std::string shipped_path(const std::string& name);
[[nodiscard]] SpikeImage compiled_image(const std::string& name, const CompileOptions& options);
/// circuits/oculomotor.json, compiled once.
[[nodiscard]] const SpikeImage& oculomotor_image();
/// circuits/protocols/NAME.json.
[[nodiscard]] Protocol shipped_protocol(const std::string& name);

}  // namespace tectum
