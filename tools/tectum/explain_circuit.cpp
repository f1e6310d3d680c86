#include "tools/tectum/explain_circuit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "compiler/validate/plasticity_keys.h"

namespace tectum {
namespace {

class Explanation {
 public:
  explicit Explanation(const CompileResult& result)
      : result_(result), decl_(*result.decl), circuit_(*result.circuit), network_(*result.network) {}

  std::string population(const PopulationDecl& decl, const Population& population) {
    line("population", decl.name.text, place(decl.name.span));
    about(decl.provenance);
    for (std::uint32_t k = 0; k < population.instance_count; ++k) {
      const NetworkPopulation& side = network_.populations[index_of(population.first_instance) + k];
      line(k == 0 ? "neurons" : "",
           fmt::format("{}: {}..{}", side.name, side.first_neuron,
                       side.first_neuron + side.size - (side.size > 0 ? 1 : 0)),
           k == 0 && decl.size ? "size " + place(decl.size->span) : "");
    }
    if (decl.nucleus) {
      line("nucleus", decl.nucleus->text, place(decl.nucleus->span));
    }
    for (const InputUseDecl& use : decl.inputs) {
      line("input", use.side.text.empty() ? use.input.text : use.side.text + ": " + use.input.text,
           place(use.input.span));
    }
    neuron(decl, population);
    pathways(population);
    return std::move(text_);
  }

  std::string projection(const ProjectionDecl& decl, std::size_t number) {
    line("projection", decl.name.text, place(decl.name.span));
    about(decl.provenance);
    line("from", joined(decl.from), place(decl.from.front().span));
    line("to", joined(decl.to), place(decl.to.front().span));
    line("rule", decl.rule.kind.text, place(decl.rule.kind.span));
    for (const KeyedValue& argument : decl.rule.arguments) {
      line("", fmt::format("{} {}", argument.key.text, argument.values.front().text), place(argument.span));
    }
    for (const SideDecl& side : decl.side) {
      line("side", side.axis.text.empty() ? side.relation.text : side.axis.text + ": " + side.relation.text,
           place(side.relation.span));
    }
    if (decl.where) {
      line("where", decl.where->text, place(decl.where->span));
    }
    line("sign", decl.sign ? decl.sign->text : "excitatory", decl.sign ? place(decl.sign->span) : "default");
    if (decl.receptor) {
      line("receptor", decl.receptor->text, place(decl.receptor->span));
    }
    line("weight", decl.weight->text, place(decl.weight->span));
    line("delay", decl.delay->text, place(decl.delay->span));
    for (const ExceptionDecl& exception : decl.exceptions) {
      for (const KeyedValue& value : exception.values) {
        line("exception", fmt::format("{}: {} {}", exception.side.text, value.key.text, value.values.front().text),
             place(value.span));
      }
    }
    if (decl.plasticity) {
      plasticity(*decl.plasticity, circuit_.projections[number]);
    }
    made(number);
    return std::move(text_);
  }

 private:
  void line(std::string_view what, std::string_view value, std::string_view origin) {
    std::string text = fmt::format("{:<12} {:<52} {}", what, value, origin);
    text.erase(text.find_last_not_of(' ') + 1);
    text_ += text + '\n';
  }

  [[nodiscard]] std::string place(const Span& span) const {
    const SourceFile& file = result_.sources.file(span.file);
    return fmt::format("{}:{}", file.name, position_of(file.bytes, span.begin).line);
  }

  static std::string joined(const std::vector<NameDecl>& names) {
    std::string text;
    for (const NameDecl& name : names) {
      text += (text.empty() ? "" : ", ") + name.text;
    }
    return text;
  }

  void about(const ProvenanceDecl& provenance) {
    if (!provenance.about.empty()) {
      line("about", provenance.about, "");
    }
    for (const NameDecl& cite : provenance.cites) {
      for (const ReferenceDecl& reference : decl_.references) {
        if (reference.name.text == cite.text) {
          line("cites", reference.title.empty() ? cite.text : reference.title,
               reference.doi.empty() ? cite.text : "doi:" + reference.doi);
        }
      }
    }
    if (provenance.cites.empty()) {
      line("cites", "nothing", "");
    }
  }

  [[nodiscard]] const NeuronDecl* find_neuron(const NameDecl& name) const {
    const auto found = std::find_if(decl_.neurons.begin(), decl_.neurons.end(),
                                    [&](const NeuronDecl& n) { return n.name.text == name.text; });
    return found == decl_.neurons.end() ? nullptr : &*found;
  }

