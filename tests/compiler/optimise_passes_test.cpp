// Each optimisation pass: what it takes, what it leaves, and that nothing of it can be seen in a raster.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "compiler/lower/worst_case.h"
#include "compiler/optimise/optimise.h"
#include "runtime/engine/spike_engine.h"
#include "tests/compiler/compiled_text.h"
#include "tests/support/test_network.h"

namespace tectum::test {
namespace {

constexpr std::uint64_t kTicks = 10000;  // 1 s

/// A chain that nothing drives beside one that is driven, and back from it.
const char* const kMute = R"json({
  "tectum": 1, "name": "mute", "tick": "0.1 ms",
  "neurons": { "n": { "model": "lif_exp" }, "t": { "model": "threshold", "theta": 1, "receptors": { "ex": { "kind": "instantaneous" } } },
               "off": { "model": "poisson", "rate": "0 Hz" } },
  "populations": {
    "driven": { "neuron": "n", "size": 3, "I_bias": "2.5 nA" }, "heard": { "neuron": "n", "size": 3 },
    "idle": { "neuron": "n", "size": 3 }, "behind": { "neuron": "n", "size": 2 }, "off": { "neuron": "off", "size": 2 },
    "half": { "neuron": "n", "size": 2, "I_bias": "2.5 nA * index" }
  },
  "projections": {
    "heard":  { "from": "driven", "to": "heard", "rule": "one_to_one", "weight": "9 nA", "delay": "1 ms" },
    "behind": { "from": "idle", "to": "behind", "rule": "all_to_all", "weight": "9 nA", "delay": "1 ms" },
    "back":   { "from": "behind", "to": "heard", "rule": "all_to_all", "weight": "9 nA", "delay": "1 ms" },
    "off":    { "from": "off", "to": "heard", "rule": "all_to_all", "weight": "9 nA", "delay": "1 ms" },
    "half":   { "from": "half", "to": "heard", "rule": "all_to_all", "weight": "1 nA", "delay": "1 ms" }
  }
})json";

CompileOptions at_level(OptimisationLevel level) {
  CompileOptions options;
  options.level = level;
  return options;
}

std::size_t shared_rows(const ImageContents& image) {
  return static_cast<std::size_t>(
      std::count_if(image.segments.begin(), image.segments.end(),
                    [](const SegmentRecord& segment) { return (segment.flags & kSegmentOneWeight) != 0; }));
}

}  // namespace

TEST_CASE("neurons that can never fire lose their synapses at -O2, and only they") {
  const ImageContents plain = compile_text(kMute, at_level(OptimisationLevel::O1));
  const ImageContents optimised = compile_text(kMute);
  CHECK(plain.targets.size() == 3 + 6 + 6 + 6 + 6);
  CHECK(optimised.targets.size() == 3 + 3);  // heard, and the second neuron of half
  CHECK(optimised.neuron_count == plain.neuron_count);
  const Raster raster = run_image(image_of(plain), kTicks);
  CHECK(raster.size() > 100);
  CHECK(run_image(image_of(optimised), kTicks) == raster);
}

TEST_CASE("what a neuron that can never fire is given by a driven one makes it count as able to fire") {
  std::string text = kMute;
  const std::string to = R"("from": "driven", "to": "heard")";
  text.replace(text.find(to), to.size(), R"("from": "driven", "to": "idle")");
  CHECK(compile_text(text).targets.size() == 3 + 6 + 6 + 3);
}

TEST_CASE("an edge list that names a pair several times becomes one synapse a pair, with the summed weight") {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "tectum_optimise_passes_edges.csv";
  std::ofstream(path) << "pre,post,w\n2,1,1\n0,1,2\n2,1,4\n0,1,0.5\n1,1,1\n0,2,1\n";
  const std::string text = fmt::format(R"json({{
    "tectum": 1, "name": "twice", "tick": "0.1 ms",
    "neurons": {{ "n": {{ "model": "lif_exp" }} }},
    "populations": {{ "A": {{ "neuron": "n", "size": 3, "I_bias": "3 nA" }}, "B": {{ "neuron": "n", "size": 3 }} }},
    "projections": {{ "ab": {{ "from": "A", "to": "B", "delay": "1 ms", "weight": "edge.w * 3 nA",
      "rule": {{ "kind": "edges", "file": "{}", "columns": {{ "w": "w" }} }} }} }}
  }})json",
                                       path.string());
  const ImageContents merged = compile_text(text);
  const ImageContents plain = compile_text(text, at_level(OptimisationLevel::O0));
  std::filesystem::remove(path);
  CHECK(plain.targets.size() == 6);
  CHECK(merged.targets.size() == 4);
  const Raster raster = run_image(image_of(plain), kTicks);
  CHECK(raster.size() > 100);
  CHECK(run_image(image_of(merged), kTicks) == raster);
}

