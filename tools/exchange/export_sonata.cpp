#include "tools/exchange/export_sonata.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "tools/exchange/circuit_rest.h"
#include "tools/exchange/format_limits.h"
#include "tools/exchange/hdf5_file.h"
#include "tools/exchange/sonata_types.h"
#include "tools/exchange/text_file.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::array<std::uint32_t, 1> kSonataMagic = {0x0A7A};
constexpr std::array<std::uint32_t, 2> kSonataVersion = {0, 1};
constexpr double kRunMs = 1000;  // what a simulation takes when nobody says how long

class SonataExport {
 public:
  SonataExport(const CompileResult& result, std::string folder, const ExchangeProgress& progress)
      : result_(result),
        circuit_(*result.circuit),
        network_(*result.network),
        folder_(std::move(folder)),
        progress_(progress) {}

  ExportReport run() {
    describe_populations();
    write_nodes();
    write_edges();
    write_spikes();
    write_configs();
    say_what_differs();
    return std::move(report_);
  }

 private:
  [[nodiscard]] std::string path(const std::string& name) const { return (fs::path(folder_) / name).string(); }

  void note(const std::string& error) {
    if (report_.error.empty()) {
      report_.error = error;
    }
  }

  void write_json(const std::string& name, const Json& json) {
    TextFile file(path(name));
    file.write("{}\n", json.dump(2));
    note(file.close());
  }

  std::unique_ptr<Hdf5Writer> open_hdf5(const std::string& name) {
    make_parent_folders(path(name));
    std::string error;
    auto file = Hdf5Writer::open(path(name), error);
    note(error);
    if (file) {
      file->attribute("/", "magic", kSonataMagic);
      file->attribute("/", "version", kSonataVersion);
    }
    return file;
  }

  void describe_populations() {
    // Receptors that only their weights' signs tell apart need no ports in NEST.
    std::vector<bool> splits(network_.populations.size(), true);
    for (std::size_t s = 0; s < network_.synapses.size(); ++s) {
      const Pathway& pathway = network_.pathways[network_.synapses.pathway[s]];
      const std::string& name = network_.populations[pathway.post_population].receptors[pathway.receptor].name;
      const std::int32_t quanta = network_.synapses.quanta[s];
      if ((name == "ex" && quanta < 0) || (name == "in" && quanta > 0)) {
        splits[pathway.post_population] = false;
      }
    }
    std::uint64_t next_type = 100;
    for (std::size_t p = 0; p < network_.populations.size(); ++p) {
      populations_.push_back(sonata_population(network_.populations[p], network_.tick_ms(), splits[p], next_type));
      next_type += populations_.back().types.size();
    }
  }

  std::vector<std::string> kinds() const {
    std::vector<std::string> found;
    for (const char* kind : {"neuron", "generator", "virtual"}) {
      if (std::any_of(populations_.begin(), populations_.end(), [&](const auto& p) { return p.kind == kind; })) {
        found.emplace_back(kind);
      }
    }
    return found;
  }

  void write_nodes() {
    for (const std::string& kind : kinds()) {
      TextFile types(path("network/" + kind + "_node_types.csv"));
      types.write("node_type_id population model_type model_template dynamics_params tectum_model tectum_receptors");
      for (const char* name : kKeptParameters) {
        types.write(" tectum_{}", name);
      }
      types.write("\n");
      const auto nodes = open_hdf5("network/" + kind + "_nodes.h5");
      for (std::size_t p = 0; nodes && p < populations_.size(); ++p) {
        if (populations_[p].kind == kind) {
          write_node_types(p, types);
          write_population(p, *nodes);
        }
      }
      note(types.close());
      note(nodes ? nodes->close() : "");
    }
  }

