#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "tests/exchange/exchanged_circuit.h"

namespace tectum {
namespace {

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) {
    ++count;
  }
  return count;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) {
    fields.push_back(field);
  }
  return fields;
}

constexpr const char* kPair = R"json({
  "tectum": 1, "name": "pair", "tick": "0.1 ms",
  "neurons": { "cell": { "model": "lif_exp" } },
  "populations": {
    "a": { "neuron": "cell", "size": 1, "nucleus": "R & D", "I_bias": "3 nA" }, "b": { "neuron": "cell", "size": 2 }
  },
  "projections": {
    "ab": { "from": "a", "to": "b", "rule": "all_to_all", "weight": "0.1 nA * (1 + post.index)", "delay": "1.3 ms" },
    "bb": { "from": "b", "to": "b", "rule": "all_to_all", "sign": "inhibitory", "weight": "2 nA", "delay": "0.4 ms" }
  }
})json";

TEST_CASE("an edge list has one row a synapse, with the weight that the engine uses to its last bit") {
  const ScratchFolder folder;
  write_text(folder.file("pair.json"), kPair);
  tectum_succeeds({"export", folder.file("pair.json"), "--to", "edges", "-o", folder.file("deep/pair.csv")});
  std::istringstream rows(text_of(folder.file("deep/pair.csv")));
  std::string line;
  std::getline(rows, line);
  CHECK(line == "pre,post,weight,unit,delay_ms,receptor,projection");
  std::getline(rows, line);
  const std::vector<std::string> first = fields_of(line);
  REQUIRE(first.size() == 7);
  CHECK(first[0] == "a.0");
  CHECK(first[1] == "b.0");
  // Two synapses of at most 0.2 nA each go into one receptor: 2^-32 nA is the quantum that keeps their sum below 2^30.
  const double quanta = std::strtod(first[2].c_str(), nullptr) * 0x1p32;
  CHECK(quanta == std::round(quanta));
  CHECK(std::strtod(first[2].c_str(), nullptr) == doctest::Approx(0.1).epsilon(1e-8));
  CHECK(first[3] == "nA");
  CHECK(first[4] == "1.3");
  CHECK(first[5] == "ex");
  CHECK(first[6] == "ab");
  std::getline(rows, line);
  std::getline(rows, line);
  CHECK(line == "b.0,b.1,-2,nA,0.4,in,bb");
  CHECK(count_of(text_of(folder.file("deep/pair_cells.csv")), "\n") == 4);
}

TEST_CASE("a graph has a node a cell and an edge a synapse, or one each for populations and pathways") {
  const ScratchFolder folder;
  write_text(folder.file("pair.json"), kPair);
  tectum_succeeds({"export", folder.file("pair.json"), "--to", "graphml", "-o", folder.file("cells.graphml")});
  const std::string cells = text_of(folder.file("cells.graphml"));
  CHECK(count_of(cells, "<node ") == 3);
  CHECK(count_of(cells, "<edge ") == 4);
  CHECK(count_of(cells, "R &amp; D") == 1);
  tectum_succeeds({"export", folder.file("pair.json"), "--to", "graphml", "--nodes", "population", "-o",
                   folder.file("populations.graphml")});
  const std::string populations = text_of(folder.file("populations.graphml"));
  CHECK(count_of(populations, "<node ") == 2);
  CHECK(count_of(populations, "<edge ") == 2);
  CHECK(count_of(populations, "<data key=\"synapses\">2</data>") == 2);
}

TEST_CASE("the drawing shows inhibition as such, and each nucleus as a box") {
  const ScratchFolder folder;
  write_text(folder.file("pair.json"), kPair);
  tectum_succeeds({"export", folder.file("pair.json"), "--to", "dot", "-o", folder.file("pair.dot")});
  const std::string text = text_of(folder.file("pair.dot"));
  CHECK(count_of(text, "->") == 2);
  CHECK(count_of(text, "arrowhead=tee") == 1);
  CHECK(count_of(text, "subgraph cluster_0 { label=\"R & D\"") == 1);
  CHECK(std::count(text.begin(), text.end(), '{') == std::count(text.begin(), text.end(), '}'));
}

TEST_CASE("what a graph cannot say of a head is named") {
  const ScratchFolder folder;
  const CommandResult result =
      tectum_succeeds({"export", every_model_path(), "--to", "dot", "-o", folder.file("every.dot")});
  CHECK(result.err.find("DOT has no retinas: left out `left_eye`") != std::string::npos);
  CHECK(result.err.find("left out the outputs `pan` and `neck`") != std::string::npos);
}

}  // namespace
}  // namespace tectum
