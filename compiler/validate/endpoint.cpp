// "EBN", "EBN.left", "generator.EBN.left": a population, and perhaps one of its sides.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/validate/validation.h"

namespace tectum {

std::optional<Endpoint> Validation::endpoint(const NameDecl& name) {
  if (name.is_poisoned) {
    scope.keep_silent();
    return std::nullopt;
  }
  // Populations of module instances have dots in their names: the longest name that is declared counts.
  std::size_t dot = name.text.find('.');
  for (std::size_t at = dot; at != std::string::npos; at = name.text.find('.', at + 1)) {
    const std::size_t next = name.text.find('.', at + 1);
    if (population_of.find(name.text.substr(0, next)) != population_of.end()) {
      dot = next;
    }
  }
  const std::string base = name.text.substr(0, dot);
  const bool is_as_written = name.text.size() == name.span.end - name.span.begin;
  const auto found = population_of.find(base);
  if (found == population_of.end()) {
    const bool is_of_poisoned_instance =
        decl.poisoned_instances.count(name.text.substr(0, name.text.find('.'))) != 0 || !knows_all("instances");
    if ((dot != std::string::npos && is_of_poisoned_instance) || !can_report(name, "populations")) {
      scope.keep_silent();
      return std::nullopt;
    }
    const Span span{
        name.span.file, name.span.begin,
        dot == std::string::npos || !is_as_written ? name.span.end : name.span.begin + static_cast<std::uint32_t>(dot)};
    diagnostics()
        .add(Code::UnknownPopulation, span, {base})
        .help_if(nearest_name(base, names_of(decl.populations)), "did you mean `{}`?");
    return std::nullopt;
  }
  Endpoint endpoint;
  endpoint.population = static_cast<PopulationId>(found->second);
  const Population& population = circuit.populations[found->second];
  endpoint.fixed_sides.resize(population.axes.size());
  for (std::size_t at = dot; at != std::string::npos;) {
    const std::size_t next = name.text.find('.', at + 1);
    const std::string side = name.text.substr(at + 1, next == std::string::npos ? next : next - at - 1);
    bool is_known = false;
    std::vector<std::string> sides;
    for (std::size_t a = 0; a < population.axes.size() && !is_known; ++a) {
      const Axis& axis = circuit.axes[index_of(population.axes[a])];
      sides.insert(sides.end(), axis.sides.begin(), axis.sides.end());
      const auto position = std::find(axis.sides.begin(), axis.sides.end(), side);
      if (position != axis.sides.end() && !endpoint.fixed_sides[a]) {
        endpoint.fixed_sides[a] = static_cast<std::uint32_t>(position - axis.sides.begin());
        is_known = true;
      }
    }
    if (!is_known && !knows_sides[found->second]) {
      scope.keep_silent();
      return std::nullopt;
    }
    if (!is_known) {
      const auto begin = name.span.begin + static_cast<std::uint32_t>(at) + 1;
      const Span side_span{name.span.file, begin, begin + static_cast<std::uint32_t>(side.size())};
      auto builder = diagnostics().add(Code::UnknownSide, is_as_written ? side_span : name.span, {base, side});
      if (population.axes.empty()) {
        builder.help(fmt::format("`{}` is on no axis", base));
      } else {
        builder.help_if(nearest_name(side, sides), "did you mean `{}`?");
      }
      return std::nullopt;
    }
    at = next;
  }
  return endpoint;
}

}  // namespace tectum
