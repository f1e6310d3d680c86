// The clinic's part of a protocol file.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/diagnostics/render.h"
#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_json.h"
#include "compiler/validate/scope.h"
#include "tools/evaluate/clinic.h"

namespace tectum {
namespace {

/// All that clinic_measures() makes.
std::vector<std::string> known_measures() {
  std::vector<std::string> names;
  for (const char* eye : {"left_eye", "right_eye"}) {
    for (const char* what : {"reach", "saccades", "first_saccade", "overshoot", "peak_velocity"}) {
      for (const char* direction : {"left", "right", "up", "down"}) {
        names.push_back(fmt::format("{}.{}.{}", eye, what, direction));
      }
    }
    for (const char* what : {"ripple", "lost", "drift_time", "convergence"}) {
      names.push_back(fmt::format("{}.{}", eye, what));
    }
  }
  return names;
}

class ClinicReader {
 public:
  ClinicReader(const JsonTree& tree, Diagnostics& diagnostics)
      : tree_(tree), scope_(diagnostics), measures_(known_measures()) {}

  ClinicPlan read() {
    ObjectReader protocol(tree_, tree_.root(), "the protocol", diagnostics());
    const JsonId id = protocol.child("clinic");
    if (id == JsonId::None) {
      protocol.report_missing("clinic");
      return plan_;
    }
    ObjectReader in(tree_, id, "`clinic`", diagnostics());
    plan_.jump_deg = number(in, "jump", kAngle, 1, plan_.jump_deg);
    plan_.vertical_jump_deg = number(in, "vertical_jump", kAngle, 1, plan_.vertical_jump_deg);
    plan_.dwell_s = number(in, "dwell", kTime, 1e-3, plan_.dwell_s);
    plan_.dark_s = number(in, "dark", kTime, 1e-3, plan_.dark_s);
    plan_.near_wall_m = number(in, "near_wall", kLength, 1, plan_.near_wall_m);
    plan_.near_s = number(in, "near", kTime, 1e-3, plan_.near_s);
    plan_.restrain = texts(in.names("restrain"));
    for (const JsonId each : members(in.child("lesions"))) {
      read_lesion(each);
    }
    in.finish();
    return plan_;
  }

 private:
  [[nodiscard]] Diagnostics& diagnostics() { return scope_.diagnostics(); }

  /// A positive quantity, times `scale`.
  double number(ObjectReader& in, std::string_view key, const Dimension& dimension, double scale, double otherwise) {
    const std::optional<ValueDecl> value = in.value(key);
    const std::optional<double> found = value ? scope_.constant(*value, key, dimension) : std::nullopt;
    if (found && *found <= 0) {
      diagnostics().add(Code::OutOfRange, value->span, {std::string(key), shown(*found, dimension), "above 0"});
      return otherwise;
    }
    return found ? scale * *found : otherwise;
  }

  static std::vector<std::string> texts(const std::vector<NameDecl>& names) {
    std::vector<std::string> found;
    for (const NameDecl& name : names) {
      found.push_back(name.text);
    }
    return found;
  }

  std::vector<JsonId> members(JsonId id) {
    std::vector<JsonId> found;
    if (id == JsonId::None) {
      return found;
    }
    if (tree_[id].kind != JsonKind::Array) {
      diagnostics().add(Code::WrongType, tree_[id].span, {"this", std::string(kind_phrase(tree_[id].kind)), "a list"});
      return found;
    }
    for (JsonId each = tree_[id].first_child; each != JsonId::None; each = tree_[each].next_sibling) {
      found.push_back(each);
    }
    return found;
  }

  void read_lesion(JsonId id) {
    ObjectReader in(tree_, id, "a lesion of the clinic", diagnostics());
    ClinicLesion& lesion = plan_.lesions.emplace_back();
    lesion.name = in.required_name("name").text;
    lesion.about = in.text("about");
    lesion.sign = in.text("sign");
    lesion.source = in.text("source");
    lesion.doi = in.text("doi");
    lesion.remove = texts(in.required_names("remove"));
    read_other_names(in.child("in"), lesion);
    lesion.needs = texts(in.names("needs"));
    lesion.fraction = number(in, "fraction", kNumber, 1, 1);
    for (const JsonId each : members(in.child("findings"))) {
      read_finding(each, lesion);
    }
    if (lesion.findings.empty()) {
      in.report_missing("findings");
    }
    in.finish();
  }

  /// "in": what to remove in the circuits of these names.
  void read_other_names(JsonId id, ClinicLesion& lesion) {
    if (id == JsonId::None) {
      return;
    }
    ObjectReader in(tree_, id, "`in`", diagnostics());
    for (JsonId each = tree_[id].first_child; in.is_object() && each != JsonId::None; each = tree_[each].next_sibling) {
      lesion.in_circuit[std::string(tree_[each].key)] = texts(in.names(tree_[each].key));
    }
    in.finish();
  }

  void read_finding(JsonId id, ClinicLesion& lesion) {
    ObjectReader in(tree_, id, "a finding", diagnostics());
    ClinicFinding& finding = lesion.findings.emplace_back();
    finding.says = in.text("says");
    const std::vector<JsonId> any = members(in.child("any"));
    for (const JsonId each : any) {
      ObjectReader condition(tree_, each, "a condition", diagnostics());
      finding.any.push_back(read_condition(condition));
      condition.finish();
    }
    if (any.empty()) {
      finding.any.push_back(read_condition(in));
    }
    in.finish();
  }

  ClinicCondition read_condition(ObjectReader& in) {
    ClinicCondition condition;
    const NameDecl measure = in.required_name("measure");
    condition.measure = measure.text;
    if (!measure.is_poisoned && std::find(measures_.begin(), measures_.end(), measure.text) == measures_.end()) {
      diagnostics()
          .add(Code::UnknownWord, measure.span, {"measure", measure.text})
          .help_if(nearest_name(measure.text, measures_), "did you mean `{}`?");
    }
    int given = 0;
    const auto bound = [&](const char* key, bool is_above, bool is_ratio) {
      if (const std::optional<ValueDecl> value = in.value(key)) {
        condition.bound = scope_.constant(*value, key, kNumber).value_or(0);
        condition.is_above = is_above;
        condition.is_ratio = is_ratio;
        ++given;
      }
    };
    bound("above", true, false);
    bound("below", false, false);
    bound("above_whole_times", true, true);
    bound("below_whole_times", false, true);
    if (given == 0) {
      in.report_missing("below");
    }
    return condition;
  }

  const JsonTree& tree_;
  Scope scope_;
  std::vector<std::string> measures_;
  ClinicPlan plan_;
};

}  // namespace

ReadClinic read_clinic_text(const std::string& name, const std::string& bytes) {
  ReadClinic read;
  Sources sources;
  Diagnostics diagnostics;
  const FileId file = sources.add({name, bytes});
  if (const std::optional<JsonTree> tree = parse_json(sources, file, diagnostics)) {
    read.plan = ClinicReader(*tree, diagnostics).read();
  }
  if (!diagnostics.all().empty()) {
    diagnostics.sort();
    read.problems = render_text(diagnostics, sources);
  }
  if (diagnostics.has_errors()) {
    read.plan.reset();
  }
  return read;
}

}  // namespace tectum
