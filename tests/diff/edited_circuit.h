// Shipped circuits with one thing changed, compared.
#pragma once

#include <string>

#include "tools/diff/load_view.h"
#include "tools/diff/structure_diff.h"

namespace tectum {

/// circuits/oculomotor.json.
[[nodiscard]] std::string oculomotor_text();
/// tests/diff/small_eye.json.
[[nodiscard]] std::string small_eye_text();

/// `text` with its only `what` replaced; fails the test when there is none or more than one.
[[nodiscard]] std::string edited(std::string text, const std::string& what, const std::string& with);

/// Fails the test with the diagnostics when it does not compile.
[[nodiscard]] CircuitView compiled_view(const std::string& text);

}  // namespace tectum
