#include "tools/exchange/cell_classes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <tuple>

namespace tectum {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// What tables write for a cell that inhibits: a sign, a word, or the transmitter.
bool is_inhibitory_sign(const std::string& sign) {
  static const std::set<std::string> kInhibitory = {"-",          "-1",   "i",   "in",     "inh",
                                                    "inhibitory", "gaba", "gly", "glycine"};
  return kInhibitory.count(lower(sign)) > 0;
}

bool does_inhibit(const EdgeImport& options, const std::string& cell_class, const std::string& sign) {
  const auto& listed = options.inhibitory;
  return std::find(listed.begin(), listed.end(), cell_class) != listed.end() || is_inhibitory_sign(sign);
}

}  // namespace

std::size_t find_column(const std::vector<std::string>& header, const std::string& wanted,
                        const std::vector<std::string>& guesses) {
  if (!wanted.empty()) {
    const auto found = std::find(header.begin(), header.end(), wanted);
    return found == header.end() ? kNone : static_cast<std::size_t>(found - header.begin());
  }
  for (const std::string& guess : guesses) {
    for (std::size_t c = 0; c < header.size(); ++c) {
      if (lower(header[c]) == guess) {
        return c;
      }
    }
  }
  return kNone;
}

std::string population_name(const std::string& cell_class, const std::string& side) {
  std::string name;
  for (const char letter : cell_class + (cell_class.empty() || side.empty() ? "" : "_") + side) {
    name += std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
  }
  if (name.empty()) {
    return "cells";
  }
  return std::isdigit(static_cast<unsigned char>(name.front())) != 0 ? "c_" + name : name;
}

void read_cell_classes(EdgeImport& options, CellNumbers& cells, std::vector<bool>& inhibits, ImportedEdges& imported) {
  CsvReader csv(options.cells_path, options.separator);
  imported.bad_path = options.cells_path;
  if (!csv.error().empty()) {
    imported.error = csv.error();
    return;
  }
  struct Wanted {
    std::string& name;
    std::vector<std::string> guesses;
    const char* option;
  };
  const Wanted wanted[] = {
      {options.id, {"cell", "id", "cell_id", "root_id", "bodyid", "neuron", "neuron_id", "name", "node_id"}, "--id"},
      {options.cell_class, {"class", "type", "cell_type", "celltype", "super_class", "population"}, "--class"},
      {options.side, {"side", "hemisphere", "soma_side"}, "--side"},
      {options.sign, {"sign", "transmitter", "neurotransmitter", "nt_type", "nt", "top_nt"}, "--sign"}};
  std::vector<std::size_t> columns;           // of the file
  std::vector<std::size_t> places(4, kNone);  // of id, class, side and sign in what is read
  for (std::size_t w = 0; w < 4; ++w) {
    const std::size_t column = find_column(csv.header(), wanted[w].name, wanted[w].guesses);
    const bool is_new = std::find(columns.begin(), columns.end(), column) == columns.end();
    if (column == kNone && (w == 0 || !wanted[w].name.empty())) {
      imported.error = wanted[w].name.empty()
                           ? fmt::format("{}: no column looks like the cells' names", options.cells_path)
                           : fmt::format("{} has no column `{}`", options.cells_path, wanted[w].name);
      imported.help = fmt::format("it has {}; say which with {}", fmt::join(csv.header(), ", "), wanted[w].option);
      return;
    }
    if (column != kNone && is_new) {
      places[w] = columns.size();
      columns.push_back(column);
      wanted[w].name = csv.header()[column];
    }
  }
  csv.select(columns, true);
  std::vector<std::string_view> fields(columns.size());
  const auto field = [&](std::size_t w) { return places[w] == kNone ? std::string() : std::string(fields[places[w]]); };
  std::map<std::tuple<std::string, std::string, std::string>, std::uint32_t> sizes;
  for (CsvRow row = csv.next_fields(fields); row != CsvRow::End; row = csv.next_fields(fields)) {
    if (row == CsvRow::Bad) {
      imported.bad_rows.add(csv.row_error());
    } else if (fields[places[0]].empty()) {
      imported.bad_rows.add(fmt::format("{}:{}: the cell has no name", csv.path(), csv.line()));
    } else if (!cells.add(fields[places[0]]).second) {
      imported.bad_rows.add(
          fmt::format("{}:{}: cell `{}` stands in an earlier row, too", csv.path(), csv.line(), fields[places[0]]));
    } else {
      ++sizes[{field(1), field(2), field(3)}];
      inhibits.push_back(does_inhibit(options, field(1), field(3)));
    }
  }
  imported.error = csv.error();
  std::set<std::string> taken;
  for (const auto& [key, size] : sizes) {
    const auto& [cell_class, side, sign] = key;
    const std::string base = population_name(cell_class, side);
    std::string name = base;
    for (int again = 2; !taken.insert(name).second; ++again) {
      name = fmt::format("{}_{}", base, again);
    }
    imported.populations.push_back({name, cell_class, side, sign, does_inhibit(options, cell_class, sign), size});
  }
}

}  // namespace tectum