  void write_node_types(std::size_t p, TextFile& types) {
    const SonataPopulation& population = populations_[p];
    const NetworkPopulation& source = network_.populations[p];
    for (std::size_t t = 0; t < population.types.size(); ++t) {
      const SonataNodeType& type = population.types[t];
      const std::string file =
          population.types.size() == 1 ? source.name + ".json" : fmt::format("{}.{}.json", source.name, t);
      write_json("components/point_neuron_models/" + file, type.dynamics);
      types.write("{} {} {} {} {} {} {}", type.id, source.name, population.model_type, population.model_template, file,
                  model_name(source), population.receptors);
      for (const char* name : kKeptParameters) {
        const auto kept = type.kept.find(name);
        types.write(" {}", kept == type.kept.end() ? "NULL" : fmt::format("{}", kept->second));
      }
      types.write("\n");
    }
  }

  void write_population(std::size_t p, Hdf5Writer& nodes) {
    const SonataPopulation& population = populations_[p];
    const Instance& instance = circuit_.instances[p];
    const std::uint32_t size = network_.populations[p].size;
    const std::string group = "/nodes/" + network_.populations[p].name;
    std::vector<std::uint64_t> index(size);
    for (std::uint32_t i = 0; i < size; ++i) {
      index[i] = i;
    }
    nodes.write(group + "/node_id", index);
    nodes.write(group + "/node_type_id", population.type_of);
    nodes.write(group + "/node_group_id", std::vector<std::uint32_t>(size, 0));
    nodes.write(group + "/node_group_index", index);
    nodes.group(group + "/0");
    if (instance.x.size() == size && instance.y.size() == size) {
      nodes.write(group + "/0/x", instance.x);
      nodes.write(group + "/0/y", instance.y);
    }
    for (const auto& [name, values] : population.single) {
      nodes.write(group + "/0/dynamics_params/" + name, values);
    }
    for (const auto& [name, values] : population.single_kept) {
      nodes.write(group + "/0/tectum_" + name, values);
    }
  }

