#pragma once

#include <string>
#include <vector>

#include "tools/evaluate/protocol.h"
#include "tools/tectum/load_circuit.h"

namespace tectum {

/// `tectum eval --protocol clinic`: one compilation and one trial a lesion and circuit. `protocol_path` holds the
/// lesions; `report_path` is where the page of pictures goes, or empty.
void eval_clinic(const std::vector<CircuitArguments>& circuits, const Protocol& protocol,
                 const std::string& protocol_path, const std::string& report_path, unsigned threads,
                 CommandContext& context);

}  // namespace tectum
