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

/// The same of a file in circuits/, with parameters as on the command line.
[[nodiscard]] SpikeImage shipped_circuit(const std::string& file, const std::vector<std::string>& parameters = {},
                                         const std::vector<std::string>& lesions = {});

}  // namespace tectum
