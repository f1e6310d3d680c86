// What `tectum run --learn` leaves behind, from the command line.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "tests/circuits/compiled_circuit.h"
#include "tools/tectum/learned_overlay.h"
#include "tools/tectum/tectum_main.h"

using namespace tectum;

namespace {

namespace fs = std::filesystem;

struct Ran {
  int status;
  std::string out, err;
};
Ran tectum_with(const std::vector<std::string>& args) {
  std::ostringstream out, err;
  const int status = tectum_main(args, out, err);
  return {status, out.str(), err.str()};
}

/// A folder of this process's own, gone with it.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("tectum_learning_" + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

/// Eye and pathway that learn, and one that does not.
const char* const kCircuit = R"j({
  "tectum": 1, "name": "small", "tick": "1 ms",
  "neurons": { "cell": { "model": "lif_exp", "tau_m": "10 ms", "I_bias": "1.8 nA" } },
  "inputs": { "eye": { "retina": { "eye": "left", "frame": [8, 8], "field_of_view": "39 deg",
    "rings": [{ "outer": 4, "block": [4, 4] }], "lit": { "channel": "green - max(red, blue)", "above": 20 }, "fires_when": "any" } } },
  "populations": { "SC": { "input": "eye", "rate": "100 Hz" }, "A": { "neuron": "cell", "size": 4 },
    "B": { "neuron": "cell", "size": 3 } },
  "projections": {
    "sc_a": { "from": "SC", "to": "A", "rule": "all_to_all", "weight": "0.8 nA + 0.1 nA * post.index", "delay": "1 ms",
      "plasticity": { "reward": "pan", "learning_rate": "20 Hz" } },
    "a_b": { "from": "A", "to": "B", "rule": "all_to_all", "weight": "0.4 nA", "delay": "2 ms",
      "plasticity": { "reward": "tilt", "learning_rate": "20 Hz", "bounds": [0.25, 3] } } }
})j";

SpikeImage compiled_file(const std::string& path, const std::string& image_path) {
  const Ran ran = tectum_with({"compile", path, "-o", image_path});
  REQUIRE_MESSAGE(ran.status == 0, ran.err);
  LoadedImage loaded = load_image_file(image_path);
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  return std::move(*loaded.image);
}

}  // namespace

TEST_CASE("what was learned is saved as a circuit that starts with exactly those weights, and learns on from there") {
  const Folder folder;
  const std::string circuit = folder.file("small.json");
  std::ofstream(circuit) << kCircuit;
  const std::string saved = folder.file("deeper/learned.json");
  const std::vector<std::string> run = {"--scenario", "random", "--duration", "20", "--learn"};
  const auto with = [&](std::vector<std::string> args) {
    args.insert(args.end(), run.begin(), run.end());
    return tectum_with(args);
  };
  const Ran first = with({"run", circuit, "--save-weights", saved, "--record", folder.file("first")});
  REQUIRE_MESSAGE(first.status == 0, first.err);
  CHECK(first.out.find("sc_a") != std::string::npos);

  const SpikeImage before = compiled_file(circuit, folder.file("before.img"));
  const SpikeImage after = compiled_file(saved, folder.file("after.img"));
  REQUIRE(before.plastic_synapses.size() == 76);
  REQUIRE(after.plastic_synapses.size() == 76);
  std::size_t changed = 0;
  for (std::size_t s = 0; s < 76; ++s) {
    CHECK(before.plastic_synapses[s].base_quanta == after.plastic_synapses[s].base_quanta);
    changed += before.plastic_synapses[s].scale == after.plastic_synapses[s].scale ? 0 : 1;
  }
  CHECK(changed > 12);

  // Saved again from there, nothing learned in between: the same factors, digit by digit.
  std::vector<std::int32_t> scales;
  for (const PlasticSynapseRecord& synapse : after.plastic_synapses) {
    scales.push_back(synapse.scale);
  }
  std::ifstream file(saved);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  CHECK(learned_overlay(before, scales, circuit, saved) == text);
  CHECK(text.find("../small.json") != std::string::npos);

  const Ran replayed = tectum_with({"replay", folder.file("first/run.trec")});
  CHECK(replayed.status == 0);
  CHECK(replayed.out.find(std::to_string(changed) + " weights learned") != std::string::npos);

  const Ran formatted = tectum_with({"fmt", "--check", saved});
  CHECK_MESSAGE(formatted.status == 0, formatted.err);
  const Ran difference = tectum_with({"diff", circuit, saved});
  CHECK(difference.out.find("sc_a") != std::string::npos);
}

TEST_CASE("--learn and --save-weights say what they miss") {
  const Folder folder;
  const std::string circuit = folder.file("small.json");
  std::ofstream(circuit) << kCircuit;
  const std::string overlay = folder.file("fixed.json");
  std::ofstream(overlay) << R"({ "tectum": 1, "extends": "small.json", "projections": {
    "sc_a": { "plasticity": null }, "a_b": { "plasticity": null } } })";
  const Ran nothing = tectum_with({"run", overlay, "--learn", "--duration", "1"});
  CHECK(nothing.status == 1);
  CHECK(nothing.err == "tectum: nothing in " + overlay + " learns: no projection has `plasticity`\n");
  const Ran without = tectum_with({"run", circuit, "--save-weights", folder.file("w.json"), "--duration", "1"});
  CHECK(without.status == 2);
  CHECK(without.err == "tectum: --save-weights writes what --learn has learned, and --learn is not given\n");
  const std::string image = folder.file("small.img");
  (void)compiled_file(circuit, image);
  const Ran of_image =
      tectum_with({"run", image, "--learn", "--save-weights", folder.file("w.json"), "--duration", "1"});
  CHECK(of_image.status == 2);
  CHECK(of_image.err == "tectum: --save-weights extends a circuit file, and this is an image\n");
}
