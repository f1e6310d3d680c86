#include <doctest/doctest.h>

#include <algorithm>

#include "tests/exchange/exchanged_circuit.h"
#include "tools/exchange/hdf5_file.h"

namespace tectum {
namespace {

constexpr const char* kChain = R"json({
  "tectum": 1, "name": "chain", "tick": "0.1 ms",
  "neurons": {
    "one": {
      "model": "lif_exp", "tau_m": "10 ms", "R_m": "5 MOhm", "t_ref": "0 ms", "receptors": { "ex": { "tau": "2 ms" } }
    },
    "two": { "model": "lif_exp", "tau_syn_ex": "3 ms", "tau_syn_in": "7 ms" },
    "train": { "model": "poisson", "rate": "20 Hz" }
  },
  "populations": {
    "S": { "neuron": "train", "size": 3 },
    "A": { "neuron": "one", "size": 2, "I_bias": "1 nA" },
    "B": { "neuron": "two", "size": 2 }
  },
  "projections": {
    "sa": { "from": "S", "to": "A", "rule": "all_to_all", "weight": "0.5 nA * (1 + pre.index)", "delay": "1.5 ms" },
    "ab": { "from": "A", "to": "B", "rule": "one_to_one", "weight": "2 nA", "delay": "0 ms" },
    "bb": { "from": "B", "to": "B", "rule": "all_to_all", "sign": "inhibitory", "weight": "1 nA", "delay": "1 ms" }
  }
})json";

std::unique_ptr<Hdf5Reader> opened(const std::string& path) {
  std::string error;
  auto file = Hdf5Reader::open(path, error);
  REQUIRE_MESSAGE(file != nullptr, error);
  return file;
}

std::string type_of(Hdf5Reader& file, const std::string& node) {
  const auto type = file.texts("/node/nodes/" + node + "/type");
  return type && type->size() == 1 ? type->front() : "";
}

TEST_CASE("a chain becomes a NIR graph with the nodes, units and weights that NIR defines") {
  const ScratchFolder folder;
  write_text(folder.file("chain.json"), kChain);
  const CommandResult result =
      tectum_succeeds({"export", folder.file("chain.json"), "--to", "nir", "-o", folder.file("chain.nir")});
  const auto file = opened(folder.file("chain.nir"));
  CHECK(file->texts("/node/type") == std::vector<std::string>{"NIRGraph"});
  CHECK(type_of(*file, "S") == "Input");
  CHECK(file->integers("/node/nodes/S/shape") == std::vector<std::int64_t>{3});
  CHECK(type_of(*file, "A") == "CubaLIF");
  CHECK(file->numbers("/node/nodes/A/tau_mem") == std::vector<double>{0.01, 0.01});
  CHECK(file->numbers("/node/nodes/A/tau_syn") == std::vector<double>{0.002, 0.002});
  CHECK(file->numbers("/node/nodes/A/v_leak") == std::vector<double>{-65, -65});  // -70 mV and 5 MOhm times 1 nA
  // Two time constants: one filter each before the membrane.
  CHECK(type_of(*file, "B") == "LIF");
  CHECK(type_of(*file, "B.ex") == "LI");
  CHECK(file->numbers("/node/nodes/B.in/tau") == std::vector<double>{0.007, 0.007});
  CHECK(file->shape("/node/nodes/sa.S_to_A.15/weight") == std::vector<std::size_t>{2, 3});
  CHECK(file->numbers("/node/nodes/sa.S_to_A.15/weight") == std::vector<double>{0.5, 1, 1.5, 0.5, 1, 1.5});
  CHECK(file->numbers("/node/nodes/S.delay.15/delay") == std::vector<double>{0.0015, 0.0015, 0.0015});
  CHECK(file->numbers("/node/nodes/bb.B_to_B.10/weight") == std::vector<double>{0, -1, -1, 0});
  CHECK(result.err.find("t_ref is left out of `B`") != std::string::npos);
}

TEST_CASE("every edge of a NIR graph joins nodes that are there") {
  const ScratchFolder folder;
  write_text(folder.file("chain.json"), kChain);
  tectum_succeeds({"export", folder.file("chain.json"), "--to", "nir", "-o", folder.file("chain.nir")});
  const auto file = opened(folder.file("chain.nir"));
  const auto edges = file->texts("/node/edges");
  REQUIRE(edges.has_value());
  CHECK(file->shape("/node/edges") == std::vector<std::size_t>{edges->size() / 2, 2});
  std::vector<std::string> names;
  for (const Hdf5Entry& entry : file->list("/node/nodes")) {
    names.push_back(entry.name);
  }
  for (const std::string& end : *edges) {
    CAPTURE(end);
    CHECK(std::find(names.begin(), names.end(), end) != names.end());
  }
}

TEST_CASE("what NIR and NeuroML have no neurons for is refused by name") {
  const ScratchFolder folder;
  for (const char* format : {"nir", "neuroml"}) {
    const CommandResult result = tectum({"export", every_model_path(), "--to", format, "-o", folder.file("out")});
    CHECK(result.exit_status == 1);
    CHECK(result.err.find("`alif` (`TN.left` and `TN.right`)") != std::string::npos);
    CHECK(result.err.find("`bursting` (`B.left` and `B.right`)") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder.file("out")));
  }
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) {
    ++count;
  }
  return count;
}

TEST_CASE("a NeuroML document has the cells, synapses and connections of the circuit, in NeuroML's units") {
  const ScratchFolder folder;
  write_text(folder.file("chain.json"), kChain);
  tectum_succeeds({"export", folder.file("chain.json"), "--to", "neuroml", "-o", folder.file("chain.nml")});
  const std::string text = text_of(folder.file("chain.nml"));
  CHECK(count_of(text, "<population ") == 3);
  CHECK(count_of(text, "<connectionWD ") == 6 + 2 + 2);
  CHECK(count_of(text, "<expCurrSynapse ") == 3);
  CHECK(text.find("<spikeGeneratorPoisson id=\"S_cell\" averageRate=\"20Hz\"/>") != std::string::npos);
  CHECK(text.find("<IF_curr_exp id=\"A_cell\" cm=\"2\" i_offset=\"1\"") != std::string::npos);
  CHECK(text.find("preCellId=\"../S[2]\" postCellId=\"../A[1]\" weight=\"1.5\" delay=\"1.5ms\"") != std::string::npos);
  CHECK(text.find("preCellId=\"../B[0]\" postCellId=\"../B[1]\" weight=\"-1\" delay=\"1ms\"") != std::string::npos);
  CHECK(count_of(text, "<projection ") == count_of(text, "</projection>"));
  // The schema is a sequence: inputs, PyNN's cells, PyNN's synapses, networks.
  CHECK(text.find("<spikeGeneratorPoisson ") < text.find("<IF_curr_exp "));
  CHECK(text.rfind("<IF_curr_exp ") < text.find("<expCurrSynapse "));
  CHECK(text.rfind("<expCurrSynapse ") < text.find("<network "));
}

}  // namespace
}  // namespace tectum
