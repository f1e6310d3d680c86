#include "tools/exchange/export_neuroml.h"

#include <algorithm>
#include <map>
#include <set>

#include "tools/exchange/foreign_circuit.h"
#include "tools/exchange/format_limits.h"
#include "tools/exchange/text_file.h"

namespace tectum {
namespace {

class NeuromlExport {
 public:
  NeuromlExport(const Wiring& wiring, const std::string& path, const ExchangeProgress& progress)
      : wiring_(wiring), network_(wiring.network), path_(path), progress_(progress) {}

  ExportReport run() {
    refuse();
    if (!report_.error.empty()) {
      return std::move(report_);
    }
    for (std::uint32_t p = 0; p < network_.populations.size(); ++p) {
      split(p);
    }
    TextFile file(path_);
    header(file);
    // The schema takes components in this order only.
    for (const ModelKind kind : {ModelKind::FieldSource, ModelKind::SpikeList, ModelKind::Poisson, ModelKind::LifExp}) {
      for (const Part& part : parts_) {
        if (network_.populations[part.population].model == kind) {
          write_component(part, file);
        }
      }
    }
    write_synapses(file);
    file.write("  <network id=\"{}\">\n", circuit_name_of(network_.name));
    for (const Part& part : parts_) {
      file.write("    <population id=\"{0}\" component=\"{0}_cell\" size=\"{1}\"/>\n", part.id, part.size);
    }
    write_projections(file);
    file.write("  </network>\n</neuroml>\n");
    report_.error = file.close();
    say_what_is_left_out();
    return std::move(report_);
  }

 private:
  /// Neurons of one population that have the same parameters.
  struct Part {
    std::string id;
    std::uint32_t population = 0;
    std::uint32_t neuron = 0;  // one of them, counted in the population
    std::uint32_t size = 0;
  };
  struct Place {
    std::uint32_t part = 0;
    std::uint32_t index = 0;
  };

  static bool can_say(const NetworkPopulation& population) {
    return population.model == ModelKind::LifExp || population.model == ModelKind::Poisson ||
           population.model == ModelKind::SpikeList || population.model == ModelKind::FieldSource;
  }

  void refuse() {
    std::map<std::string, std::vector<std::string>> reasons;
    for (const NetworkPopulation& population : network_.populations) {
      if (!can_say(population)) {
        reasons[std::string(model_name(population))].push_back(population.name);
      }
    }
    for (const auto& [model, names] : reasons) {
      report_.is_refused = true;
      report_.error += fmt::format("{}`{}` ({})", report_.error.empty() ? "NeuroML has no cells of the model " : ", ",
                                   model, list_names(names));
    }
  }

  static const std::vector<const char*>& parameters(const NetworkPopulation& population) {
    static const std::vector<const char*> kCell = {"tau_m", "R_m",     "I_bias", "V_init",
                                                   "V_th",  "V_reset", "E_L",    "t_ref"};
    static const std::vector<const char*> kRate = {"rate"};
    static const std::vector<const char*> kNone;
    return population.model == ModelKind::LifExp ? kCell : population.model == ModelKind::Poisson ? kRate : kNone;
  }

  static double value(const NetworkPopulation& population, const char* name, std::uint32_t neuron) {
    const std::vector<double> values = parameter_of(population, name);
    return values[values.size() == 1 ? 0 : neuron];
  }

  /// A population of NeuroML has one component.
  void split(std::uint32_t p) {
    const NetworkPopulation& population = network_.populations[p];
    std::vector<std::vector<double>> columns;
    for (const char* name : parameters(population)) {
      columns.push_back(parameter_of(population, name));
    }
    std::map<std::vector<double>, std::uint32_t> part_of;
    std::vector<Place>& places = places_.emplace_back();
    for (std::uint32_t i = 0; i < population.size; ++i) {
      std::vector<double> key;
      for (const std::vector<double>& column : columns) {
        key.push_back(column[column.size() == 1 ? 0 : i]);
      }
      const auto [entry, is_new] = part_of.emplace(key, static_cast<std::uint32_t>(parts_.size()));
      if (is_new) {
        parts_.push_back({"", p, i, 0});
      }
      places.push_back({entry->second, parts_[entry->second].size++});
    }
    const std::string id = circuit_name_of(population.name);
    for (const auto& [key, part] : part_of) {
      parts_[part].id = part_of.size() == 1 ? id : fmt::format("{}_{}", id, parts_[part].neuron);
    }
  }

  void header(TextFile& file) const {
    file.write("{}",
               "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
               "<neuroml xmlns=\"http://www.neuroml.org/schema/neuroml2\"\n"
               "         xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"\n"
               "         xsi:schemaLocation=\"http://www.neuroml.org/schema/neuroml2 "
               "https://raw.github.com/NeuroML/NeuroML2/development/Schemas/NeuroML2/NeuroML_v2.3.xsd\"\n");
    file.write("         id=\"{}_document\">\n", circuit_name_of(network_.name));
  }

  static std::string synapse_id(double tau_ms) {
    std::string id = fmt::format("psc_{}ms", tau_ms);
    std::replace_if(
        id.begin(), id.end(), [](char c) { return c == '.' || c == '-' || c == '+'; }, '_');
    return id;
  }

