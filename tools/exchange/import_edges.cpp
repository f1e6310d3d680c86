#include "tools/exchange/import_edges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "compiler/format/format_circuit.h"
#include "compiler/source/csv_reader.h"
#include "tools/exchange/cell_classes.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

std::string json_quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// What a scan of the edge list finds out.
struct EdgeScan {
  bool has_weights = false, has_negative = false;
  std::set<std::pair<std::string, bool>> kinds;  // the type, and whether it inhibits
};

class Import {
 public:
  Import(const EdgeImport& options, const std::function<void(double)>& watch) : o_(options), watch_(watch) {}

  ImportedEdges run() {
    if (!o_.cells_path.empty()) {
      read_cell_classes(o_, cells_, inhibits_, made_);
    }
    if (is_sound()) {
      scan_edges();
    }
    if (is_sound()) {
      finish_populations();
    }
    if (is_sound()) {
      write();
    }
    return std::move(made_);
  }

 private:
  [[nodiscard]] bool is_sound() const { return made_.error.empty() && made_.bad_rows.count == 0; }

  bool find_columns(const CsvReader& csv, std::vector<std::size_t>& columns) {
    struct Wanted {
      std::string& name;
      std::vector<std::string> guesses;
      const char* option;
      const char* what;
    };
    const Wanted wanted[] = {
        {o_.pre,
         {"presynaptic", "pre", "pre_id", "source", "from", "pre_root_id", "bodyid_pre", "pre_pt_root_id", "from_id"},
         "--pre",
         "the presynaptic cells"},
        {o_.post,
         {"postsynaptic", "post", "post_id", "target", "to", "post_root_id", "bodyid_post", "post_pt_root_id", "to_id"},
         "--post",
         "the postsynaptic cells"},
        {o_.weight,
         {"synapses", "weight", "syn_count", "synapse_count", "count", "n_synapses", "w", "n"},
         "--weight",
         ""},
        {o_.type, {}, "--type", ""}};
    for (const Wanted& column : wanted) {
      const std::size_t found = find_column(csv.header(), column.name, column.guesses);
      const bool is_needed = *column.what != '\0' || !column.name.empty();
      if (found == kNone && is_needed) {
        made_.error = column.name.empty() ? fmt::format("{}: no column looks like {}", o_.edges_path, column.what)
                                          : fmt::format("{} has no column `{}`", o_.edges_path, column.name);
        made_.help = fmt::format("it has {}; say which with {}", fmt::join(csv.header(), ", "), column.option);
        return false;
      }
      if (found == kNone) {
        continue;
      }
      column.name = csv.header()[found];
      if (std::find(columns.begin(), columns.end(), found) != columns.end()) {
        made_.error = fmt::format("{}: column `{}` is meant twice", o_.edges_path, column.name);
        return false;
      }
      columns.push_back(found);
    }
    return true;
  }

  void scan_edges() {
    CsvReader csv(o_.edges_path, o_.separator);
    made_.bad_path = o_.edges_path;
    std::vector<std::size_t> columns;
    if (!csv.error().empty() || !find_columns(csv, columns)) {
      made_.error = made_.error.empty() ? csv.error() : made_.error;
      return;
    }
    scan_.has_weights = !o_.weight.empty();
    if (!scan_.has_weights && o_.scaling == EdgeScaling::ShareOfInput) {
      made_.error =
          fmt::format("{}: no column looks like weights, of which an edge could have its share", o_.edges_path);
      made_.help = fmt::format("it has {}; say which with --weight", fmt::join(csv.header(), ", "));
      return;
    }
    csv.select(columns, true);
    std::vector<std::string_view> fields(columns.size());
    constexpr std::uint64_t kRowsBetweenLooks = 1U << 16U;
    std::uint64_t rows = 0;
    for (CsvRow row = csv.next_fields(fields); row != CsvRow::End; row = csv.next_fields(fields)) {
      if (++rows % kRowsBetweenLooks == 0 && csv.bytes_total() > 0) {
        watch_(static_cast<double>(csv.bytes_read()) / static_cast<double>(csv.bytes_total()));
      }
      if (row == CsvRow::Bad) {
        made_.bad_rows.add(csv.row_error());
      } else {
        scan_row(csv, fields);
      }
    }
    made_.error = csv.error();
    if (is_sound() && made_.edges == 0) {
      made_.error = fmt::format("{}: has no rows", o_.edges_path);
    }
  }

