// What differs between two circuits as written out: by name, never by position.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/diff/circuit_view.h"

namespace tectum {

enum class Element { Circuit, Parameter, Population, Projection, Retina, Output, Joint };
enum class ChangeKind { Added, Removed, Renamed, Changed };
[[nodiscard]] const char* element_name(Element element);
[[nodiscard]] const char* change_name(ChangeKind kind);

struct Change {
  ChangeKind kind = ChangeKind::Changed;
  Element element = Element::Circuit;
  std::string name;      // "EBN.left", "ifn_llbn"
  std::string where;     // of a projection: "IFN.left -> LLBN.left"
  std::string property;  // "weight", "size", "tau_m"
  std::string before, after;
  std::string detail;   // "1600 of 1600 synapses"
  std::string place;    // "circuits/oculomotor.json:52" of the second circuit, where known
  std::string group;    // nucleus, for the listing
  std::string because;  // the written parameter whose change makes this one: "w_ifn_llbn is ... instead of ..."
};

inline constexpr std::uint32_t kNoMatch = ~std::uint32_t{0};

/// Which population and which pathway of one circuit is which of the other.
struct Correspondence {
  std::vector<std::uint32_t> population_of_a, population_of_b;  // in the other circuit, or kNoMatch
  struct PathwayPair {
    std::uint32_t a = kNoMatch, b = kNoMatch;
    bool differs = false;
  };
  std::vector<PathwayPair> pathways;
};

struct StructureDiff {
  Correspondence match;
  std::vector<Change> changes;
  [[nodiscard]] bool is_same() const { return changes.empty(); }
};

[[nodiscard]] StructureDiff diff_structure(const CircuitView& a, const CircuitView& b);

/// True when the weights are one within what rounding to quanta may do to them.
[[nodiscard]] bool is_same_weight(double a, int quantum_log2_a, double b, int quantum_log2_b);

/// "0.0332 nA"; at most six digits.
[[nodiscard]] std::string quantity_text(double value, const std::string& unit);

/// Changes that say the same of several sides, as one.
struct ChangeLine {
  std::string group;  // nucleus, or empty
  std::string text;   // "projection ifn_llbn, IFN -> LLBN: weight -0.0166 nA instead of -0.0332 nA (1600 of 1600 ...)"
  std::string sides;  // "left, right", or empty
  std::string because, place;  // of the first of them, may be empty
};
/// Group by group.
[[nodiscard]] std::vector<ChangeLine> change_lines(const StructureDiff& diff);

/// Lines for people; changes that say the same of several sides share one. Empty when nothing differs.
[[nodiscard]] std::string structure_text(const StructureDiff& diff);

}  // namespace tectum
