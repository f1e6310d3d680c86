// The protocol that a command's --protocol names.
#pragma once

#include <optional>
#include <string>

#include "tools/evaluate/protocol.h"
#include "tools/tectum/command.h"

namespace tectum {

/// A file when the name ends in .json; else protocols/NAME.json beside the circuit, else under circuits/ here.
[[nodiscard]] std::string protocol_path(const std::string& name, const std::string& circuit_path);

/// Prints what is wrong and sets the exit status when there is nothing to return.
[[nodiscard]] std::optional<Protocol> load_protocol(const std::string& name, const std::string& circuit_path,
                                                    CommandContext& context);

}  // namespace tectum
