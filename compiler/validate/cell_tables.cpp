#include "compiler/validate/cell_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "compiler/source/bad_rows.h"
#include "compiler/source/csv_reader.h"
#include "compiler/validate/validation.h"

namespace tectum {
namespace {

bool is_one_of(const std::string& text, const std::vector<ValueDecl>& values) {
  return std::any_of(values.begin(), values.end(), [&](const ValueDecl& value) { return value.text == text; });
}

class TableReader {
 public:
  TableReader(Validation& v, const TableDecl& decl, CellTable& table, TableContents& contents)
      : v_(v), decl_(decl), table_(table), contents_(contents) {}

  void run() {
    if (decl_.file.is_poisoned || decl_.ids.empty() || decl_.ids.front().is_poisoned) {
      return;
    }
    const auto separator = separator_char(v_, decl_.separator);
    if (!separator) {
      return;
    }
    CsvReader csv(decl_.path, *separator);
    if (!csv.error().empty()) {
      v_.diagnostics().add(Code::BadTable, decl_.file.span, {csv.error()});
      return;
    }
    if (find_columns(csv.header())) {
      rows(csv);
    }
  }

 private:
  bool find_columns(const std::vector<std::string>& header) {
    for (const NameDecl& id : decl_.ids) {
      if (!find_column(id.text, id.span, header)) {
        return false;
      }
    }
    for (const PopulationDecl& population : v_.decl.populations) {
      if (!population.cells || population.cells->table.text != decl_.name.text) {
        continue;
      }
      for (const KeyedValue& filter : population.cells->where) {
        if (contents_.columns.count(filter.key.text) > 0) {
          continue;
        }
        if (decl_.ids.size() > 1) {
          v_.diagnostics().add(Code::BadTable, filter.key.span,
                               {fmt::format("table `{}` has several cells a row, so that a row's `{}` is no cell's",
                                            decl_.name.text, filter.key.text)});
          return false;
        }
        if (!find_column(filter.key.text, filter.key.span, header)) {
          return false;
        }
        contents_.columns[filter.key.text];
        names_.push_back(filter.key.text);
      }
    }
    return true;
  }

  bool find_column(const std::string& name, Span span, const std::vector<std::string>& header) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) {
      v_.diagnostics()
          .add(Code::BadTable, span, {fmt::format("{} has no column `{}`", decl_.path, name)})
          .help(fmt::format("it has {}", fmt::join(header, ", ")));
      return false;
    }
    const auto column = static_cast<std::size_t>(found - header.begin());
    const auto selected = std::find(columns_.begin(), columns_.end(), column);
    places_.push_back(static_cast<std::size_t>(selected - columns_.begin()));
    if (selected == columns_.end()) {
      columns_.push_back(column);
    }
    return true;
  }

  void rows(CsvReader& csv) {
    csv.select(columns_, true);
    std::vector<std::string_view> fields(columns_.size());
    BadRows bad;
    for (CsvRow row = csv.next_fields(fields); row != CsvRow::End; row = csv.next_fields(fields)) {
      if (row == CsvRow::Bad) {
        bad.add(csv.row_error());
        continue;
      }
      for (std::size_t i = 0; i < decl_.ids.size(); ++i) {
        add_cell(csv, fields, fields[places_[i]], bad);
      }
    }
    if (!csv.error().empty()) {
      v_.diagnostics().add(Code::BadTable, decl_.file.span, {csv.error()});
    } else if (bad.count > 0) {
      report_bad_rows(v_.diagnostics(), Code::BadTable, decl_.file.span, decl_.path, bad);
    } else {
      contents_.row_count = table_.numbers.size();
      table_.places.resize(contents_.row_count);
      contents_.is_sound = true;
    }
  }

