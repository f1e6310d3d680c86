// From where two circuits first differ to the edit that makes them differ, and on to what follows from it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/diff/lock_step.h"

namespace tectum {

enum class LinkKind { Field, Spike, Potential, Command };

/// One place that comes to differ, and why.
struct DivergenceLink {
  LinkKind kind = LinkKind::Spike;
  std::string what;        // "LLBN.left[3]", "left_eye_pan"
  std::string population;  // of the second circuit; empty for a command
  double time_ms = 0;
  std::string how;                   // "fires in the second only", "-54.98 mV instead of -55.32 mV"
  std::size_t others = 0;            // neurons of the same population that differ at the same time
  std::string why;                   // the edit, or the pathway that brings the difference, with numbers
  std::string from;                  // population that brings it; empty when an edit acts here
  std::vector<std::size_t> changes;  // of StructureDiff::changes that act here, the decisive one first
};

struct Divergence {
  std::vector<DivergenceLink> links;  // ascending in time; the first is the first difference. Empty: none
  double compared_s = 0;
  bool is_driven = true;  // by one input, that of the first; false: two recordings, each with its own
};

struct DivergenceInput {
  const CircuitView& a;
  const CircuitView& b;
  const StructureDiff& structure;
  const Recording& recording_a;
  const Recording& recording_b;
  std::function<void(std::size_t frame)> produce_b;  // see lock_step(); may be empty
};

/// Compares, and explains. Looks at potentials only where neither a spike nor a command tells the two apart.
[[nodiscard]] Divergence find_divergence(const DivergenceInput& input);

/// ", through llbn_ebn, ..." or ", because weight of ..." to follow what happened; empty where nobody knows why.
[[nodiscard]] std::string why_clause(const DivergenceLink& link);

/// Lines for people; names no more than `most_links` places.
[[nodiscard]] std::string divergence_text(const Divergence& divergence, std::size_t most_links = 8);

}  // namespace tectum
