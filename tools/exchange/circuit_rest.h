// What a SONATA network cannot say of a circuit: tectum.json in its folder.
//
//   name, tick, seed, parameters, axes, models, references, inputs, outputs, joints    as in a circuit file
//   populations   in the circuit's order, by their names without a side:
//                 { "axis": [...], "nucleus": ..., "mixed_signs": ..., "input": ... }
//   silenced      population sides that a lesion took out
#pragma once

#include <nlohmann/json.hpp>

#include "compiler/compile.h"

namespace tectum {

[[nodiscard]] nlohmann::ordered_json circuit_rest(const CompileResult& result);

}  // namespace tectum
