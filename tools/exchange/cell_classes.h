// The cells of a table, sorted into populations by class, side and sign.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "compiler/source/cell_numbers.h"
#include "compiler/source/csv_reader.h"
#include "tools/exchange/import_edges.h"

namespace tectum {

/// The column called `wanted`, or, where nothing is wanted, the first of `guesses` that the header has; case counts for
/// nothing. npos when there is none.
[[nodiscard]] std::size_t find_column(const std::vector<std::string>& header, const std::string& wanted,
                                      const std::vector<std::string>& guesses);

/// "KCs_L": letters, digits and `_` of the class and the side.
[[nodiscard]] std::string population_name(const std::string& cell_class, const std::string& side);

/// Reads the table into `imported` (populations, bad rows, error), numbers the cells and notes which inhibit. Fills in
/// the names of the columns in `options`.
void read_cell_classes(EdgeImport& options, CellNumbers& cells, std::vector<bool>& inhibits, ImportedEdges& imported);

}  // namespace tectum
