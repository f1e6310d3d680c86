// What no exchange format can say of a circuit, in one line each.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/exchange/wiring.h"

namespace tectum {

/// Projections that learn, by name.
[[nodiscard]] std::vector<std::string> learning_limits(const Wiring& wiring, std::string_view format);
/// Retinas, outputs, joints and learning, by name. `format` reads as a subject: "GraphML".
[[nodiscard]] std::vector<std::string> head_limits(const Wiring& wiring, std::string_view format);
/// The same, and that the neurons' parameters stay behind.
[[nodiscard]] std::vector<std::string> head_and_model_limits(const Wiring& wiring, std::string_view format);
/// "a, b, c and 4 more"
[[nodiscard]] std::string list_names(const std::vector<std::string>& names);

}  // namespace tectum
