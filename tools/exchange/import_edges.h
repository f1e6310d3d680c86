// An edge list, and perhaps a table of its cells, as a circuit file that refers to both.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "compiler/source/bad_rows.h"

namespace tectum {

/// What drives a class of cells from outside, so that the imported circuit does something.
struct DrivenClass {
  std::string name;
  double rate_hz = 100;
};

/// Weights of the imported edges.
enum class EdgeScaling {
  PerSynapse,    // a fixed weight times the column
  ShareOfInput,  // a fixed weight times the share of all that arrives at the cell
};

/// Names of columns are empty where they are to be guessed.
struct EdgeImport {
  std::string edges_path, cells_path, output_path;
  std::string name;       // of the circuit
  char separator = '\0';  // 0: whichever the first line uses most
  std::string pre, post, weight, type;
  std::string id, cell_class, side, sign;  // of the table of cells
  std::vector<std::string> inhibitory;     // classes whose cells inhibit, beside what `sign` says
  std::vector<DrivenClass> driven;
  EdgeScaling scaling = EdgeScaling::PerSynapse;
  std::optional<double> leading_eigenvalue_na;  // scale all weights to it
};

struct ImportedPopulation {
  std::string name, cell_class, side, sign;  // as the table has them
  bool is_inhibitory = false;
  std::uint32_t size = 0;
};

/// A circuit's text, or why there is none: one line, or rows at fault.
struct ImportedEdges {
  std::string text;
  std::string error;
  std::string help;
  BadRows bad_rows;
  std::string bad_path;
  std::vector<ImportedPopulation> populations;
  std::uint64_t cells = 0, edges = 0;
  std::string columns;  // which were taken for what
};

/// Reads both files once and checks every row. `watch` is called with the share that is done.
[[nodiscard]] ImportedEdges import_edges(const EdgeImport& options, const std::function<void(double)>& watch);

}  // namespace tectum