  void write_synapses(TextFile& file) const {
    std::set<double> taus_ms;
    for (const Pathway& pathway : network_.pathways) {
      taus_ms.insert(network_.populations[pathway.post_population].receptors[pathway.receptor].tau_ms);
    }
    for (const double tau_ms : taus_ms) {
      file.write("  <expCurrSynapse id=\"{}\" tau_syn=\"{}\"/>\n", synapse_id(tau_ms), tau_ms);
    }
  }

  void write_component(const Part& part, TextFile& file) const {
    const NetworkPopulation& population = network_.populations[part.population];
    const auto of = [&](const char* name) { return value(population, name, part.neuron); };
    if (population.model == ModelKind::Poisson) {
      file.write("  <spikeGeneratorPoisson id=\"{}_cell\" averageRate=\"{}Hz\"/>\n", part.id, of("rate"));
      return;
    }
    if (population.model != ModelKind::LifExp) {
      file.write("  <spikeArray id=\"{}_cell\">\n", part.id);
      std::size_t number = 0;
      for (const std::uint32_t tick : population.spike_ticks) {
        file.write("    <spike id=\"{}\" time=\"{}ms\"/>\n", number++, tick * network_.tick_ms());
      }
      file.write("  </spikeArray>\n");
      return;
    }
    // tau_syn_E and tau_syn_I must be there and mean nothing: each synapse has its own.
    const double tau_ms = population.receptors.empty() ? 1 : population.receptors.front().tau_ms;
    file.write(
        "  <IF_curr_exp id=\"{}_cell\" cm=\"{}\" i_offset=\"{}\" tau_syn_E=\"{}\" tau_syn_I=\"{}\" v_init=\"{}\" "
        "tau_m=\"{}\" tau_refrac=\"{}\" v_reset=\"{}\" v_rest=\"{}\" v_thresh=\"{}\"/>\n",
        part.id, of("tau_m") / of("R_m"), of("I_bias"), tau_ms, tau_ms, of("V_init"), of("tau_m"), of("t_ref"),
        of("V_reset"), of("E_L"), of("V_th"));
  }

  void write_projections(TextFile& file) {
    using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // pathway, part before, part after
    std::map<Key, std::vector<std::size_t>> projections;
    for (std::size_t s = 0; s < network_.synapses.size(); ++s) {
      const std::uint32_t p = network_.synapses.pathway[s];
      projections[{p, pre_place(s).part, post_place(s).part}].push_back(s);
    }
    std::size_t done = 0;
    for (const auto& [key, synapses] : projections) {
      const auto [p, before, after] = key;
      const Pathway& pathway = network_.pathways[p];
      const Part& pre = parts_[before];
      const Part& post = parts_[after];
      const double tau_ms = network_.populations[pathway.post_population].receptors[pathway.receptor].tau_ms;
      file.write(
          "    <projection id=\"{}_{}_{}\" presynapticPopulation=\"{}\" postsynapticPopulation=\"{}\" "
          "synapse=\"{}\">\n",
          circuit_name_of(pathway.name), pre.id, post.id, pre.id, post.id, synapse_id(tau_ms));
      std::size_t number = 0;
      for (const std::size_t s : synapses) {
        file.write(
            "      <connectionWD id=\"{}\" preCellId=\"../{}[{}]\" postCellId=\"../{}[{}]\" weight=\"{}\" "
            "delay=\"{}ms\"/>\n",
            number++, pre.id, pre_place(s).index, post.id, post_place(s).index, weight_of(network_, s),
            network_.synapses.delay_ticks[s] * network_.tick_ms());
      }
      file.write("    </projection>\n");
      done += synapses.size();
      progress_(static_cast<double>(done) / static_cast<double>(network_.synapses.size()));
    }
  }

  [[nodiscard]] Place pre_place(std::size_t s) const {
    const std::uint32_t p = network_.pathways[network_.synapses.pathway[s]].pre_population;
    return places_[p][network_.synapses.pre[s] - network_.populations[p].first_neuron];
  }
  [[nodiscard]] Place post_place(std::size_t s) const {
    const std::uint32_t p = network_.pathways[network_.synapses.pathway[s]].post_population;
    return places_[p][network_.synapses.post[s] - network_.populations[p].first_neuron];
  }

  void say_what_is_left_out() {
    report_.warnings = head_limits(wiring_, "NeuroML");
    std::vector<std::string> split_up;
    for (std::size_t p = 0; p < network_.populations.size(); ++p) {
      const auto parts =
          std::count_if(parts_.begin(), parts_.end(), [&](const Part& part) { return part.population == p; });
      if (parts > 1) {
        split_up.push_back(network_.populations[p].name);
      }
    }
    if (!split_up.empty()) {
      report_.warnings.push_back(
          fmt::format("NeuroML has one set of parameters a population: {} are split up, `NAME_i` begins with neuron i",
                      list_names(split_up)));
    }
  }

  const Wiring& wiring_;
  const Network& network_;
  const std::string& path_;
  const ExchangeProgress& progress_;
  std::vector<Part> parts_;
  std::vector<std::vector<Place>> places_;  // of each population's neurons
  ExportReport report_;
};

}  // namespace

ExportReport export_neuroml(const Wiring& wiring, const std::string& path, const ExchangeProgress& progress) {
  return NeuromlExport(wiring, path, progress).run();
}

}  // namespace tectum