  void scan_row(CsvReader& csv, const std::vector<std::string_view>& fields) {
    double weight = 1;
    std::uint32_t pre = 0;
    for (std::size_t end = 0; end < 2; ++end) {
      if (fields[end].empty()) {
        made_.bad_rows.add(
            fmt::format("{}:{}: column `{}` is empty", csv.path(), csv.line(), end == 0 ? o_.pre : o_.post));
        return;
      }
      const auto cell = o_.cells_path.empty() ? std::optional(cells_.add(fields[end]).first) : cells_.find(fields[end]);
      if (!cell) {
        made_.bad_rows.add(fmt::format("{}:{}: `{}` is no cell of {}", csv.path(), csv.line(),
                                       fields[end].substr(0, 40), o_.cells_path));
        return;
      }
      pre = end == 0 ? *cell : pre;
    }
    if (scan_.has_weights && !csv.read_number(fields[2], 2, weight)) {
      made_.bad_rows.add(csv.row_error());
      return;
    }
    if (!std::isfinite(weight)) {
      made_.bad_rows.add(fmt::format("{}:{}: weight `{}` is not finite", csv.path(), csv.line(), fields[2]));
      return;
    }
    scan_.has_negative = scan_.has_negative || weight < 0;
    note_kind(o_.type.empty() ? std::string_view() : fields.back(), pre, weight);
    ++made_.edges;
  }

  /// A sign in the weight goes before the cell's.
  void note_kind(std::string_view type, std::uint32_t pre, double weight) {
    constexpr std::size_t kMostKinds = 128;
    const bool inhibits = weight < 0 || (pre < inhibits_.size() && inhibits_[pre]);
    if (inhibits == last_kind_.second && type == last_kind_.first && !scan_.kinds.empty()) {
      return;
    }
    last_kind_ = {std::string(type), inhibits};
    scan_.kinds.insert(last_kind_);
    if (scan_.kinds.size() > kMostKinds && made_.error.empty()) {
      made_.error =
          fmt::format("{}: column `{}` holds more than {} types of edge", o_.edges_path, o_.type, kMostKinds / 2);
    }
  }

  void finish_populations() {
    made_.cells = cells_.size();
    if (o_.cells_path.empty()) {
      made_.populations.push_back({"cells", "", "", "", false, cells_.size()});
    }
    for (const std::string& name : o_.inhibitory) {
      need_class(name, "--inhibitory");
    }
    for (const DrivenClass& driven : o_.driven) {
      need_class(driven.name, "--drive");
    }
  }

  void need_class(const std::string& name, const char* option) {
    std::set<std::string> classes;
    for (const ImportedPopulation& population : made_.populations) {
      classes.insert(population.cell_class.empty() ? population.name : population.cell_class);
    }
    if (classes.count(name) == 0 && is_sound()) {
      made_.error = fmt::format("{}: no cell is of class `{}`", option, name);
      made_.help = fmt::format("there are {}", fmt::join(classes, ", "));
    }
  }

  // The circuit file.

  /// As seen from the folder that the circuit file goes to.
  [[nodiscard]] std::string seen_from_circuit(const std::string& path) const {
    std::error_code ignored;
    const fs::path folder = fs::absolute(o_.output_path, ignored).parent_path();
    const fs::path relative =
        fs::proximate(fs::weakly_canonical(path, ignored), fs::weakly_canonical(folder, ignored), ignored);
    return relative.empty() ? path : relative.generic_string();
  }

  [[nodiscard]] std::string separator_text() const {
    return o_.separator == '\0' ? "" : fmt::format(R"(, "separator": {})", json_quoted(std::string(1, o_.separator)));
  }

  [[nodiscard]] std::vector<std::string> names(bool is_inhibitory) const {
    std::vector<std::string> result;
    for (const ImportedPopulation& population : made_.populations) {
      if (population.is_inhibitory == is_inhibitory) {
        result.push_back(json_quoted(population.name));
      }
    }
    return result;
  }

