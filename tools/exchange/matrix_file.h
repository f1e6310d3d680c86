// Matrices in NumPy's .npy and .npz and MATLAB's level 5 .mat files.
//
// Formats: numpy.lib.format 1.0 to 3.0; PKWARE APPNOTE 6.3 (stored and deflated members); "MAT-File Format", MathWorks,
// level 5. scipy.sparse.save_npz writes the members format, shape, data, indices, indptr (csr, csc) or row, col (coo).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tectum {

/// The entries that are not zero, each once, row by row.
struct SparseMatrix {
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;
  std::vector<std::uint32_t> row, column;
  std::vector<double> value;
};

/// Reads the matrix called `variable`, or the only one. Nothing, and one line in `error`, when the file is damaged or
/// does not say which is meant: the line then lists what there is.
[[nodiscard]] std::optional<SparseMatrix> read_matrix(const std::string& path, const std::string& variable,
                                                      std::string& error);

}  // namespace tectum
