// Projections: endpoints, sign, receptors, and the order in which the rest is looked at.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "compiler/validate/projection_validator.h"

namespace tectum {

void ProjectionValidator::run() {
  made_.name = decl_.name.text;
  made_.name_span = decl_.name.span;
  cites();
  made_.from = endpoints(decl_.from);
  made_.to = endpoints(decl_.to);
  is_sound_ = is_sound_ && !made_.from.empty() && !made_.to.empty();
  sign();
  const bool knows_ends = is_sound_;
  if (knows_ends) {
    sides();
  }
  if (knows_ends) {
    make_environment();
  }
  rule();
  if (!is_sound_) {
    values_alone();  // whatever else it says depends on its ends or on its edge list
    return;
  }
  if ((decl_.sign && decl_.sign->is_poisoned) || (decl_.receptor && decl_.receptor->is_poisoned)) {
    v_.scope.keep_silent();
  } else {
    receptors();
  }
  weight();
  delay();
  where();
  v_.scope.absent.clear();
  if (decl_.plasticity) {
    made_.plasticity = validate_plasticity(v_, *decl_.plasticity, decl_.to.front().text, known_sides());
  }
  if (made_.rule == RuleKind::OneToOne) {
    check_sizes();
  }
  if (degree_span_) {
    check_degree();
  }
}

void ProjectionValidator::cites() {
  v_.check_cites(decl_.provenance);
  for (const NameDecl& cite : decl_.provenance.cites) {
    made_.cite += (made_.cite.empty() ? "" : ",") + cite.text;
  }
}

std::vector<Endpoint> ProjectionValidator::endpoints(const std::vector<NameDecl>& names) {
  std::vector<Endpoint> result;
  for (const NameDecl& name : names) {
    if (auto endpoint = v_.endpoint(name)) {
      is_sound_ = is_sound_ && v_.is_sound[index_of(endpoint->population)];
      result.push_back(std::move(*endpoint));
    } else {
      is_sound_ = false;
    }
  }
  return result;
}

const Population& ProjectionValidator::population(const Endpoint& endpoint) const {
  return v_.circuit.populations[index_of(endpoint.population)];
}

void ProjectionValidator::sign() {
  if (!decl_.sign) {
    return;
  }
  if (decl_.sign->text == "inhibitory") {
    made_.is_inhibitory = true;
  } else if (decl_.sign->text != "excitatory" && !decl_.sign->is_poisoned) {
    v_.diagnostics()
        .add(Code::UnknownWord, decl_.sign->span, {"sign", decl_.sign->text})
        .help("a sign is `excitatory` or `inhibitory`");
  }
}

void ProjectionValidator::receptors() {
  for (std::size_t i = 0; i < made_.to.size(); ++i) {
    Endpoint& to = made_.to[i];
    const Population& target = population(to);
    const NameDecl& name = decl_.to[i];
    if (target.receptors.empty()) {
      v_.diagnostics().add(Code::NoReceptor, name.span, {target.name, std::string(model_of(target).name)});
      is_sound_ = false;
      continue;
    }
    const std::string wanted = decl_.receptor ? decl_.receptor->text : made_.is_inhibitory ? "in" : "ex";
    const auto found = std::find_if(target.receptors.begin(), target.receptors.end(),
                                    [&](const Receptor& r) { return r.name == wanted; });
    if (found != target.receptors.end()) {
      to.receptor = static_cast<std::uint32_t>(found - target.receptors.begin());
    } else if (!decl_.receptor && target.receptors.size() == 1) {
      to.receptor = 0;
    } else {
      report_receptor(target, name, wanted);
    }
  }
}

void ProjectionValidator::report_receptor(const Population& target, const NameDecl& name, const std::string& wanted) {
  std::vector<std::string> names;
  for (const Receptor& receptor : target.receptors) {
    names.push_back(receptor.name);
  }
  if (decl_.receptor) {
    v_.diagnostics()
        .add(Code::UnknownReceptor, decl_.receptor->span, {target.name, wanted})
        .help(fmt::format("it has {}", fmt::join(names, ", ")));
  } else {
    v_.diagnostics()
        .add(
            Code::AmbiguousReceptor, name.span,
            {target.name, fmt::format("{}", fmt::join(names, ", ")), made_.is_inhibitory ? "inhibitory" : "excitatory"})
        .help("say which with `receptor`");
  }
}

void validate_projections(Validation& v) {
  for (const ProjectionDecl& decl : v.decl.projections) {
    ProjectionValidator(v, decl, v.circuit.projections.emplace_back()).run();
  }
}

}  // namespace tectum
