// Networks as others write them: several node types a population, weights and delays by edge type, ids out of order.
#include <doctest/doctest.h>

#include "tests/exchange/exchanged_circuit.h"
#include "tools/exchange/hdf5_file.h"

namespace tectum {
namespace {

std::unique_ptr<Hdf5Writer> writer(const std::string& path) {
  std::string error;
  auto file = Hdf5Writer::open(path, error);
  REQUIRE_MESSAGE(file != nullptr, error);
  return file;
}

/// Two excitatory cells and an inhibitory one, as NEST's tutorials build them.
struct ForeignNetwork {
  std::string model = "nest:iaf_psc_exp";
  std::string excitatory = R"({ "C_m": 200.0, "tau_m": 20.0, "E_L": -65.0, "V_th": -50.0, "I_e": 400.0 })";
  std::uint64_t last_target = 1;
  double delay_ms = 1.5;

  void write(const ScratchFolder& folder) const {
    const auto nodes = writer(folder.file("v1_nodes.h5"));
    nodes->write("/nodes/v1/node_type_id", std::vector<std::uint64_t>{100, 101, 100});
    nodes->write("/nodes/v1/node_id", std::vector<std::uint64_t>{5, 6, 7});
    nodes->write("/nodes/v1/node_group_id", std::vector<std::uint32_t>{0, 0, 0});
    nodes->write("/nodes/v1/node_group_index", std::vector<std::uint64_t>{0, 1, 2});
    nodes->group("/nodes/v1/0");
    CHECK(nodes->close().empty());
    write_text(folder.file("v1_node_types.csv"),
               "node_type_id population model_type model_template dynamics_params pop_name\n"
               "100 v1 point_neuron " +
                   model +
                   " exc.json \"L4 exc\"\n"
                   "101 v1 point_neuron nest:iaf_psc_exp inh.json inh\n");
    write_text(folder.file("exc.json"), excitatory);
    write_text(folder.file("inh.json"), "{}");
    const auto edges = writer(folder.file("v1_v1_edges.h5"));
    edges->write("/edges/v1_v1/source_node_id", std::vector<std::uint64_t>{5, 6, 7});
    edges->write("/edges/v1_v1/target_node_id", std::vector<std::uint64_t>{6, 7, last_target + 5});
    edges->attribute("/edges/v1_v1/source_node_id", "node_population", "v1");
    edges->attribute("/edges/v1_v1/target_node_id", "node_population", "v1");
    edges->write("/edges/v1_v1/edge_type_id", std::vector<std::uint32_t>{1, 2, 1});
    edges->write("/edges/v1_v1/edge_group_id", std::vector<std::uint32_t>{0, 0, 0});
    edges->write("/edges/v1_v1/edge_group_index", std::vector<std::uint64_t>{0, 1, 2});
    edges->write("/edges/v1_v1/0/nsyns", std::vector<double>{1, 1, 3});
    CHECK(edges->close().empty());
    write_text(folder.file("v1_v1_edge_types.csv"),
               "edge_type_id population model_template syn_weight delay\n"
               "1 v1_v1 static_synapse 250 " +
                   std::to_string(delay_ms) + "\n2 v1_v1 static_synapse -500 2\n");
    write_text(folder.file("config.json"), R"({ "manifest": { "$DIR": "." },
      "components": { "point_neuron_models_dir": "$DIR", "synaptic_models_dir": "$DIR" },
      "networks": { "nodes": [{ "nodes_file": "$DIR/v1_nodes.h5", "node_types_file": "$DIR/v1_node_types.csv" }],
                    "edges": [{ "edges_file": "$DIR/v1_v1_edges.h5", "edge_types_file": "$DIR/v1_v1_edge_types.csv" }] } })");
  }

  CommandResult imported(const ScratchFolder& folder) const {
    write(folder);
    return tectum({"import", "sonata", folder.file("config.json"), "-o", folder.file("v1.json")});
  }
};

TEST_CASE("a network of NEST becomes one population a node type, in Tectum's units") {
  const ScratchFolder folder;
  const CommandResult result = ForeignNetwork().imported(folder);
  REQUIRE_MESSAGE(result.exit_status == 0, result.err);
  CHECK(result.out.find("2 populations, 3 neurons") != std::string::npos);
  const std::string text = text_of(folder.file("v1.json"));
  for (const char* part : {"\"v1_L4_exc\"", "\"R_m\": \"100 MOhm\"", "\"I_bias\": \"0.4 nA\"", "\"V_th\": \"-50 mV\"",
                           "\"sign\": \"inhibitory\"", "\"weight\": \"0.5 nA\"", "\"delay\": \"1.5 ms\""}) {
    CAPTURE(part);
    CHECK(text.find(part) != std::string::npos);
  }
  const SpikeImage image = compiled_file(folder.file("v1.json"));
  CHECK(image.header.neuron_count == 3);
  CHECK(image.targets.size() == 3);
  // Ids 5 and 7 are the excitatory cells: 5 -> 6 with one synapse, 7 -> 6 with three of 250 pA.
  std::string wiring;
  for (const auto& entry : std::filesystem::directory_iterator(folder.file("v1_wiring"))) {
    wiring += text_of(entry.path().string());
  }
  CHECK(wiring.find("0,0,0.25\n1,0,0.75\n") != std::string::npos);
}

TEST_CASE("what Tectum cannot be told is refused by name") {
  const auto error_of = [](const ForeignNetwork& network) {
    const ScratchFolder folder;
    const CommandResult result = network.imported(folder);
    CHECK(result.exit_status == 2);
    CHECK_FALSE(std::filesystem::exists(folder.file("v1.json")));
    return result.err;
  };
  ForeignNetwork network;
  network.model = "nest:hh_psc_alpha";
  CHECK(error_of(network).find("node type 100 of `v1`: Tectum has no counterpart of `hh_psc_alpha`") !=
        std::string::npos);
  network = {};
  network.excitatory = R"({ "C_m": 200.0, "rho": 0.5 })";
  CHECK(error_of(network).find("`rho` of iaf_psc_exp has no counterpart") != std::string::npos);
  network = {};
  network.last_target = 40;
  CHECK(error_of(network).find("edge 2 of `v1_v1` leads to node 45, which `v1` does not have") != std::string::npos);
  network = {};
  network.delay_ms = 1.53;
  CHECK(error_of(network).find("no whole number of ticks of 0.1 ms; --tick sets another") != std::string::npos);
}

}  // namespace
}  // namespace tectum
