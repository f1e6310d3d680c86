#include "tools/diff/circuit_view.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "runtime/image/models.h"

namespace tectum {
namespace {

struct Site {
  std::uint32_t population = 0, receptor = 0, neuron = 0;
};

void sort_synapses(PathwayView& pathway) {
  const auto before = [](const SynapseView& a, const SynapseView& b) {
    return std::tie(a.pre, a.post, a.delay_ticks, a.weight) < std::tie(b.pre, b.post, b.delay_ticks, b.weight);
  };
  if (!std::is_sorted(pathway.synapses.begin(), pathway.synapses.end(), before)) {
    std::sort(pathway.synapses.begin(), pathway.synapses.end(), before);
  }
}

bool is_silent_group(const SpikeImage& image, const GroupRecord& group) {
  return group.model == ModelKind::SpikeList && group.data_count == 0 && group.size > 0 && !image.groups.empty();
}

void read_parameters(const SpikeImage& image, const GroupRecord& group, PopulationView& population) {
  const ModelInfo* info = find_model(group.model);
  const std::uint32_t receptors = group.receptor_count;
  const std::uint32_t count = group.parameter_count - 2 * receptors;
  std::uint32_t column = 0;
  for (std::uint32_t p = 0; p < count; ++p) {
    ParameterView parameter;
    parameter.name = info != nullptr && p < info->parameters.size() ? std::string(info->parameters[p].name)
                                                                    : "constant " + std::to_string(p);
    parameter.unit = info != nullptr && p < info->parameters.size() ? std::string(info->parameters[p].unit) : "";
    parameter.values = {image.parameters[group.parameter_begin + p]};
    if (info != nullptr && (group.flags >> (kGroupColumnShift + p) & 1U) != 0) {
      const auto values = image.columns.subspan(group.column_begin + std::size_t{column} * group.size, group.size);
      parameter.values.assign(values.begin(), values.end());
      ++column;
    }
    population.parameters.push_back(std::move(parameter));
  }
  for (std::uint32_t r = 0; r < receptors; ++r) {
    const ReceptorRecord& record = image.receptors[group.first_receptor + r];
    population.receptors.push_back({std::string(image.name(record.name)), record.kind,
                                    image.parameters[group.parameter_begin + count + r], record.window_ticks,
                                    record.quantum_log2});
  }
  if (group.data_count > 0) {
    const auto words = group.model == ModelKind::Program ? image.programs : image.source_spikes;
    const auto own = words.subspan(group.data_begin, group.data_count);
    population.words.assign(own.begin(), own.end());
  }
}

/// Neurons of a population whose groups were split by a lesion take the values of the first living group, apart from
/// those that vary, which are put together again.
void read_population(const SpikeImage& image, std::uint32_t index, PopulationView& population) {
  bool is_read = false;
  for (const GroupRecord& group : image.groups) {
    if (group.population != index) {
      continue;
    }
    const std::uint32_t offset = group.first_neuron - population.first_neuron;
    if (is_silent_group(image, group)) {
      for (std::uint32_t i = 0; i < group.size; ++i) {
        population.silenced.push_back(offset + i);
      }
      continue;
    }
    if (!is_read) {
      const ModelInfo* info = find_model(group.model);
      population.model = info != nullptr ? std::string(info->name) : "equations";
      population.weight_unit = info != nullptr ? std::string(info->weight_unit) : "";
      population.is_retina = group.model == ModelKind::FieldSource;
      read_parameters(image, group, population);
      is_read = true;
    }
    PopulationView own;
    read_parameters(image, group, own);
    for (std::size_t p = 0; p < own.parameters.size() && group.size != population.size; ++p) {
      std::vector<double>& all = population.parameters[p].values;
      const double first = all[0];
      all.resize(population.size, first);
      for (std::uint32_t i = 0; i < group.size; ++i) {
        all[offset + i] = own.parameters[p].of(i);
      }
    }
  }
  if (!is_read) {
    population.model = "silenced";
  }
  std::sort(population.silenced.begin(), population.silenced.end());
}

void read_outputs(CircuitView& view) {
  const SpikeImage& image = view.image;
  for (const OutputRecord& record : image.outputs) {
    OutputView output{.name = std::string(image.name(record.name)),
                      .kind = record.kind,
                      .joint_mask = record.joint_mask,
                      .window_ms = record.window_ticks * view.tick_ms(),
                      .offset_deg = record.offset_deg,
                      .terms = {}};
    for (const OutputTermRecord& term : image.output_terms.subspan(record.first_term, record.term_count)) {
      output.terms.push_back({view.population_of(term.first_neuron), term.gain});
    }
    view.outputs.push_back(std::move(output));
  }
}

CircuitView populations_and_outputs(std::string path, const SpikeImage& image) {
  CircuitView view;
  view.path = std::move(path);
  view.image = image;
  for (std::uint32_t p = 0; p < image.populations.size(); ++p) {
    const PopulationRecord& record = image.populations[p];
    PopulationView population;
    population.name = image.name(record.name);
    population.nucleus = image.name(record.nucleus);
    population.first_neuron = record.first_neuron;
    population.size = record.size;
    read_population(image, p, population);
    view.populations.push_back(std::move(population));
  }
  read_outputs(view);
  return view;
}

std::vector<Site> sites_of_slots(const SpikeImage& image) {
  std::vector<Site> sites(image.header.slot_count);
  for (const GroupRecord& group : image.groups) {
    const std::uint32_t offset = group.first_neuron - image.populations[group.population].first_neuron;
    for (std::uint32_t r = 0; r < group.receptor_count; ++r) {
      for (std::uint32_t i = 0; i < group.size; ++i) {
        sites[group.first_slot + r * group.size + i] = {group.population, r, offset + i};
      }
    }
  }
  return sites;
}

std::string place_of(const Sources& sources, const Span& span) {
  const SourceFile& file = sources.file(span.file);
  return file.name + ":" + std::to_string(position_of(file.bytes, span.begin).line);
}

void read_texts(const CompileResult& result, CircuitView& view) {
  if (!result.decl) {
    return;
  }
  for (const ParameterDecl& parameter : result.decl->parameters) {
    view.parameters[parameter.name.text] = {parameter.value.text, place_of(result.sources, parameter.value.span)};
  }
  for (const ProjectionDecl& projection : result.decl->projections) {
    if (projection.weight) {
      view.weight_text[projection.name.text] = {projection.weight->text,
                                                place_of(result.sources, projection.weight->span)};
    }
    if (projection.delay) {
      view.delay_text[projection.name.text] = {projection.delay->text,
                                               place_of(result.sources, projection.delay->span)};
    }
  }
}

}  // namespace

std::uint32_t CircuitView::population_of(std::uint32_t neuron) const {
  const auto after =
      std::upper_bound(populations.begin(), populations.end(), neuron,
                       [](std::uint32_t n, const PopulationView& population) { return n < population.first_neuron; });
  return static_cast<std::uint32_t>(after - populations.begin()) - 1;
}

CircuitView view_of_image(std::string path, const SpikeImage& image) {
  CircuitView view = populations_and_outputs(std::move(path), image);
  const std::vector<Site> sites = sites_of_slots(image);
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::string> names;
  for (const ProjectionRecord& record : image.projections) {
    std::string& name = names[{record.pre_population, record.post_population, record.receptor}];
    name += (name.empty() ? "" : "+") + std::string(image.name(record.name));
  }
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, PathwayView> found;
  for (std::uint32_t neuron = 0; neuron < image.header.neuron_count; ++neuron) {
    const std::uint32_t pre = view.population_of(neuron);
    for (std::uint32_t s = image.row_begin[neuron]; s < image.row_begin[neuron + 1]; ++s) {
      const SegmentRecord& segment = image.segments[s];
      const std::uint32_t end = image.segments[s + 1].target_begin;
      for (std::uint32_t t = segment.target_begin; t < end; ++t) {
        const Site& site = sites[image.targets[t]];
        const bool has_one = (segment.flags & kSegmentOneWeight) != 0;
        const std::int32_t quanta = image.weights[segment.weight_begin + (has_one ? 0 : t - segment.target_begin)];
        PathwayView& pathway = found[{pre, site.population, site.receptor}];
        pathway.synapses.push_back(
            {neuron - view.populations[pre].first_neuron, site.neuron, segment.delay_ticks,
             std::ldexp(quanta, view.populations[site.population].receptors[site.receptor].quantum_log2)});
      }
    }
  }
  for (auto& [key, pathway] : found) {
    std::tie(pathway.pre_population, pathway.post_population, pathway.receptor) = key;
    pathway.projection = names[key];
    sort_synapses(pathway);
    view.pathways.push_back(std::move(pathway));
  }
  return view;
}

CircuitView view_of_compilation(std::string path, const SpikeImage& image, const CompileResult& result) {
  CircuitView view = populations_and_outputs(std::move(path), image);
  const Network& network = *result.network;
  for (const Pathway& pathway : network.pathways) {
    view.pathways.push_back({pathway.name, pathway.pre_population, pathway.post_population, pathway.receptor, {}});
  }
  const Synapses& synapses = network.synapses;
  for (std::size_t s = 0; s < synapses.size(); ++s) {
    PathwayView& pathway = view.pathways[synapses.pathway[s]];
    const NetworkPopulation& post = network.populations[pathway.post_population];
    pathway.synapses.push_back({synapses.pre[s] - network.populations[pathway.pre_population].first_neuron,
                                synapses.post[s] - post.first_neuron, synapses.delay_ticks[s],
                                std::ldexp(synapses.quanta[s], post.quantum_log2[pathway.receptor])});
  }
  for (PathwayView& pathway : view.pathways) {
    sort_synapses(pathway);
  }
  std::erase_if(view.pathways, [](const PathwayView& pathway) { return pathway.synapses.empty(); });
  for (std::size_t p = 0; p < network.populations.size(); ++p) {
    view.populations[p].silenced = network.populations[p].silenced_neurons;
  }
  read_texts(result, view);
  view.has_projections = true;
  return view;
}

void forget_projections(CircuitView& view) {
  if (view.has_projections) {
    CircuitView bare = view_of_image(view.path, view.image);
    view = std::move(bare);
  }
}

SidedName sided_name(const std::string& name) {
  const std::size_t point = name.find('.');
  return point == std::string::npos ? SidedName{name, ""} : SidedName{name.substr(0, point), name.substr(point + 1)};
}

}  // namespace tectum
