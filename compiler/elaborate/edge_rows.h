// The rows of an edge list that a projection means.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/source/csv_reader.h"
#include "compiler/validate/circuit.h"

namespace tectum {

/// Leaves out the rows that EdgeTable::rows does not name. Needs: a table that outlives it.
class EdgeRows {
 public:
  explicit EdgeRows(const EdgeTable& table);

  /// The next row's pre, post and further columns as text; they hold until the next call.
  [[nodiscard]] CsvRow next(std::span<std::string_view> fields);
  /// The same as numbers. False at the end, or when error() says why not.
  [[nodiscard]] bool next_numbers(std::span<double> values);
  [[nodiscard]] bool read_number(std::string_view field, std::size_t column, double& value) {
    return reader_.read_number(field, places_[column], value);
  }

  [[nodiscard]] const std::string& error() const { return error_.empty() ? reader_.error() : error_; }
  [[nodiscard]] const std::string& row_error() const { return reader_.row_error(); }
  [[nodiscard]] const std::string& path() const { return reader_.path(); }
  [[nodiscard]] std::uint64_t line() const { return reader_.line(); }
  [[nodiscard]] double share_read() const { return reader_.share_read(); }

 private:
  const EdgeTable& table_;
  CsvReader reader_;
  std::vector<std::size_t> places_;         // of EdgeTable::columns, then of its row filters, in what is selected
  std::vector<std::string_view> selected_;  // what is read of a row
  std::vector<std::string_view> fields_;    // of next_numbers()
  std::string error_;
};

}  // namespace tectum
