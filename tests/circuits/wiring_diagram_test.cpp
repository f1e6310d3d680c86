// A measured wiring diagram that nobody wrote as a circuit: imported with one command, it compiles and runs.
#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <sstream>
#include <string>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"
#include "runtime/engine/spike_engine.h"
#include "tests/support/laser_dot.h"
#include "tools/tectum/tectum_main.h"

using namespace tectum;

namespace {

namespace fs = std::filesystem;

/// A folder of its own, gone with the test.
struct TestFolder {
  fs::path path = fs::temp_directory_path() / ("tectum_wiring_" + std::to_string(getpid()));
  TestFolder() { fs::create_directories(path); }
  ~TestFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

}  // namespace

// Needs the diagram of the larva's brain, which lies beside the checkout and is no part of it.
TEST_CASE("the wiring diagram of a larva's brain is imported and carries activity to the descending cells" *
          doctest::skip(!fs::exists(laser_dot_folder() + "/larva_edges.csv"))) {
  const TestFolder folder;
  const std::string circuit = (folder.path / "larva.json").string();
  std::ostringstream out, err;
  const int status = tectum_main({"import", "edges", laser_dot_folder() + "/larva_edges.csv", "--cells",
                                  laser_dot_folder() + "/larva_cells.csv", "--drive", "sensories=50", "-o", circuit},
                                 out, err);
  REQUIRE_MESSAGE(status == kExitOk, err.str());
  CHECK(out.str().find("3013 cells in 36 populations, 111243 connections") != std::string::npos);

  ReadSource source = read_source(circuit);
  REQUIRE(source.ok);
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit(std::move(source.file), {}, diagnostics);
  REQUIRE_MESSAGE(result.image.has_value(), render_text(diagnostics, result.sources));
  LoadedImage loaded = load_image(write_image(*result.image));
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  const SpikeImage& image = *loaded.image;
  SpikeEngine engine(image);
  std::map<std::string, std::uint64_t> spikes;
  constexpr int kTicks = 3000;  // 0.3 s
  for (int t = 0; t < kTicks; ++t) {
    engine.step();
    for (const NeuronId id : engine.spikes()) {
      for (const PopulationRecord& population : image.populations) {
        const auto neuron = static_cast<std::uint32_t>(id);
        if (neuron >= population.first_neuron && neuron < population.first_neuron + population.size) {
          ++spikes[std::string(image.name(population.name))];
        }
      }
    }
  }
  for (const char* descending : {"dVNCs_L", "dVNCs_R", "dSEZs_L", "dSEZs_R"}) {
    CAPTURE(descending);
    CHECK(spikes[descending] > 0);
  }
}
