// Tables of cells: the files behind `tables`, read once, and the rows that each population asks for.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/parse/circuit_decl.h"
#include "compiler/source/bad_rows.h"
#include "compiler/validate/circuit.h"

namespace tectum {

struct Validation;

/// What a table's file says, as far as populations ask.
struct TableContents {
  std::uint32_t row_count = 0;                              // cells, in the order of the file
  std::map<std::string, std::vector<std::string>> columns;  // those that a population's `where` names, cell by cell
  bool is_sound = false;                                    // otherwise that has been reported
};

/// The character between columns, 0 when none is given. Reports and returns nothing when it is no character.
std::optional<char> separator_char(Validation& v, const std::optional<NameDecl>& separator);
/// Needs: at least one of them.
void report_bad_rows(Diagnostics& diagnostics, Code code, Span span, const std::string& path, const BadRows& bad);

/// Reads every table. Needs: nothing of the populations but their declarations.
void validate_tables(Validation& v);

/// The cells that become the population's neurons; notes in the table which they are. Reports and returns nothing when
/// there are none, or when one of them is another population's.
std::optional<std::uint32_t> assign_cells(Validation& v, const CellsDecl& decl, std::uint32_t instance,
                                          Population& population);

}  // namespace tectum
