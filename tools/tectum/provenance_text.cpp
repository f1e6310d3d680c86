#include "tools/tectum/provenance_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "compiler/diagnostics/render.h"

namespace tectum {
namespace {

std::string place(const Sources& sources, const Span& span) {
  const SourceFile& file = sources.file(span.file);
  return fmt::format("{}:{}", file.name, position_of(file.bytes, span.begin).line);
}

template <typename Decls>
std::string uncited(const char* kind, const Decls& decls, const Sources& sources) {
  std::string lines;
  std::size_t count = 0;
  for (const auto& decl : decls) {
    if (decl.provenance.cites.empty()) {
      lines += fmt::format("  {:<24} {}\n", decl.name.text, place(sources, decl.name.span));
      ++count;
    }
  }
  return fmt::format("{} of {} {} cite no source{}\n{}", count, decls.size(), kind, count == 0 ? "" : ":", lines);
}

/// A parameter of the circuit, or of a module of it.
struct SourcedParameter {
  std::string name;
  const ParameterDecl* decl;

  [[nodiscard]] bool has_source() const { return decl->basis || !decl->provenance.cites.empty(); }
};

/// Where the circuit's parameters come from. What is fitted or derived from a source counts as that, not as cited.
struct ParameterSources {
  std::vector<SourcedParameter> parameters;
  std::vector<SourcedParameter> without;
  std::size_t cited = 0, fitted = 0, derived = 0, chosen = 0;
};

ParameterSources parameter_sources(const CircuitDecl& circuit) {
  ParameterSources found;
  for (const ParameterDecl& decl : circuit.parameters) {
    found.parameters.push_back({decl.name.text, &decl});
  }
  for (const ModuleDecl& module : circuit.modules) {
    for (const ParameterDecl& decl : module.parameters) {
      found.parameters.push_back({module.name.text + "." + decl.name.text, &decl});
    }
  }
  for (const SourcedParameter& parameter : found.parameters) {
    const std::string basis = parameter.decl->basis ? parameter.decl->basis->text : "";
    found.fitted += basis == "fitted" ? 1 : 0;
    found.derived += basis == "derived" ? 1 : 0;
    found.chosen += basis == "chosen" ? 1 : 0;
    found.cited += basis.empty() && parameter.has_source() ? 1 : 0;
    if (!parameter.has_source()) {
      found.without.push_back(parameter);
    }
  }
  return found;
}

std::string parameters_text(const CircuitDecl& circuit, const Sources& sources) {
  const ParameterSources found = parameter_sources(circuit);
  std::string lines;
  for (const SourcedParameter& parameter : found.without) {
    lines += fmt::format("  {:<24} {}\n", parameter.name, place(sources, parameter.decl->name.span));
  }
  return fmt::format("{} of {} parameters have no source; {} cited, {} fitted, {} derived, {} chosen{}\n{}",
                     found.without.size(), found.parameters.size(), found.cited, found.fitted, found.derived,
                     found.chosen, lines.empty() ? "" : ":", lines);
}

/// Projections without a source, and what they make of the network.
struct UncitedProjections {
  std::vector<std::size_t> projections;
  std::vector<std::size_t> synapses;  // one entry a projection of the circuit, cited or not
  std::size_t uncited_synapses = 0;
  double share_percent = 0;
};

UncitedProjections uncited_projections(const CompileResult& result) {
  const Network& network = *result.network;
  UncitedProjections found;
  found.synapses.assign(result.circuit->projections.size(), 0);
  for (const std::uint32_t pathway : network.synapses.pathway) {
    ++found.synapses[index_of(network.pathways[pathway].projection)];
  }
  for (std::size_t p = 0; p < found.synapses.size(); ++p) {
    if (result.circuit->projections[p].cite.empty()) {
      found.projections.push_back(p);
      found.uncited_synapses += found.synapses[p];
    }
  }
  const auto total = static_cast<double>(network.synapses.size());
  found.share_percent = total > 0 ? 100.0 * static_cast<double>(found.uncited_synapses) / total : 0;
  return found;
}

std::string place_json(const std::string& name, const Span& span, const Sources& sources) {
  const SourceFile& file = sources.file(span.file);
  return fmt::format("\"name\": {}, \"file\": {}, \"line\": {}", json_quoted(name), json_quoted(file.name),
                     position_of(file.bytes, span.begin).line);
}

template <typename Decls>
std::string uncited_json(const char* kind, const Decls& decls, const Sources& sources) {
  std::vector<std::string> items;
  for (const auto& decl : decls) {
    if (decl.provenance.cites.empty()) {
      items.push_back("{" + place_json(decl.name.text, decl.name.span, sources) + "}");
    }
  }
  return fmt::format("\"{}\": {{\"total\": {}, \"uncited\": [{}]}}", kind, decls.size(), fmt::join(items, ", "));
}

std::string parameters_json(const CircuitDecl& circuit, const Sources& sources) {
  const ParameterSources found = parameter_sources(circuit);
  std::vector<std::string> items;
  for (const SourcedParameter& parameter : found.without) {
    items.push_back("{" + place_json(parameter.name, parameter.decl->name.span, sources) + "}");
  }
  return fmt::format(
      "\"parameters\": {{\"total\": {}, \"cited\": {}, \"fitted\": {}, \"derived\": {}, \"chosen\": {}, "
      "\"without_source\": "
      "[{}]}}",
      found.parameters.size(), found.cited, found.fitted, found.derived, found.chosen, fmt::join(items, ", "));
}

}  // namespace

std::string provenance_text(const CompileResult& result) {
  const CircuitDecl& decl = *result.decl;
  const UncitedProjections found = uncited_projections(result);
  std::string lines;
  for (const std::size_t p : found.projections) {
    const Projection& projection = result.circuit->projections[p];
    lines += fmt::format("  {:<24} {:>9} synapses  {}\n", projection.name, found.synapses[p],
                         place(result.sources, projection.name_span));
  }
  return parameters_text(decl, result.sources) + uncited("neuron types", decl.neurons, result.sources) +
         uncited("populations", decl.populations, result.sources) +
         fmt::format("{} of {} projections cite no source, {:.3g} % of {} synapses{}\n{}", found.projections.size(),
                     found.synapses.size(), found.share_percent, result.network->synapses.size(),
                     found.projections.empty() ? "" : ":", lines);
}

std::string provenance_json(const CompileResult& result) {
  const CircuitDecl& decl = *result.decl;
  const UncitedProjections found = uncited_projections(result);
  std::vector<std::string> projections;
  for (const std::size_t p : found.projections) {
    const Projection& projection = result.circuit->projections[p];
    projections.push_back(fmt::format("{{{}, \"synapses\": {}}}",
                                      place_json(projection.name, projection.name_span, result.sources),
                                      found.synapses[p]));
  }
  return fmt::format(
      "{{{}, {}, {}, \"projections\": {{\"total\": {}, \"uncited\": [{}]}}, \"uncited_synapses\": {}, "
      "\"uncited_share_percent\": {:.6g}}}",
      parameters_json(decl, result.sources), uncited_json("neuron_types", decl.neurons, result.sources),
      uncited_json("populations", decl.populations, result.sources), found.synapses.size(),
      fmt::join(projections, ", "), found.uncited_synapses, found.share_percent);
}

}  // namespace tectum