  static const KeyedValue* find_value(const std::vector<KeyedValue>& values, std::string_view key) {
    const auto found =
        std::find_if(values.begin(), values.end(), [&](const KeyedValue& v) { return v.key.text == key; });
    return found == values.end() ? nullptr : &*found;
  }

  /// The chain of types, then each parameter with the nearest line that gives it.
  void neuron(const PopulationDecl& decl, const Population& population) {
    std::vector<const NeuronDecl*> chain;
    for (const NeuronDecl* type = decl.neuron ? find_neuron(*decl.neuron) : nullptr;
         type != nullptr && chain.size() < decl_.neurons.size();
         type = type->extends ? find_neuron(*type->extends) : nullptr) {
      line(chain.empty() ? "neuron" : "extends", type->name.text, place(type->name.span));
      chain.push_back(type);
    }
    const ModelInfo& model = model_of(population);
    line("model", model.name, population.user_model ? "declared under `models`" : "built in");
    for (const ParameterInfo& info : model.parameters) {
      parameter(info, decl, population, chain);
    }
    for (const Receptor& receptor : population.receptors) {
      const std::string kind(receptor_kind_name(receptor.kind));
      line("receptor",
           receptor.kind == ReceptorKind::Exponential
               ? fmt::format("{}: {}, tau {:g} ms", receptor.name, kind, receptor.tau_ms)
               : fmt::format("{}: {}", receptor.name, kind),
           "");
    }
  }

  void parameter(const ParameterInfo& info, const PopulationDecl& decl, const Population& population,
                 const std::vector<const NeuronDecl*>& chain) {
    const KeyedValue* given = find_value(decl.overrides, info.name);
    std::string origin = given == nullptr ? "" : place(given->span) + " (population)";
    for (const NeuronDecl* type : chain) {
      const KeyedValue* own = given == nullptr ? find_value(type->parameters, info.name) : nullptr;
      if (own != nullptr) {
        given = own;
        origin = fmt::format("{} ({})", place(own->span), type->name.text);
      }
    }
    for (const ExceptionDecl& exception : decl.exceptions) {
      if (const KeyedValue* other = find_value(exception.values, info.name)) {
        origin += fmt::format(", {}: {}", exception.side.text, place(other->span));
      }
    }
    const std::string written = given == nullptr || given->values.size() != 1 ? "" : given->values.front().text;
    line("", fmt::format("{} = {}", info.name, value_of(info, population, written)),
         origin.empty() ? "default" : origin);
  }

  /// "20 ms", "-70 to -56 mV (-70 mV + 14 mV * index / size)".
  [[nodiscard]] std::string value_of(const ParameterInfo& info, const Population& population,
                                     const std::string& written) const {
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (std::uint32_t k = 0; k < population.instance_count; ++k) {
      const Instance& side = circuit_.instances[index_of(population.first_instance) + k];
      if (const auto values = side.parameters.find(std::string(info.name)); values != side.parameters.end()) {
        lowest = std::min(lowest, *std::min_element(values->second.begin(), values->second.end()));
        highest = std::max(highest, *std::max_element(values->second.begin(), values->second.end()));
      }
    }
    if (lowest > highest) {
      return population.user_model       ? "as the model declares"
             : info.default_text.empty() ? fmt::format("{:g} {}", info.default_value, info.unit)
                                         : std::string(info.default_text);
    }
    const std::string value = lowest == highest ? fmt::format("{:g} {}", lowest, info.unit)
                                                : fmt::format("{:g} to {:g} {}", lowest, highest, info.unit);
    const bool is_plain = written.empty() || written == value;
    return is_plain ? value : fmt::format("{}  ({})", value, written);
  }

  void pathways(const Population& population) {
    std::vector<std::size_t> counts(network_.pathways.size(), 0);
    for (const std::uint32_t p : network_.synapses.pathway) {
      ++counts[p];
    }
    const std::size_t first = index_of(population.first_instance);
    const auto is_own = [&](std::uint32_t p) { return p >= first && p < first + population.instance_count; };
    for (const bool is_incoming : {true, false}) {
      bool is_first = true;
      for (std::size_t p = 0; p < counts.size(); ++p) {
        const Pathway& pathway = network_.pathways[p];
        if (!is_own(is_incoming ? pathway.post_population : pathway.pre_population)) {
          continue;
        }
        line(is_first ? (is_incoming ? "receives" : "sends") : "",
             fmt::format("{} -> {}: {} synapses", network_.populations[pathway.pre_population].name,
                         network_.populations[pathway.post_population].name, counts[p]),
             pathway.name + "  " + place(pathway.name_span));
        is_first = false;
      }
    }
  }

