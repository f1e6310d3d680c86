// The robustness protocol of `tectum eval`: a circuit in worlds that are worse, and the circuit itself worse.
#pragma once

#include <string>

#include "tools/evaluate/protocol.h"
#include "tools/evaluate/robustness.h"
#include "tools/tectum/load_circuit.h"

namespace tectum {

/// Reads the plan, compiles, runs. Nothing when something is wrong, which is printed, and the exit status set.
[[nodiscard]] std::optional<MeasuredProtocol> eval_robustness(const CircuitArguments& circuit, const Protocol& protocol,
                                                              const std::string& protocol_path, unsigned threads,
                                                              CommandContext& context);

}  // namespace tectum
