// Text of messages about expressions.
#pragma once

#include <string>
#include <string_view>

namespace tectum {

/// `text` in backticks, shortened when long; control and broken bytes appear as \xNN, so that a
/// hostile file cannot write to the terminal.
std::string quoted(std::string_view text);

}  // namespace tectum
