#include "compiler/elaborate/edge_rows.h"

#include <algorithm>

namespace tectum {

EdgeRows::EdgeRows(const EdgeTable& table)
    : table_(table), reader_(table.path, table.separator), fields_(table.columns.size()) {
  std::vector<std::size_t> columns;
  const auto add = [&](std::size_t column) {
    const auto found = std::find(columns.begin(), columns.end(), column);
    places_.push_back(static_cast<std::size_t>(found - columns.begin()));
    if (found == columns.end()) {
      columns.push_back(column);
    }
  };
  for (const std::size_t column : table.columns) {
    add(column);
  }
  for (const RowFilter& filter : table.rows) {
    add(filter.column);
  }
  selected_.resize(columns.size());
  if (reader_.error().empty()) {
    reader_.select(std::move(columns), table.has_header);
  }
}

CsvRow EdgeRows::next(std::span<std::string_view> fields) {
  while (true) {
    const CsvRow row = reader_.next_fields(selected_);
    if (row != CsvRow::Read) {
      return row;
    }
    bool is_meant = true;
    for (std::size_t f = 0; f < table_.rows.size() && is_meant; ++f) {
      const std::vector<std::string>& texts = table_.rows[f].texts;
      is_meant = std::find(texts.begin(), texts.end(), selected_[places_[table_.columns.size() + f]]) != texts.end();
    }
    if (is_meant) {
      for (std::size_t c = 0; c < fields.size(); ++c) {
        fields[c] = selected_[places_[c]];
      }
      return CsvRow::Read;
    }
  }
}

bool EdgeRows::next_numbers(std::span<double> values) {
  const CsvRow row = next(fields_);
  bool is_sound = row == CsvRow::Read;
  for (std::size_t c = 0; c < fields_.size() && is_sound; ++c) {
    is_sound = read_number(fields_[c], c, values[c]);
  }
  if (row != CsvRow::End && !is_sound) {
    error_ = row_error();
  }
  return is_sound;
}

}  // namespace tectum