TEST_CASE("a row of one weight stores it once from -O1 on") {
  const ImageContents plain = compile_text(kMute, at_level(OptimisationLevel::O0));
  const ImageContents shared = compile_text(kMute, at_level(OptimisationLevel::O1));
  CHECK(shared_rows(plain) == 0);
  CHECK(plain.weights.size() == plain.targets.size());
  CHECK(shared_rows(shared) == shared.segments.size() - 1);
  CHECK(shared.weights.size() < plain.weights.size());
  CHECK(run_image(image_of(plain), kTicks) == run_image(image_of(shared), kTicks));
}

TEST_CASE("renumbering moves populations in memory and leaves neurons, draws and rasters as they are") {
  // a1 and b1 drive b2 and a2: what belongs together is written far apart. The sources fire by chance.
  const char* const text = R"json({
    "tectum": 1, "name": "far", "tick": "0.1 ms", "seed": 5,
    "neurons": { "n": { "model": "lif_exp" }, "p": { "model": "poisson", "rate": "80 Hz" } },
    "populations": {
      "a1": { "neuron": "p", "size": 20 }, "b1": { "neuron": "p", "size": 20 },
      "b2": { "neuron": "n", "size": 20 }, "a2": { "neuron": "n", "size": 20 }
    },
    "projections": {
      "a": { "from": "a1", "to": "a2", "rule": { "kind": "fixed_probability", "p": 0.5 }, "weight": "random * 4 nA", "delay": "1 ms" },
      "b": { "from": "b1", "to": "b2", "rule": { "kind": "fixed_probability", "p": 0.5 }, "weight": "random * 4 nA", "delay": "0 ms" }
    }
  })json";
  const ImageContents plain = compile_text(text, at_level(OptimisationLevel::O1));
  const ImageContents moved = compile_text(text);
  const auto order = [](const ImageContents& image) {
    std::vector<std::uint32_t> populations;
    for (const GroupRecord& group : image.groups) {
      populations.push_back(group.population);
    }
    return populations;
  };
  CHECK(order(plain) == std::vector<std::uint32_t>{0, 1, 2, 3});
  CHECK(order(moved) == std::vector<std::uint32_t>{0, 3, 1, 2});
  const Raster raster = run_image(image_of(plain), kTicks);
  CHECK(raster.size() > 500);
  CHECK(run_image(image_of(moved), kTicks) == raster);
}

TEST_CASE("the worst tick counts every synapse whose delays a refractory neuron can make meet") {
  // Three delays, 1, 1.5 and 3.1 ms; the source is silent for 2 ms after a spike, so 1 and 3.1 ms can meet.
  const std::string text = R"json({
    "tectum": 1, "name": "worst", "tick": "0.1 ms",
    "neurons": { "n": { "model": "lif_exp", "t_ref": "2 ms" } },
    "populations": { "A": { "neuron": "n", "size": 1, "I_bias": "3 nA" }, "B": { "neuron": "n", "size": 4 }, "C": { "neuron": "n", "size": 5 } },
    "projections": {
      "b": { "from": "A", "to": "B", "rule": "all_to_all", "weight": "1 nA", "delay": "1 ms" },
      "c": { "from": "A", "to": "C", "rule": "all_to_all", "weight": "1 nA", "delay": "1.5 ms" },
      "d": { "from": "A", "to": "C", "rule": "all_to_all", "weight": "1 nA", "delay": "3.1 ms", "where": "post.index < 2" }
    }
  })json";
  const WorstCase worst = worst_case(compile_text(text));
  CHECK(worst.synaptic_events == 4 + 2);
  CHECK(worst.longest_row == 11);
  std::string tireless = text;
  tireless.replace(tireless.find("2 ms"), 4, "0 ms");
  CHECK(worst_case(compile_text(tireless)).synaptic_events == 11);
}

TEST_CASE("no tick of a run has more synaptic events than the worst case says") {
  const ImageContents contents = compile_text(kMute);
  SpikeEngine engine(image_of(contents));
  std::uint64_t before = 0;
  std::uint64_t most = 0;
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
    engine.step();
    most = std::max(most, engine.counters().synaptic_events - before);
    before = engine.counters().synaptic_events;
  }
  CHECK(most > 0);
  CHECK(most <= worst_case(contents).synaptic_events);
}

}  // namespace tectum::test