  void plasticity(const PlasticityDecl& decl, const Projection& projection) {
    const Plasticity& made = *projection.plasticity;
    line("learns", kPlasticityFormNames[static_cast<std::size_t>(made.form)],
         decl.form ? place(decl.form->span) : "default");
    for (const RewardUseDecl& use : decl.rewards) {
      line("", fmt::format("reward{}{} {}", use.side.text.empty() ? "" : " ", use.side.text, use.channel.text),
           place(use.channel.span));
    }
    for (const PlasticityNumber& number : kPlasticityNumbers) {
      const KeyedValue* given = find_value(decl.numbers, number.key);
      line("", fmt::format("{} = {}", number.key, format_quantity({made.*number.field, number.dimension})),
           given == nullptr ? "default" : place(given->span));
    }
    line("", fmt::format("bounds {:g} to {:g} times the weight", made.lowest, made.highest),
         decl.bounds.empty() ? "default" : place(decl.bounds_span));
    for (const KeyedValue& learned : decl.learned) {
      line("", fmt::format("{} learned factors of {}", learned.values.size(), learned.key.text),
           place(learned.key.span));
    }
  }

  /// What the projection came to: counts, weights and delays of each pathway.
  void made(std::size_t number) {
    struct Range {
      std::size_t count = 0;
      double lowest = std::numeric_limits<double>::infinity();
      double highest = -std::numeric_limits<double>::infinity();
      std::uint32_t first_ticks = 0xFFFFFFFFU;
      std::uint32_t last_ticks = 0;
    };
    std::vector<Range> ranges(network_.pathways.size());
    const Synapses& synapses = network_.synapses;
    for (std::size_t s = 0; s < synapses.size(); ++s) {
      const Pathway& pathway = network_.pathways[synapses.pathway[s]];
      if (index_of(pathway.projection) != number) {
        continue;
      }
      Range& range = ranges[synapses.pathway[s]];
      const double weight = std::ldexp(static_cast<double>(synapses.quanta[s]),
                                       network_.populations[pathway.post_population].quantum_log2[pathway.receptor]);
      ++range.count;
      range.lowest = std::min(range.lowest, weight);
      range.highest = std::max(range.highest, weight);
      range.first_ticks = std::min(range.first_ticks, synapses.delay_ticks[s]);
      range.last_ticks = std::max(range.last_ticks, synapses.delay_ticks[s]);
    }
    bool is_first = true;
    for (std::size_t p = 0; p < ranges.size(); ++p) {
      const Range& range = ranges[p];
      if (range.count == 0) {
        continue;
      }
      const Pathway& pathway = network_.pathways[p];
      const NetworkPopulation& target = network_.populations[pathway.post_population];
      line(is_first ? "makes" : "",
           fmt::format("{} -> {}.{}: {} synapses", network_.populations[pathway.pre_population].name, target.name,
                       target.receptors[pathway.receptor].name, range.count),
           fmt::format("weight {:.4g} to {:.4g} {}, delay {:g} to {:g} ms", range.lowest, range.highest,
                       model_of(circuit_.population_of(static_cast<InstanceId>(pathway.post_population))).weight_unit,
                       range.first_ticks * network_.tick_ms(), range.last_ticks * network_.tick_ms()));
      is_first = false;
    }
    if (is_first) {
      line("makes", "no synapses", "");
    }
  }

  const CompileResult& result_;
  const CircuitDecl& decl_;
  const Circuit& circuit_;
  const Network& network_;
  std::string text_;
};

}  // namespace

std::optional<std::string> explain_name(const CompileResult& result, const std::string& name) {
  for (std::size_t p = 0; p < result.decl->populations.size(); ++p) {
    if (result.decl->populations[p].name.text == name) {
      return Explanation(result).population(result.decl->populations[p], result.circuit->populations[p]);
    }
  }
  for (std::size_t p = 0; p < result.decl->projections.size(); ++p) {
    if (result.decl->projections[p].name.text == name) {
      return Explanation(result).projection(result.decl->projections[p], p);
    }
  }
  return std::nullopt;
}

std::vector<std::string> explainable_names(const CompileResult& result) {
  std::vector<std::string> names;
  for (const PopulationDecl& population : result.decl->populations) {
    names.push_back(population.name.text);
  }
  for (const ProjectionDecl& projection : result.decl->projections) {
    names.push_back(projection.name.text);
  }
  return names;
}

}  // namespace tectum