  void write() {
    std::string text = fmt::format(
        "// {} cells and {} connections out of {}, which this file reads each time it is compiled.\n"
        "// The neuron type is a stand-in: the leaky integrate-and-fire cell and the strength of a synapse that Shiu "
        "and\n"
        "// others (2024) took for every neuron of the adult fly. Put what is known about these cells in its place.\n",
        made_.cells, made_.edges, fs::path(o_.edges_path).filename().string());
    text +=
        fmt::format("{{\n\"tectum\": 1, \"name\": {}, \"tick\": \"0.1 ms\", \"seed\": 1,\n\n", json_quoted(o_.name));
    text += R"("references": {
  "shiu2024": { "doi": "10.1038/s41586-024-07763-9", "title": "A Drosophila computational brain model reveals sensorimotor processing" }
},
)";
    text += fmt::format("\n\"parameters\": {{\n{}{}}},\n\n", weight_parameter(),
                        o_.driven.empty() ? ""
                                          : ",\n\"drive\": { \"value\": \"6 nA\", \"about\": \"of one spike of a "
                                            "source: enough to make its cell fire\" }\n");
    text += R"("neurons": {
  "cell": { "model": "lif_exp", "tau_m": "20 ms", "E_L": "-52 mV", "V_th": "-45 mV", "V_reset": "-52 mV", "t_ref": "2.2 ms", "R_m": "10 MOhm", "tau_syn_ex": "5 ms", "tau_syn_in": "5 ms", "cite": "shiu2024" })";
    for (const DrivenClass& driven : o_.driven) {
      text += fmt::format(",\n  {}: {{ \"model\": \"poisson\", \"rate\": \"{:g} Hz\" }}",
                          json_quoted("source_" + population_name(driven.name, "")), driven.rate_hz);
    }
    text += "\n},\n\n" + table() + populations() + projections();
    if (o_.leading_eigenvalue_na) {
      text += fmt::format(
          ",\n\n\"scalings\": {{ \"edges\": {{ \"projections\": [{}], \"leading_eigenvalue\": \"{:g} nA\" }} }}",
          fmt::join(edge_projections_, ", "), *o_.leading_eigenvalue_na);
    }
    text += "\n}\n";
    FormattedCircuit formatted = format_circuit(text);
    made_.text = formatted.text ? *formatted.text : text;
    made_.columns =
        fmt::format("`{}` to `{}`{}{}", o_.pre, o_.post, o_.weight.empty() ? "" : ", weight `" + o_.weight + "`",
                    o_.type.empty() ? "" : ", type `" + o_.type + "`");
    if (!o_.cells_path.empty()) {
      made_.columns += fmt::format(
          "; cells `{}`{}{}{}", o_.id, o_.cell_class.empty() ? "" : ", class `" + o_.cell_class + "`",
          o_.side.empty() ? "" : ", side `" + o_.side + "`", o_.sign.empty() ? "" : ", sign `" + o_.sign + "`");
    }
  }

  [[nodiscard]] std::string weight_parameter() const {
    return o_.scaling == EdgeScaling::ShareOfInput
               ? R"("all_input": { "value": "2 nA", "about": "what a cell gets when each of its inputs fires once" })"
               : R"("synapse": { "value": "0.275 mV / 10 MOhm", "about": "strength of one synapse", "cite": "shiu2024" })";
  }

  [[nodiscard]] std::string table() const {
    const bool has_cells = !o_.cells_path.empty();
    return fmt::format(
        "\"tables\": {{ \"cells\": {{ \"file\": {}, \"id\": {}{} }} }},\n\n",
        json_quoted(seen_from_circuit(has_cells ? o_.cells_path : o_.edges_path)),
        has_cells ? json_quoted(o_.id) : fmt::format("[{}, {}]", json_quoted(o_.pre), json_quoted(o_.post)),
        separator_text());
  }

  std::string populations() {
    std::string text = "\"populations\": {\n";
    for (const ImportedPopulation& population : made_.populations) {
      std::vector<std::string> where;
      if (!o_.cell_class.empty()) {
        where.push_back(fmt::format("{}: {}", json_quoted(o_.cell_class), json_quoted(population.cell_class)));
      }
      if (!o_.side.empty()) {
        where.push_back(fmt::format("{}: {}", json_quoted(o_.side), json_quoted(population.side)));
      }
      if (!o_.sign.empty()) {
        where.push_back(fmt::format("{}: {}", json_quoted(o_.sign), json_quoted(population.sign)));
      }
      text += fmt::format("{}{}: {{ \"neuron\": \"cell\", \"cells\": {{ \"table\": \"cells\"{} }}{} }}",
                          &population == &made_.populations.front() ? "" : ",\n", json_quoted(population.name),
                          where.empty() ? "" : fmt::format(", \"where\": {{ {} }}", fmt::join(where, ", ")),
                          scan_.has_negative ? ", \"mixed_signs\": \"the edge list gives the sign of each edge\"" : "");
    }
    for (const DrivenClass& driven : o_.driven) {
      for (const ImportedPopulation& population : made_.populations) {
        if ((population.cell_class.empty() ? population.name : population.cell_class) == driven.name) {
          text += fmt::format(",\n{}: {{ \"neuron\": {}, \"size\": {} }}", json_quoted("drive_" + population.name),
                              json_quoted("source_" + population_name(driven.name, "")), population.size);
        }
      }
    }
    return text + "\n},\n\n";
  }

  /// One for each type of edge and each sign that there is.
  std::string projections() {
    std::string text;
    std::vector<std::string> every = names(false);
    const std::vector<std::string> others = names(true);
    every.insert(every.end(), others.begin(), others.end());
    for (const auto& [type, inhibits] : scan_.kinds) {
      projection(type, inhibits, scan_.has_negative ? every : names(inhibits), text);
    }
    for (const DrivenClass& driven : o_.driven) {
      for (const ImportedPopulation& population : made_.populations) {
        if ((population.cell_class.empty() ? population.name : population.cell_class) == driven.name) {
          text += fmt::format(
              ",\n{}: {{ \"from\": {}, \"to\": {}, \"rule\": \"one_to_one\", \"weight\": \"drive\", \"delay\": \"0.1 "
              "ms\", "
              "\"cite\": \"shiu2024\" }}",
              json_quoted("drive_" + population.name), json_quoted("drive_" + population.name),
              json_quoted(population.name));
        }
      }
    }
    return fmt::format("\"projections\": {{\n{}\n}}", text);
  }

  void projection(const std::string& type, bool is_inhibitory, const std::vector<std::string>& from,
                  std::string& text) {
    const std::string name =
        fmt::format("{}_{}", type.empty() ? "edges" : population_name(type, ""), is_inhibitory ? "inhibit" : "excite");
    edge_projections_.push_back(json_quoted(name));
    std::vector<std::string> to = names(false);
    const std::vector<std::string> others = names(true);
    to.insert(to.end(), others.begin(), others.end());
    std::string columns = fmt::format("\"pre\": {}, \"post\": {}", json_quoted(o_.pre), json_quoted(o_.post));
    std::string count = "1";
    if (scan_.has_weights) {
      columns += fmt::format(", \"n\": {}", json_quoted(o_.weight));
      count = scan_.has_negative ? (is_inhibitory ? "-edge.n" : "edge.n") : "edge.n";
    }
    const std::string weight = o_.scaling == EdgeScaling::ShareOfInput
                                   ? fmt::format("all_input * {} / post.sum.n", count)
                                   : fmt::format("synapse * {}", count);
    text += fmt::format(
        "{}{}: {{\n\"from\": [{}],\n\"to\": [{}],{}\n\"rule\": {{ \"kind\": \"edges\", \"file\": {}, \"columns\": {{ "
        "{} }}{}{} "
        "}},{}\n\"weight\": {}, \"delay\": \"1.8 ms\", \"cite\": \"shiu2024\"\n}}",
        text.empty() ? "" : ",\n", json_quoted(name), fmt::join(from, ", "), fmt::join(to, ", "),
        is_inhibitory ? " \"sign\": \"inhibitory\"," : "", json_quoted(seen_from_circuit(o_.edges_path)), columns,
        type.empty() ? "" : fmt::format(", \"rows\": {{ {}: {} }}", json_quoted(o_.type), json_quoted(type)),
        separator_text(),
        scan_.has_negative ? fmt::format("\n\"where\": \"edge.n {} 0\",", is_inhibitory ? "<" : ">=") : "",
        json_quoted(weight));
  }

  EdgeImport o_;
  const std::function<void(double)>& watch_;
  ImportedEdges made_;
  CellNumbers cells_;
  EdgeScan scan_;
  std::vector<bool> inhibits_;  // cell by cell
  std::pair<std::string, bool> last_kind_;
  std::vector<std::string> edge_projections_;  // quoted
};

}  // namespace

ImportedEdges import_edges(const EdgeImport& options, const std::function<void(double)>& watch) {
  return Import(options, watch).run();
}

}  // namespace tectum
