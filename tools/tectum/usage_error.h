// What the command line got wrong, in one line, and what was probably meant.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tectum {

/// The first argument, when it should have been a command and is none: "tectum: unknown command `rum`", with the
/// nearest command and where to read on.
[[nodiscard]] std::optional<std::string> unknown_command(const CLI::App& app, const std::vector<std::string>& args);

/// "tectum run: circuit is required", with the nearest option for one that is misspelt and where to read on.
[[nodiscard]] std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace tectum