  /// Synapses by the populations that they join, in the order in which projections made them.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> synapses_by_pair() const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> pairs;
    for (std::size_t s = 0; s < network_.synapses.size(); ++s) {
      const Pathway& pathway = network_.pathways[network_.synapses.pathway[s]];
      pairs[{pathway.pre_population, pathway.post_population}].push_back(s);
    }
    return pairs;
  }

  void write_edges() {
    const auto pairs = synapses_by_pair();
    if (pairs.empty()) {
      return;
    }
    has_edges_ = true;
    write_edge_types();
    const auto edges = open_hdf5("network/edges.h5");
    if (!edges) {
      return;
    }
    std::size_t done = 0;
    for (const auto& [pair, synapses] : pairs) {
      write_edge_population(pair.first, pair.second, synapses, *edges);
      done += synapses.size();
      progress_(static_cast<double>(done) / static_cast<double>(network_.synapses.size()));
    }
    note(edges->close());
  }

  [[nodiscard]] std::string edge_population(std::uint32_t pre, std::uint32_t post) const {
    return network_.populations[pre].name + "_to_" + network_.populations[post].name;
  }

  void write_edge_types() {
    TextFile types(path("network/edge_types.csv"));
    types.write("edge_type_id population model_template dynamics_params tectum_projection tectum_receptor\n");
    std::set<std::uint32_t> ports;
    for (std::size_t p = 0; p < network_.pathways.size(); ++p) {
      const Pathway& pathway = network_.pathways[p];
      const bool has_port = populations_[pathway.post_population].nest.has_ports;
      const std::uint32_t port = has_port ? pathway.receptor + 1 : 0;
      ports.insert(port);
      types.write("{} {} static_synapse {} {} {}\n", p,
                  edge_population(pathway.pre_population, pathway.post_population), port_file(port), pathway.name,
                  network_.populations[pathway.post_population].receptors[pathway.receptor].name);
    }
    note(types.close());
    for (const std::uint32_t port : ports) {
      write_json("components/synaptic_models/" + port_file(port),
                 port == 0 ? Json::object() : Json{{"receptor_type", port}});
    }
  }

  static std::string port_file(std::uint32_t port) {
    return port == 0 ? "static.json" : fmt::format("port_{}.json", port);
  }

  void write_edge_population(std::uint32_t pre, std::uint32_t post, const std::vector<std::size_t>& synapses,
                             Hdf5Writer& edges) {
    const std::uint32_t first_pre = network_.populations[pre].first_neuron;
    const std::uint32_t first_post = network_.populations[post].first_neuron;
    const double scale = populations_[post].nest.weight_scale;
    std::vector<std::uint64_t> source, target, index;
    std::vector<std::uint32_t> type;
    std::vector<double> weight, native, delay_ms;
    bool is_exact = true;
    for (const std::size_t s : synapses) {
      source.push_back(network_.synapses.pre[s] - first_pre);
      target.push_back(network_.synapses.post[s] - first_post);
      index.push_back(index.size());
      type.push_back(network_.synapses.pathway[s]);
      native.push_back(weight_of(network_, s));
      weight.push_back(native.back() * scale);
      is_exact = is_exact && weight.back() / scale == native.back();
      delay_ms.push_back(network_.synapses.delay_ticks[s] * network_.tick_ms());
    }
    const std::string group = "/edges/" + edge_population(pre, post);
    edges.write(group + "/source_node_id", source);
    edges.write(group + "/target_node_id", target);
    edges.attribute(group + "/source_node_id", "node_population", network_.populations[pre].name);
    edges.attribute(group + "/target_node_id", "node_population", network_.populations[post].name);
    edges.write(group + "/edge_type_id", type);
    edges.write(group + "/edge_group_id", std::vector<std::uint32_t>(synapses.size(), 0));
    edges.write(group + "/edge_group_index", index);
    edges.write(group + "/0/syn_weight", weight);
    edges.write(group + "/0/delay", delay_ms);
    if (!is_exact) {
      edges.write(group + "/0/tectum_weight", native);
    }
  }

  void write_spikes() {
    std::unique_ptr<Hdf5Writer> spikes;
    for (std::size_t p = 0; p < populations_.size(); ++p) {
      if (populations_[p].kind != "virtual") {
        continue;
      }
      if (!spikes) {
        spikes = open_hdf5("inputs/spikes.h5");
      }
      if (!spikes) {
        return;
      }
      const NetworkPopulation& population = network_.populations[p];
      std::vector<double> times_ms;
      std::vector<std::uint64_t> nodes;
      for (const std::uint32_t tick : population.spike_ticks) {
        for (std::uint32_t i = 0; i < population.size; ++i) {
          times_ms.push_back(tick * network_.tick_ms());
          nodes.push_back(i);
        }
      }
      const std::string group = "/spikes/" + population.name;
      spikes->write(group + "/timestamps", times_ms);
      spikes->write(group + "/node_ids", nodes);
      spikes->attribute(group, "sorting", "by_time");
      spikes->attribute(group + "/timestamps", "units", "ms");
    }
    note(spikes ? spikes->close() : "");
  }

  void write_configs() {
    const Json manifest = {{"$BASE_DIR", "${configdir}"},
                           {"$NETWORK_DIR", "$BASE_DIR/network"},
                           {"$COMPONENTS_DIR", "$BASE_DIR/components"},
                           {"$INPUT_DIR", "$BASE_DIR/inputs"},
                           {"$OUTPUT_DIR", "$BASE_DIR/output"}};
    Json config = {{"target_simulator", "NEST"}, {"manifest", manifest}};
    config["components"] = {{"point_neuron_models_dir", "$COMPONENTS_DIR/point_neuron_models"},
                            {"synaptic_models_dir", "$COMPONENTS_DIR/synaptic_models"}};
    config["networks"] = {{"nodes", Json::array()}, {"edges", Json::array()}};
    for (const std::string& kind : kinds()) {
      config["networks"]["nodes"].push_back({{"nodes_file", "$NETWORK_DIR/" + kind + "_nodes.h5"},
                                             {"node_types_file", "$NETWORK_DIR/" + kind + "_node_types.csv"}});
    }
    if (has_edges_) {
      config["networks"]["edges"].push_back(
          {{"edges_file", "$NETWORK_DIR/edges.h5"}, {"edge_types_file", "$NETWORK_DIR/edge_types.csv"}});
    }
    write_json("circuit_config.json", config);
    Json simulation = {{"target_simulator", "NEST"}, {"manifest", manifest}};
    simulation["network"] = "${configdir}/circuit_config.json";
    simulation["node_sets_file"] = "${configdir}/node_sets.json";
    simulation["run"] = {{"tstop", kRunMs}, {"dt", network_.tick_ms()}};
    simulation["inputs"] = Json::object();
    Json node_sets = Json::object();
    for (std::size_t p = 0; p < populations_.size(); ++p) {
      const std::string& name = network_.populations[p].name;
      node_sets[name] = {{"population", name}};
      if (populations_[p].kind == "virtual") {
        simulation["inputs"][name] = {
            {"input_type", "spikes"}, {"module", "sonata"}, {"input_file", "$INPUT_DIR/spikes.h5"}, {"node_set", name}};
      }
    }
    simulation["output"] = {
        {"output_dir", "$OUTPUT_DIR"}, {"spikes_file", "spikes.h5"}, {"overwrite_output_dir", true}};
    write_json("simulation_config.json", simulation);
    write_json("node_sets.json", node_sets);
    write_json("tectum.json", circuit_rest(result_));
  }

  void say_what_differs() {
    std::map<std::string, std::vector<std::string>> mismatches;
    std::vector<std::string> unread, fields, single, lesioned;
    for (std::size_t p = 0; p < populations_.size(); ++p) {
      const NetworkPopulation& population = network_.populations[p];
      if (population.model == ModelKind::FieldSource) {
        fields.push_back(population.name);
      } else if (populations_[p].kind != "virtual" && populations_[p].nest.name.empty()) {
        mismatches["NEST cannot run {}: " + populations_[p].nest.mismatch].push_back(population.name);
      } else if (!populations_[p].nest.mismatch.empty() && populations_[p].kind != "virtual") {
        mismatches["NEST runs {} otherwise: " + populations_[p].nest.mismatch].push_back(population.name);
      }
      if (!populations_[p].single.empty()) {
        single.push_back(population.name);
      }
      if (!population.silenced_neurons.empty() && population.silenced_neurons.size() < population.size) {
        lesioned.push_back(population.name);
      }
    }
    warn("no SONATA simulator has retinas: {} get no spikes in inputs/spikes.h5", fields);
    for (const auto& [text, names] : mismatches) {
      warn(text, names);
    }
    warn("NEST reads one value a node type: in {} the neurons differ too much, their parameters are in nodes.h5",
         single);
    warn("the lesioned neurons of {} stay as neurons without synapses, which may fire", lesioned);
    say_no_delay();
    std::vector<std::string> outputs;
    for (const Output& output : network_.outputs) {
      outputs.push_back(output.name);
    }
    for (std::string& limit : learning_limits({circuit_, network_}, "a SONATA network")) {
      report_.warnings.push_back(std::move(limit));
    }
    warn("no SONATA simulator moves joints: the outputs {} are in tectum.json for Tectum alone", outputs);
  }

  void say_no_delay() {
    std::set<std::string> names;
    for (std::size_t s = 0; s < network_.synapses.size(); ++s) {
      if (network_.synapses.delay_ticks[s] == 0) {
        names.insert(network_.pathways[network_.synapses.pathway[s]].name);
      }
    }
    warn("NEST takes no delay of 0 ms and refuses the synapses of {}", {names.begin(), names.end()});
  }

  void warn(const std::string& text, const std::vector<std::string>& names) {
    const std::size_t at = text.find("{}");
    if (!names.empty()) {
      report_.warnings.push_back(text.substr(0, at) + list_names(names) + text.substr(at + 2));
    }
  }

  const CompileResult& result_;
  const Circuit& circuit_;
  const Network& network_;
  std::string folder_;
  const ExchangeProgress& progress_;
  std::vector<SonataPopulation> populations_;
  bool has_edges_ = false;
  ExportReport report_;
};

}  // namespace

ExportReport export_sonata(const CompileResult& result, const std::string& folder, const ExchangeProgress& progress) {
  return SonataExport(result, folder, progress).run();
}

}  // namespace tectum
