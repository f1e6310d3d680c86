#include "compiler/lower/lower.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <string>
#include <utility>

#include "compiler/elaborate/same_tick_order.h"
#include "compiler/lower/lower_model.h"
#include "compiler/lower/lower_plasticity.h"
#include "compiler/lower/lower_program.h"
#include "compiler/lower/lower_rows.h"

namespace tectum {
namespace {

/// Offsets of names; each text is stored once.
class Strings {
 public:
  explicit Strings(ImageContents& image) : image_(image) {}

  std::uint32_t add(const std::string& text) {
    if (text.empty()) {
      return kNoString;
    }
    const auto [entry, is_new] = offsets_.emplace(text, 0U);
    if (is_new) {
      entry->second = image_.add_string(text);
    }
    return entry->second;
  }

 private:
  ImageContents& image_;
  std::map<std::string, std::uint32_t> offsets_;
};

ModelPhysics physics_of(const NetworkPopulation& population, std::uint32_t begin, std::uint32_t end) {
  ModelPhysics physics;
  physics.model = population.model;
  physics.size = end - begin;
  for (const auto& [name, values] : population.parameters) {
    if (values.size() == 1) {
      physics.parameters[name] = values;
    } else {
      physics.parameters[name].assign(values.begin() + begin, values.begin() + end);
    }
  }
  for (const Receptor& receptor : population.receptors) {
    physics.receptors.push_back({receptor.name, receptor.kind, receptor.tau_ms, receptor.window_ticks});
  }
  physics.may_sleep = population.may_sleep && rests_below_threshold(physics);
  return physics;
}

bool is_all_silent(const NetworkPopulation& population) {
  return population.silenced_neurons.size() == population.size;
}

class GroupLowering {
 public:
  GroupLowering(const Network& network, ImageContents& image, Strings& strings)
      : network_(network), image_(image), strings_(strings) {
    for (const NetworkPopulation& population : network.populations) {
      layout_.slot_of.emplace_back(population.receptors.size() * population.size, kNoSlot);
    }
  }

  SlotLayout run(const std::vector<std::uint32_t>& order) {
    for (const std::uint32_t p : order) {
      const NetworkPopulation& population = network_.populations[p];
      std::vector<bool> is_silent(population.size, false);
      // A retina drives one whole group: of a part of its cells only the synapses are taken.
      if (population.model != ModelKind::FieldSource || is_all_silent(population)) {
        for (const std::uint32_t i : population.silenced_neurons) {
          is_silent[i] = true;
        }
      }
      // Runs of silenced and of living neurons are groups of their own: a silenced one is an empty spike list.
      for (std::uint32_t begin = 0; begin < population.size;) {
        std::uint32_t end = begin;
        while (end < population.size && is_silent[end] == is_silent[begin]) {
          ++end;
        }
        add_group(p, begin, end, is_silent[begin]);
        begin = end;
      }
    }
    image_.slot_count = next_slot_;
    return std::move(layout_);
  }

 private:
  void add_group(std::uint32_t p, std::uint32_t begin, std::uint32_t end, bool is_silenced) {
    const NetworkPopulation& population = network_.populations[p];
    GroupRecord group{};
    group.population = p;
    group.first_neuron = population.first_neuron + begin;
    group.size = end - begin;
    group.first_receptor = static_cast<std::uint32_t>(image_.receptors.size());
    group.first_slot = next_slot_;
    if (is_silenced) {
      ModelPhysics silent;
      silent.model = ModelKind::SpikeList;
      silent.size = group.size;
      lower_model(silent, network_.tick_ms(), image_, group);
    } else if (population.user_model) {
      lower_equations(population, begin, end, group);
      add_receptors(p, begin, group);
    } else {
      lower_model(physics_of(population, begin, end), network_.tick_ms(), image_, group);
      add_receptors(p, begin, group);
    }
    if (group.model == ModelKind::SpikeList) {
      group.data_begin = static_cast<std::uint32_t>(image_.source_spikes.size());
      for (const std::uint32_t tick : is_silenced ? std::vector<std::uint32_t>{} : population.spike_ticks) {
        for (std::uint32_t i = 0; i < group.size; ++i) {
          image_.source_spikes.push_back(tick);
          image_.source_spikes.push_back(i);
        }
      }
      group.data_count = static_cast<std::uint32_t>(image_.source_spikes.size()) - group.data_begin;
    }
    image_.groups.push_back(group);
  }

  void lower_equations(const NetworkPopulation& population, std::uint32_t begin, std::uint32_t end,
                       GroupRecord& group) {
    const ModelPhysics physics = physics_of(population, begin, end);
    const EquationParameterValues values(physics.parameters.begin(), physics.parameters.end());
    std::vector<EquationError> errors;
    const auto program =
        compile_equations(population.user_model->equations, values, physics.size, network_.tick_ms(), errors);
    assert(program.has_value());  // validate has compiled it with the same values
    lower_program(*program, physics.receptors, network_.tick_ms(), image_, group);
  }

