#include "compiler/validate/read_edge_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "compiler/source/csv_reader.h"

namespace tectum {

std::optional<std::size_t> EdgeTableReader::find_column(const std::string& name, Span span,
                                                        const std::vector<std::string>& header) {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found != header.end()) {
    return static_cast<std::size_t>(found - header.begin());
  }
  v_.diagnostics()
      .add(Code::BadEdgeList, span, {fmt::format("{} has no column `{}`", rule_.path, name)})
      .help(fmt::format("it has {}", fmt::join(header, ", ")));
  return std::nullopt;
}

std::optional<EdgeTable> EdgeTableReader::read() {
  const Span file_span = rule_.file->span;
  const auto separator = separator_char(v_, rule_.separator);
  if (!separator) {
    return std::nullopt;
  }
  const CsvReader csv(rule_.path, *separator);
  if (!csv.error().empty()) {
    v_.diagnostics().add(Code::BadEdgeList, file_span, {csv.error()});
    return std::nullopt;
  }
  EdgeTable table;
  table.path = rule_.path;
  table.span = file_span;
  table.separator = *separator;
  // "columns": { "pre": "source", "post": "target", "w": "count" }: the names here are ours, the values the file's.
  const std::size_t errors_before = v_.diagnostics().error_count();
  std::vector<std::size_t> found;
  for (const char* end : {"pre", "post"}) {
    std::string name = end;
    Span span = file_span;
    for (const KeyedValue& column : rule_.columns) {
      if (column.key.text == end && column.values.size() == 1) {
        name = column.values.front().text;
        span = column.values.front().span;
      }
    }
    if (const auto column = find_column(name, span, csv.header())) {
      found.push_back(*column);
    }
  }
  for (const KeyedValue& column : rule_.columns) {
    if (column.key.text == "pre" || column.key.text == "post" || column.values.size() != 1) {
      continue;
    }
    const ValueDecl& value = column.values.front();
    if (const auto position = find_column(value.text, value.span, csv.header())) {
      found.push_back(*position);
      variables_.push_back(column.key.text);
    }
  }
  for (const KeyedValue& filter : rule_.rows) {
    if (const auto column = find_column(filter.key.text, filter.key.span, csv.header())) {
      RowFilter& made = table.rows.emplace_back();
      made.column = *column;
      for (const ValueDecl& value : filter.values) {
        made.texts.push_back(value.text);
      }
    }
  }
  std::vector<std::size_t> sorted = found;
  std::sort(sorted.begin(), sorted.end());
  const bool is_distinct = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  if (!is_distinct) {
    v_.diagnostics().add(Code::BadEdgeList, file_span, {"one column of the edge list is used twice"});
  }
  if (v_.diagnostics().error_count() > errors_before) {
    return std::nullopt;
  }
  table.columns = std::move(found);
  return table;
}

}  // namespace tectum
