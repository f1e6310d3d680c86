#include "tools/evaluate/measure_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kNarrowestColumn = 9;

std::string value_text(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : std::string("-");
}

std::size_t width_of(const MeasureTable& table, std::size_t column) {
  std::size_t width =
      std::max({kNarrowestColumn, table.columns[column].name.size(), table.columns[column].unit.size()});
  for (const MeasureRow& row : table.rows) {
    width = std::max(width, value_text(row.values[column], table.columns[column].decimals).size());
  }
  return width + 2;
}

std::string table_text(const MeasureTable& table) {
  std::size_t first = 0;
  for (const MeasureRow& row : table.rows) {
    first = std::max(first, row.what.size());
  }
  std::string names = std::string(first + 2, ' ');
  std::string units = names;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    names += fmt::format("{:>{}}", table.columns[c].name, width_of(table, c));
    units += fmt::format("{:>{}}", table.columns[c].unit, width_of(table, c));
  }
  std::string text = fmt::format("\n{}\n{}\n{}\n", table.title, names, units);
  for (const MeasureRow& row : table.rows) {
    text += fmt::format("  {:<{}}", row.what, first);
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      text += fmt::format("{:>{}}", value_text(row.values[c], table.columns[c].decimals), width_of(table, c));
    }
    text += '\n';
  }
  for (const std::string& note : table.notes) {
    text += fmt::format("{}\n", note);
  }
  return text;
}

}  // namespace

std::string measures_text(const std::vector<MeasureTable>& tables) {
  std::string text;
  for (const MeasureTable& table : tables) {
    text += table_text(table);
  }
  return text;
}

std::string measures_json(const std::string& protocol, const std::string& circuit,
                          const std::vector<MeasureTable>& tables) {
  Json json{{"protocol", protocol}, {"circuit", circuit}};
  json["tables"] = Json::array();
  for (const MeasureTable& table : tables) {
    Json one{{"title", table.title}};
    one["columns"] = Json::array();
    for (const MeasureColumn& column : table.columns) {
      one["columns"].push_back({{"name", column.name}, {"unit", column.unit}});
    }
    one["rows"] = Json::array();
    for (const MeasureRow& row : table.rows) {
      Json values = Json::array();
      for (const std::optional<double>& value : row.values) {
        values.push_back(value ? Json(*value) : Json(nullptr));
      }
      one["rows"].push_back({{"what", row.what}, {"values", std::move(values)}});
    }
    one["notes"] = table.notes;
    json["tables"].push_back(std::move(one));
  }
  return json.dump(2);
}

}  // namespace tectum
