#include <fmt/format.h>

#include "compiler/parse/circuit_decl.h"

namespace tectum {
namespace {

std::string joined(const std::vector<NameDecl>& names) {
  std::string text;
  for (const NameDecl& name : names) {
    text += (text.empty() ? "" : ", ") + name.text;
  }
  return text;
}

std::string keyed(const std::vector<KeyedValue>& values) {
  std::string text;
  for (const KeyedValue& value : values) {
    text += fmt::format(" {}=", value.key.text);
    text += value.is_list ? fmt::format("[{} values]", value.values.size())
                          : fmt::format("'{}'", value.values.empty() ? "" : value.values.front().text);
  }
  return text;
}

std::string optional_text(const char* key, const std::optional<NameDecl>& name) {
  return name ? fmt::format(" {}={}", key, name->text) : "";
}

std::string optional_text(const char* key, const std::optional<ValueDecl>& value) {
  return value ? fmt::format(" {}='{}'", key, value->text) : "";
}

}  // namespace

std::string dump_circuit_decl(const CircuitDecl& decl) {
  std::string text = fmt::format("circuit {}{}{}\n", decl.name.text, optional_text("tick", decl.tick),
                                 optional_text("seed", decl.seed));
  for (const ParameterDecl& p : decl.parameters) {
    text += fmt::format("parameter {} = '{}'\n", p.name.text, p.value.text);
  }
  for (const AxisDecl& a : decl.axes) {
    text += fmt::format("axis {}: {}\n", a.name.text, joined(a.sides));
  }
  for (const NeuronDecl& n : decl.neurons) {
    text += fmt::format("neuron {}{}{}{}\n", n.name.text, optional_text("extends", n.extends),
                        optional_text("model", n.model), keyed(n.parameters));
  }
  for (const PopulationDecl& p : decl.populations) {
    text +=
        fmt::format("population {}{}{}", p.name.text, optional_text("neuron", p.neuron), optional_text("size", p.size));
    for (const InputUseDecl& input : p.inputs) {
      text += fmt::format(" input={}", input.input.text);
    }
    text += fmt::format("{}{}{}\n", p.axes.empty() ? "" : " axis=", joined(p.axes), keyed(p.overrides));
  }
  for (const ProjectionDecl& p : decl.projections) {
    text += fmt::format("projection {}: {} -> {} rule={}{}{}{}{}{}\n", p.name.text, joined(p.from), joined(p.to),
                        p.rule.kind.text, keyed(p.rule.arguments), optional_text("sign", p.sign),
                        optional_text("weight", p.weight), optional_text("delay", p.delay),
                        optional_text("where", p.where));
  }
  for (const RetinaDecl& r : decl.retinas) {
    text += fmt::format("input {}: retina of the {} eye, {} rings\n", r.name.text, r.eye.text, r.rings.size());
  }
  for (const OutputDecl& o : decl.outputs) {
    text += fmt::format("output {} -> {}\n", o.name.text, joined(o.joints));
  }
  for (const JointDecl& j : decl.joints) {
    text += fmt::format("joint {}\n", j.name.text);
  }
  for (const LesionDecl& l : decl.lesions) {
    text += fmt::format("lesion {}: {}\n", l.name.text, joined(l.targets));
  }
  for (const StimulusDecl& s : decl.stimuli) {
    text += fmt::format("stimulus {}: {} at {} for {} into {}\n", s.name.text, s.amplitude.text, s.at.text,
                        s.duration.text, joined(s.into));
  }
  return text;
}

}  // namespace tectum
