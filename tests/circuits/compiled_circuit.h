// Shipped and edited circuits as images, for the tests of circuits.
#pragma once

#include <string>
#include <vector>

#include "runtime/image/load_image.h"

namespace tectum {

/// The text of circuits/oculomotor.json.
[[nodiscard]] std::string oculomotor_text();

/// Compiles; a circuit with errors fails the test with its diagnostics.
[[nodiscard]] SpikeImage compiled_circuit(const std::string& text, const std::vector<std::string>& lesions = {});

}  // namespace tectum
