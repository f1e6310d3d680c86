#include "compiler/validate/validate.h"

#include <cmath>
#include <set>
#include <utility>

#include "compiler/validate/validation.h"

namespace tectum {
namespace {

constexpr double kDefaultTickMs = 0.1;
constexpr std::uint64_t kMaxTickNs = 1'000'000'000;  // 1 s

void validate_time(Validation& v) {
  v.circuit.tick_ns = static_cast<std::uint64_t>(std::llround(kDefaultTickMs * 1e6));
  if (v.decl.tick) {
    v.scope.knows_tick = false;
    if (const auto tick_ms = v.scope.constant(*v.decl.tick, "tick", kTime)) {
      const double tick_ns = std::round(*tick_ms * 1e6);
      if (!(tick_ns >= 1) || tick_ns > static_cast<double>(kMaxTickNs) || std::abs(*tick_ms * 1e6 - tick_ns) > 1e-3) {
        v.diagnostics().add(Code::OutOfRange, v.decl.tick->span,
                            {"tick", shown(*tick_ms, kTime), "1 ns to 1 s in whole nanoseconds"});
      } else {
        v.circuit.tick_ns = static_cast<std::uint64_t>(tick_ns);
        v.scope.knows_tick = true;
      }
    }
  }
  v.circuit.seed = 0;
  if (v.decl.seed) {
    constexpr std::uint64_t kMaxWholeDouble = std::uint64_t{1} << 53U;
    v.circuit.seed = v.scope.whole(*v.decl.seed, "seed", 0, kMaxWholeDouble).value_or(0);
  }
  v.circuit.seed = v.overrides.seed.value_or(v.circuit.seed);
}

}  // namespace

const ModelInfo& model_of(const Population& population) {
  return population.user_model ? population.user_model->info : *find_model(population.model);
}

bool Validation::knows_all(std::string_view section) const {
  return decl.poisoned_sections.count(std::string(section)) == 0;
}

bool Validation::can_report(const NameDecl& name, std::string_view section) {
  const bool can = !name.is_poisoned && knows_all(section);
  if (!can) {
    scope.keep_silent();
  }
  return can;
}

void Validation::check_cites(const ProvenanceDecl& provenance) {
  for (const NameDecl& cite : provenance.cites) {
    bool is_known = false;
    for (const ReferenceDecl& reference : decl.references) {
      is_known = is_known || reference.name.text == cite.text;
    }
    if (!is_known && can_report(cite, "references")) {
      diagnostics()
          .add(Code::UnknownReference, cite.span, {cite.text})
          .help_if(nearest_name(cite.text, names_of(decl.references)), "did you mean `{}`?");
    }
  }
}

void validate_axes(Validation& v) {
  v.scope.knows_all_names = v.knows_all("axes") && v.knows_all("parameters");
  std::set<std::string> words = {"down", "left", "right", "up"};
  for (const AxisDecl& axis : v.decl.axes) {
    v.axis_of.emplace(axis.name.text, static_cast<std::uint32_t>(v.circuit.axes.size()));
    Axis& made = v.circuit.axes.emplace_back();
    made.name = axis.name.text;
    std::map<std::string, Span> seen;
    bool is_sound = axis.sides.size() > 1;
    for (const NameDecl& side : axis.sides) {
      is_sound = is_sound && !side.is_poisoned;
      if (side.is_poisoned) {
        continue;
      }
      const auto [first, is_new] = seen.emplace(side.text, side.span);
      if (!is_new) {
        v.diagnostics().add(Code::NameClash, side.span, {side.text}).label(first->second, "first here");
      }
      made.sides.push_back(side.text);
      words.insert(side.text);
    }
    v.is_sound_axis.push_back(is_sound);
    v.scope.knows_all_names = v.scope.knows_all_names && is_sound;
  }
  int number = 0;
  for (const std::string& word : words) {
    v.circuit.words[word] = ++number;
    v.scope.environment.add_word(word, number);
  }
}

std::optional<Circuit> validate(const CircuitDecl& decl, const Overrides& overrides, Diagnostics& diagnostics) {
  Validation v{decl, overrides, Scope(diagnostics), {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
  v.circuit.name = decl.name.text;
  v.circuit.has_references = !decl.references.empty();
  validate_axes(v);
  validate_parameters(v);
  validate_time(v);
  validate_models(v);
  validate_retinas(v);
  validate_tables(v);
  validate_populations(v);
  validate_projections(v);
  validate_outputs(v);
  validate_lesions(v);
  validate_scalings(v);
  validate_stimuli(v);
  if (diagnostics.has_errors()) {
    return std::nullopt;
  }
  return std::move(v.circuit);
}

}  // namespace tectum
