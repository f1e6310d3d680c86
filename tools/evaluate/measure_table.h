// Results as tables and pictures that know nothing of what was measured, so that text, JSON and HTML are written once.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/report/chart.h"

namespace tectum {

struct MeasureColumn {
  std::string name;
  std::string unit;  // may be empty
  int decimals = 1;
};

struct MeasureRow {
  std::string what;
  std::vector<std::optional<double>> values;  // one a column; nothing: not measurable here
};

struct MeasureTable {
  std::string title;
  std::vector<MeasureColumn> columns;
  std::vector<MeasureRow> rows;
  std::vector<std::string> notes;  // one a line, under the table
};

struct MeasurePicture {
  std::string title;
  std::string caption;
  Chart chart;
};

struct MeasuredProtocol {
  std::vector<MeasureTable> tables;
  std::vector<MeasurePicture> pictures;
};

/// Each ends in a newline, except the JSON.
[[nodiscard]] std::string measures_text(const std::vector<MeasureTable>& tables);
[[nodiscard]] std::string measures_json(const std::string& protocol, const std::string& circuit,
                                        const std::vector<MeasureTable>& tables);

}  // namespace tectum
