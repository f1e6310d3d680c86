// The rules that wire projections: what a circuit file calls them and which keys they take.
#pragma once

#include <array>

#include "compiler/validate/circuit.h"

namespace tectum {

struct RuleSpelling {
  const char* text;
  RuleKind kind;
  std::array<const char*, 2> arguments;  // keys it takes; the first is required unless it is "autapses"
  const char* about;
};
inline constexpr std::array kRules = {
    RuleSpelling{"one_to_one", RuleKind::OneToOne, {nullptr, nullptr}, "neuron i to neuron i"},
    RuleSpelling{"all_to_all", RuleKind::AllToAll, {"autapses", nullptr}, "every neuron to every neuron"},
    RuleSpelling{"fixed_probability",
                 RuleKind::FixedProbability,
                 {"p", "autapses"},
                 "each pair with probability p, which may be an expression of the pair, such as a kernel of distance"},
    RuleSpelling{"fixed_in_degree", RuleKind::FixedInDegree, {"n", "autapses"}, "n sources drawn for each target"},
    RuleSpelling{"fixed_out_degree", RuleKind::FixedOutDegree, {"n", "autapses"}, "n targets drawn for each source"},
    RuleSpelling{"edges", RuleKind::EdgeList, {nullptr, "first_index"}, "the rows of a CSV file"},
};

}  // namespace tectum