  void add_cell(const CsvReader& csv, const std::vector<std::string_view>& fields, std::string_view id, BadRows& bad) {
    if (id.empty()) {
      bad.add(fmt::format("{}:{}: the cell has no name", csv.path(), csv.line()));
      return;
    }
    const bool is_new = table_.numbers.add(id).second;
    if (decl_.ids.size() > 1) {
      return;
    }
    if (!is_new) {
      bad.add(fmt::format("{}:{}: cell `{}` stands in an earlier row, too", csv.path(), csv.line(), id));
      return;
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      contents_.columns[names_[i]].emplace_back(fields[places_[decl_.ids.size() + i]]);
    }
  }

  Validation& v_;
  const TableDecl& decl_;
  CellTable& table_;
  TableContents& contents_;
  std::vector<std::size_t> columns_;  // of the file
  std::vector<std::size_t> places_;   // of each id and each name, in what is selected
  std::vector<std::string> names_;
};

}  // namespace

std::optional<char> separator_char(Validation& v, const std::optional<NameDecl>& separator) {
  if (!separator) {
    return '\0';
  }
  if (separator->is_poisoned) {
    return std::nullopt;
  }
  if (separator->text.size() != 1 || separator->text == "\"" || separator->text == "\n") {
    v.diagnostics()
        .add(Code::UnknownWord, separator->span, {"separator", separator->text})
        .help("a separator is one character, such as `;`");
    return std::nullopt;
  }
  return separator->text.front();
}

void report_bad_rows(Diagnostics& diagnostics, Code code, Span span, const std::string& path, const BadRows& bad) {
  auto builder =
      diagnostics.add(code, span, {fmt::format("{} has {} bad row{}", path, bad.count, bad.count == 1 ? "" : "s")});
  for (const std::string& row : bad.named) {
    builder.help(row);
  }
  if (bad.count > bad.named.size()) {
    builder.help(fmt::format("and {} more", bad.count - bad.named.size()));
  }
}

void validate_tables(Validation& v) {
  for (const TableDecl& decl : v.decl.tables) {
    v.table_of.emplace(decl.name.text, static_cast<std::uint32_t>(v.tables.size()));
    auto table = std::make_shared<CellTable>();
    table->name = decl.name.text;
    TableReader(v, decl, *table, v.tables.emplace_back()).run();
    v.circuit.cell_tables.push_back(std::move(table));
  }
}

std::optional<std::uint32_t> assign_cells(Validation& v, const CellsDecl& decl, std::uint32_t instance,
                                          Population& population) {
  const auto found = v.table_of.find(decl.table.text);
  if (found == v.table_of.end()) {
    if (v.can_report(decl.table, "tables")) {
      v.diagnostics()
          .add(Code::UnknownTable, decl.table.span, {decl.table.text})
          .help_if(nearest_name(decl.table.text, names_of(v.decl.tables)), "did you mean `{}`?");
    }
    return std::nullopt;
  }
  const TableContents& contents = v.tables[found->second];
  if (!contents.is_sound) {
    v.scope.keep_silent();
    return std::nullopt;
  }
  CellTable& table = *v.circuit.cell_tables[found->second];
  std::uint32_t size = 0;
  for (std::uint32_t cell = 0; cell < contents.row_count; ++cell) {
    const bool is_meant = std::all_of(decl.where.begin(), decl.where.end(), [&](const KeyedValue& filter) {
      return is_one_of(contents.columns.at(filter.key.text)[cell], filter.values);
    });
    if (!is_meant) {
      continue;
    }
    CellPlace& place = table.places[cell];
    if (place.instance != CellPlace::kNowhere) {
      v.diagnostics()
          .add(Code::BadTable, decl.span,
               {fmt::format("a cell of `{}` belongs to `{}` already", population.name,
                            v.circuit.instances[place.instance].name)})
          .help("a cell is one neuron: let the two `where` exclude each other");
      return std::nullopt;
    }
    place = {instance, size++};
  }
  if (size == 0) {
    v.diagnostics().add(Code::BadTable, decl.span,
                        {fmt::format("no cell of table `{}` is one of `{}`", decl.table.text, population.name)});
    return std::nullopt;
  }
  population.cell_table = found->second;
  return size;
}

}  // namespace tectum
