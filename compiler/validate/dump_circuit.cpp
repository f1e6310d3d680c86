#include <fmt/format.h>

#include "compiler/validate/circuit.h"
#include "compiler/validate/plasticity_keys.h"
#include "runtime/image/models.h"

namespace tectum {
namespace {

std::string dump_instance(const Instance& instance) {
  std::string text = fmt::format("  {}:", instance.name);
  for (const auto& [name, values] : instance.parameters) {
    text += values.size() == 1 ? fmt::format(" {}={:.9g}", name, values.front())
                               : fmt::format(" {}={:.9g}..{:.9g}", name, values.front(), values.back());
  }
  if (!instance.spike_ticks.empty()) {
    text += fmt::format(" {} spikes", instance.spike_ticks.size());
  }
  return text + "\n";
}

std::string value_text(const TypedExpression& expression) {
  return expression.constant ? format_quantity({*expression.constant, expression.dimension}) : "by pair";
}

std::string plasticity_text(const Plasticity& plasticity) {
  std::string text = fmt::format(", learns {} by", kPlasticityFormNames[static_cast<std::size_t>(plasticity.form)]);
  for (const RewardUse& reward : plasticity.rewards) {
    text += fmt::format(" {}{}{}", reward.side, reward.side.empty() ? "" : ": ",
                        kRewardChannelNames[static_cast<std::size_t>(reward.channel)]);
  }
  for (const PlasticityNumber& number : kPlasticityNumbers) {
    text += fmt::format(", {} {}", number.key, format_quantity({plasticity.*number.field, number.dimension}));
  }
  return text + fmt::format(", {:g} to {:g} times the weight", plasticity.lowest, plasticity.highest);
}

constexpr const char* kRuleNames[] = {"one_to_one",      "all_to_all",       "fixed_probability",
                                      "fixed_in_degree", "fixed_out_degree", "edges"};

}  // namespace

std::string dump_circuit(const Circuit& circuit) {
  std::string text = fmt::format("circuit {}, tick {} ns, seed {}\n", circuit.name, circuit.tick_ns, circuit.seed);
  for (const Population& population : circuit.populations) {
    text += fmt::format("population {}: {} x {} {}, receptors", population.name, population.instance_count,
                        population.size, model_of(population).name);
    for (const Receptor& receptor : population.receptors) {
      text += fmt::format(" {} ({}", receptor.name, receptor_kind_name(receptor.kind));
      text += receptor.kind == ReceptorKind::Exponential ? fmt::format(" {:g} ms)", receptor.tau_ms)
              : receptor.kind == ReceptorKind::Boxcar    ? fmt::format(" {} ticks)", receptor.window_ticks)
                                                         : std::string(")");
    }
    text += population.receptors.empty() ? " none\n" : "\n";
    for (std::uint32_t i = 0; i < population.instance_count; ++i) {
      text += dump_instance(circuit.instances[index_of(population.first_instance) + i]);
    }
  }
  for (const Projection& projection : circuit.projections) {
    text += fmt::format("projection {}: {} {}, weight {}, delay {}{}{}\n", projection.name,
                        projection.is_inhibitory ? "inhibitory" : "excitatory",
                        kRuleNames[static_cast<std::size_t>(projection.rule)], value_text(projection.weight),
                        value_text(projection.delay), projection.where ? ", where" : "",
                        projection.plasticity ? plasticity_text(*projection.plasticity) : "");
  }
  for (const RetinaSheet& retina : circuit.retinas) {
    text += fmt::format("retina {}: {} fields, {:g} deg over {} px\n", retina.name, retina.fields.size(),
                        retina.field_of_view_deg, retina.frame_width);
  }
  for (const Output& output : circuit.outputs) {
    text += fmt::format("output {}: {}, {} terms, window {} ticks, joints 0x{:x}\n", output.name,
                        output.kind == OutputKind::Position ? "position" : "velocity", output.terms.size(),
                        output.window_ticks, output.joint_mask);
  }
  for (const JointSetting& joint : circuit.joints) {
    text += fmt::format("joint {}: {:g} to {:g} deg\n", kJointNames[static_cast<std::size_t>(joint.joint)],
                        joint.min_deg, joint.max_deg);
  }
  return text;
}

}  // namespace tectum
