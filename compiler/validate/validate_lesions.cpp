// Lesions: patterns of names, from the file and from the command line, to the sides and pathways they take out.
#include <algorithm>
#include <utility>

#include "compiler/validate/validation.h"

namespace tectum {
namespace {

/// '*' stands for any run of characters, '?' for one.
bool matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0;
  std::size_t t = 0;
  std::size_t star = std::string_view::npos;
  std::size_t star_text = 0;
  while (t < text.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p;
      ++t;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_text = t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++star_text;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') {
    ++p;
  }
  return p == pattern.size();
}

std::string trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  const std::size_t end = text.find_last_not_of(' ');
  return begin == std::string_view::npos ? std::string() : std::string(text.substr(begin, end - begin + 1));
}

/// The sides of every population whose own name, or whose name with its side, fits.
std::vector<InstanceId> find_instances(const Circuit& circuit, std::string_view pattern) {
  std::vector<InstanceId> found;
  for (std::size_t i = 0; i < circuit.instances.size(); ++i) {
    const Instance& instance = circuit.instances[i];
    if (matches(pattern, instance.name) || matches(pattern, circuit.populations[index_of(instance.population)].name)) {
      found.push_back(static_cast<InstanceId>(i));
    }
  }
  return found;
}

void add_target(Validation& v, const NameDecl& target, Lesion& lesion) {
  const Circuit& circuit = v.circuit;
  const std::size_t arrow = target.text.find("->");
  if (arrow != std::string::npos) {
    const auto from = find_instances(circuit, trimmed(std::string_view(target.text).substr(0, arrow)));
    const auto to = find_instances(circuit, trimmed(std::string_view(target.text).substr(arrow + 2)));
    for (const InstanceId pre : from) {
      for (const InstanceId post : to) {
        lesion.pathways.emplace_back(pre, post);
      }
    }
    if (!from.empty() && !to.empty()) {
      return;
    }
  } else {
    const std::string pattern = trimmed(target.text);
    const auto instances = find_instances(circuit, pattern);
    lesion.instances.insert(lesion.instances.end(), instances.begin(), instances.end());
    bool is_found = !instances.empty();
    for (std::size_t p = 0; p < circuit.projections.size(); ++p) {
      if (matches(pattern, circuit.projections[p].name)) {
        lesion.projections.push_back(static_cast<ProjectionId>(p));
        is_found = true;
      }
    }
    if (is_found) {
      return;
    }
  }
  const bool knows_all = std::find(v.knows_sides.begin(), v.knows_sides.end(), false) == v.knows_sides.end() &&
                         v.decl.poisoned_instances.empty() && v.knows_all("instances") && v.knows_all("projections");
  if (!knows_all || !v.can_report(target, "populations")) {
    return;  // it may name what could not be read
  }
  std::vector<std::string> names = names_of(v.decl.populations);
  const std::vector<std::string> projections = names_of(v.decl.projections);
  names.insert(names.end(), projections.begin(), projections.end());
  v.diagnostics()
      .add(Code::UnknownLesionTarget, target.span, {target.text})
      .help_if(nearest_name(target.text, names), "did you mean `{}`?");
}

void add_lesion(Validation& v, const LesionDecl& decl) {
  Lesion& lesion = v.circuit.lesions.emplace_back();
  if (decl.fraction) {
    if (const auto fraction = v.scope.constant(*decl.fraction, "fraction", kNumber)) {
      if (!(*fraction >= 0 && *fraction <= 1)) {
        v.diagnostics().add(Code::OutOfRange, decl.fraction->span, {"fraction", shown(*fraction, kNumber), "0 to 1"});
      }
      lesion.fraction = *fraction;
    }
  }
  if (decl.weaken_to) {
    const auto share = v.scope.constant(*decl.weaken_to, "to", kNumber);
    if (share && !(*share >= 0 && *share <= 1)) {
      v.diagnostics().add(Code::OutOfRange, decl.weaken_to->span, {"to", shown(*share, kNumber), "0 to 1"});
    }
    lesion.weaken_to = share.value_or(1);
  }
  for (const NameDecl& target : decl.targets) {
    if (target.is_poisoned) {
      continue;
    }
    lesion.key += (lesion.key.empty() ? "" : ",") + target.text;
    add_target(v, target, lesion);
  }
}

}  // namespace

void validate_lesions(Validation& v) {
  for (const LesionDecl& decl : v.decl.lesions) {
    add_lesion(v, decl);
  }
  for (const LesionDecl& decl : v.overrides.lesions) {
    add_lesion(v, decl);
  }
}

}  // namespace tectum
