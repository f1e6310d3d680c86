// The rule: its spelling, its arguments, and whether it fits the populations.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

#include "compiler/validate/projection_validator.h"
#include "compiler/validate/read_edge_table.h"
#include "compiler/validate/rules.h"

namespace tectum {

void ProjectionValidator::rule() {
  if (decl_.rule.kind.is_poisoned) {
    return;  // its absence has been reported
  }
  const auto spelling =
      std::find_if(kRules.begin(), kRules.end(), [&](const RuleSpelling& r) { return decl_.rule.kind.text == r.text; });
  if (spelling == kRules.end()) {
    std::vector<std::string> names;
    for (const RuleSpelling& known : kRules) {
      names.emplace_back(known.text);
    }
    auto builder = v_.diagnostics().add(Code::UnknownWord, decl_.rule.kind.span, {"rule", decl_.rule.kind.text});
    const auto nearest = nearest_name(decl_.rule.kind.text, names);
    if (nearest) {
      builder.help_if(nearest, "did you mean `{}`?");
    } else {
      builder.help(fmt::format("the rules are {}", fmt::join(names, ", ")));
    }
    return;
  }
  made_.rule = spelling->kind;
  if (made_.rule == RuleKind::EdgeList) {
    edge_table();
  }
  bool has_first = spelling->arguments[0] == nullptr || std::string_view(spelling->arguments[0]) == "autapses";
  for (const KeyedValue& argument : decl_.rule.arguments) {
    const bool is_known = std::any_of(spelling->arguments.begin(), spelling->arguments.end(),
                                      [&](const char* key) { return key != nullptr && argument.key.text == key; });
    if (!is_known || argument.values.size() != 1) {
      v_.diagnostics().add(Code::UnknownKey, argument.key.span,
                           {argument.key.text, fmt::format("rule `{}`", spelling->text)});
      continue;
    }
    has_first = has_first || argument.key.text == spelling->arguments[0];
    rule_argument(argument);
  }
  if (!has_first) {
    v_.diagnostics()
        .add(Code::MissingKey, decl_.rule.kind.span, {fmt::format("rule `{}`", spelling->text), spelling->arguments[0]})
        .help(fmt::format("\"rule\": {{ \"kind\": \"{}\", \"{}\": {} }}", spelling->text, spelling->arguments[0],
                          made_.rule == RuleKind::FixedProbability ? "0.1" : "10"));
  }
}

void ProjectionValidator::edge_table() {
  if (!decl_.rule.file) {
    return;  // its absence has been reported
  }
  EdgeTableReader reader(v_, decl_.rule);
  made_.edges = reader.read();
  if (!made_.edges) {
    is_sound_ = false;
    return;
  }
  if (!find_cell_tables()) {
    is_sound_ = false;
    return;
  }
  const std::uint32_t first = kFirstAxisVariable + 3 * static_cast<std::uint32_t>(v_.circuit.axes.size());
  const auto count = static_cast<std::uint32_t>(reader.variables().size());
  for (std::uint32_t c = 0; c < count; ++c) {
    names_.add_variable("edge." + reader.variables()[c], kNumber, first + c);
    if (made_.edges->names_cells) {
      names_.add_variable("pre.sum." + reader.variables()[c], kNumber, first + count + c);
      names_.add_variable("post.sum." + reader.variables()[c], kNumber, first + 2 * count + c);
    }
  }
}

bool ProjectionValidator::find_cell_tables() {
  if (made_.from.empty() || made_.to.empty()) {
    return true;
  }
  const auto pre = population(made_.from.front()).cell_table;
  const auto post = population(made_.to.front()).cell_table;
  const auto differs = [&](const std::vector<Endpoint>& ends, std::optional<std::uint32_t> table) {
    return std::any_of(ends.begin(), ends.end(),
                       [&](const Endpoint& end) { return population(end).cell_table != table; });
  };
  if (pre.has_value() != post.has_value() || differs(made_.from, pre) || differs(made_.to, post)) {
    v_.diagnostics()
        .add(Code::BadEdgeList, made_.edges->span,
             {"the populations of this edge list are not all cells, of one table at each end"})
        .help("write one projection for those that the file names and one for those that it numbers");
    return false;
  }
  made_.edges->names_cells = pre.has_value();
  made_.edges->pre_table = pre.value_or(0);
  made_.edges->post_table = post.value_or(0);
  return true;
}

void ProjectionValidator::rule_argument(const KeyedValue& argument) {
  const ValueDecl& value = argument.values.front();
  if (argument.key.text == "autapses") {
    made_.allows_autapses = v_.scope.constant(value, "autapses", kBoolean).value_or(0) != 0;
  } else if (argument.key.text == "first_index") {
    if (made_.edges) {
      made_.edges->first_index = v_.scope.whole(value, "first_index", 0, 0xFFFFFFFFU).value_or(0);
    }
  } else if (argument.key.text == "n") {
    made_.degree = static_cast<std::uint32_t>(v_.scope.whole(value, "n", 1, 0xFFFFFFFFU).value_or(1));
    degree_span_ = value.span;
  } else if (is_sound_) {
    made_.probability = v_.scope.expression(value, names_, "p", kNumber);
    if (made_.probability && made_.probability->constant) {
      const double p = *made_.probability->constant;
      if (!(p >= 0 && p <= 1)) {
        v_.diagnostics().add(Code::OutOfRange, value.span, {"p", shown(p, kNumber), "0 to 1"});
      }
    }
  }
}

void ProjectionValidator::check_degree() {
  const bool is_in_degree = made_.rule == RuleKind::FixedInDegree;
  for (const Endpoint& from : made_.from) {
    for (const Endpoint& to : made_.to) {
      const Population& partner = population(is_in_degree ? from : to);
      const bool is_recurrent = from.population == to.population && !made_.allows_autapses;
      const std::uint32_t offered = partner.size - (is_recurrent ? 1 : 0);
      if (made_.degree > offered) {
        v_.diagnostics().add(Code::DegreeTooLarge, *degree_span_,
                             {fmt::format("{}", made_.degree), fmt::format("{}", offered), partner.name});
        return;
      }
    }
  }
}

void ProjectionValidator::check_sizes() {
  for (const Endpoint& from : made_.from) {
    for (std::size_t i = 0; i < made_.to.size(); ++i) {
      const Population& pre = population(from);
      const Population& post = population(made_.to[i]);
      if (pre.size != post.size) {
        v_.diagnostics()
            .add(Code::SizesDiffer, decl_.to[i].span,
                 {pre.name, fmt::format("{}", pre.size), post.name, fmt::format("{}", post.size)})
            .help("all_to_all joins populations of any size");
        return;
      }
    }
  }
}

}  // namespace tectum
