// A connectivity matrix as a circuit: one population where it is square, sources and targets where it is not.
#pragma once

#include <optional>
#include <string>

#include "tools/exchange/foreign_circuit.h"
#include "tools/exchange/matrix_file.h"

namespace tectum {

struct MatrixImport {
  std::string path;
  std::string variable;  // empty: the only one
  bool rows_are_targets = false;
  double weight_na = 0.1;  // of an entry of 1
  double delay_ms = 1;
  bool divides_by_input = false;             // each entry by the sum of sizes of all that its target gets
  std::optional<double> leading_eigenvalue;  // scale the matrix to it, before weight_na
  std::optional<double> drive_hz;            // Poisson input that makes each cell fire at about this rate
};

/// Nothing, and one line in `error`, when the matrix cannot be read or scaled.
[[nodiscard]] std::optional<ForeignCircuit> import_matrix(const MatrixImport& options, std::string& error);

/// Size of the eigenvalue of largest size: the mean growth of a vector under repeated multiplication. 0 where nothing
/// grows, as in a matrix without cycles. Needs: a square matrix.
[[nodiscard]] double leading_eigenvalue(const SparseMatrix& matrix);

}  // namespace tectum
