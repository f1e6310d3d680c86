// One side of a comparison: a circuit file, an image, or a recording with the circuit in it.
#pragma once

#include <optional>
#include <string>

#include "runtime/record/recording.h"
#include "tools/diff/behaviour.h"
#include "tools/diff/structure_diff.h"

namespace tectum {

struct DiffSubject {
  std::string path;
  CircuitView view;
  bool has_circuit = false;  // false: a recording without its image; the view knows populations alone
  std::optional<Recording> recording;
  std::string error;   // as printed; empty when the subject could be read
  std::string notice;  // one line worth saying: the recording is cut short
};

[[nodiscard]] DiffSubject load_subject(const std::string& path);

/// Populations are always matched; what else differs is known of two circuits only. Projections are forgotten unless
/// both subjects know them.
[[nodiscard]] StructureDiff compare_structure(DiffSubject& a, DiffSubject& b);

/// Two circuits: closed loop on the battery. A recording and a circuit: the circuit is driven by the recording's input.
/// Two recordings: as they were recorded.
[[nodiscard]] Behaviour compare_subjects(const DiffSubject& a, const DiffSubject& b, const StructureDiff& structure,
                                         const BehaviourOptions& options);

}  // namespace tectum