  void add_receptors(std::uint32_t p, std::uint32_t begin, GroupRecord& group) {
    const NetworkPopulation& population = network_.populations[p];
    group.receptor_count = static_cast<std::uint32_t>(population.receptors.size());
    for (std::uint32_t r = 0; r < group.receptor_count; ++r) {
      const Receptor& receptor = population.receptors[r];
      image_.receptors.push_back(
          {strings_.add(receptor.name), receptor.kind, population.quantum_log2[r], receptor.window_ticks});
      for (std::uint32_t i = 0; i < group.size; ++i) {
        layout_.slot_of[p][std::size_t{r} * population.size + begin + i] = next_slot_ + r * group.size + i;
      }
    }
    next_slot_ += group.receptor_count * group.size;
  }

  const Network& network_;
  ImageContents& image_;
  Strings& strings_;
  SlotLayout layout_;
  std::uint32_t next_slot_ = 0;
};

/// Returns the record of each pathway.
std::vector<std::uint32_t> add_projections(const Network& network, ImageContents& image, Strings& strings) {
  std::vector<std::uint32_t> projection_of(network.pathways.size(), 0);
  std::vector<std::uint32_t> counts(network.pathways.size(), 0);
  for (const std::uint32_t pathway : network.synapses.pathway) {
    ++counts[pathway];
  }
  for (std::size_t p = 0; p < network.pathways.size(); ++p) {
    const Pathway& pathway = network.pathways[p];
    if (counts[p] > 0) {
      projection_of[p] = static_cast<std::uint32_t>(image.projections.size());
      image.projections.push_back({strings.add(pathway.name), pathway.pre_population, pathway.post_population,
                                   pathway.receptor, counts[p], strings.add(pathway.cite)});
    }
  }
  return projection_of;
}

void add_retinas(const Network& network, ImageContents& image, Strings& strings) {
  for (const NetworkRetina& input : network.retinas) {
    const NetworkPopulation& population = network.populations[input.population];
    if (is_all_silent(population)) {
      continue;
    }
    const RetinaSheet& retina = input.retina;
    RetinaRecord record{};
    record.name = strings.add(retina.name);
    record.eye = retina.eye;
    record.frame_width = retina.frame_width;
    record.frame_height = retina.frame_height;
    record.field_of_view_deg = retina.field_of_view_deg;
    record.lit_channel = retina.lit_channel;
    record.lit_above = retina.lit_above;
    record.lit_share = retina.lit_share;
    record.first_field = static_cast<std::uint32_t>(image.fields.size());
    record.field_count = static_cast<std::uint32_t>(retina.fields.size());
    record.first_neuron = population.first_neuron;
    image.retinas.push_back(record);
    image.fields.insert(image.fields.end(), retina.fields.begin(), retina.fields.end());
  }
}

void add_outputs(const Network& network, ImageContents& image, Strings& strings) {
  for (const Output& output : network.outputs) {
    OutputRecord record{};
    record.name = strings.add(output.name);
    record.kind = output.kind;
    record.first_term = static_cast<std::uint32_t>(image.output_terms.size());
    record.term_count = static_cast<std::uint32_t>(output.terms.size());
    record.joint_mask = output.joint_mask;
    record.window_ticks = output.window_ticks;
    record.offset_deg = output.offset_deg;
    image.outputs.push_back(record);
    for (const OutputTerm& term : output.terms) {
      const NetworkPopulation& population = network.populations[index_of(term.instance)];
      image.output_terms.push_back({population.first_neuron, population.size, term.gain});
    }
  }
  for (const JointSetting& joint : network.joints) {
    image.joints.push_back({joint.joint, 0, joint.min_deg, joint.max_deg, joint.max_speed_deg_s});
  }
}

}  // namespace

ImageContents lower(const Network& network) {
  const SameTickOrder order = same_tick_order(network);
  assert(order.cycle.empty());
  ImageContents image;
  Strings strings(image);
  image.tick_ns = network.tick_ns;
  image.seed = network.seed;
  image.circuit_name = strings.add(network.name);
  image.neuron_count = network.neuron_count();
  for (const NetworkPopulation& population : network.populations) {
    image.populations.push_back(
        {strings.add(population.name), strings.add(population.nucleus), population.first_neuron, population.size});
  }
  const SlotLayout layout = GroupLowering(network, image, strings).run(order.populations);
  const std::vector<std::uint32_t> target_of = lower_rows(network, layout, image);
  const std::vector<std::uint32_t> projection_of = add_projections(network, image, strings);
  lower_plasticity(network, target_of, projection_of, image);
  add_retinas(network, image, strings);
  add_outputs(network, image, strings);
  return image;
}

}  // namespace tectum
