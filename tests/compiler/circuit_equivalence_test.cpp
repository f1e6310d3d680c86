// One network, said in several ways: what is said differently must not run differently.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/compiler/compiled_text.h"
#include "tests/support/test_network.h"

namespace tectum::test {
namespace {

constexpr std::uint64_t kTicks = 5000;  // 0.5 s at 0.1 ms

/// Two burst generators with cross inhibition, by an axis and a module.
const char* const kShort = R"json({
  "tectum": 1, "name": "short", "tick": "0.1 ms",
  "axes": { "h": ["left", "right"] },
  "parameters": { "g": "1.25 nA" },
  "neurons": { "burst": { "model": "lif_exp", "tau_m": "5 ms", "t_ref": "1 ms" } },
  "populations": { "IN": { "neuron": "burst", "size": 4, "axis": "h", "I_bias": "2.5 nA + 0.25 nA * index",
                           "exceptions": { "right": { "I_bias": "2.25 nA + 0.25 nA * index" } } } },
  "modules": { "generator": {
    "ports": ["drive"], "parameters": { "gain": "1" },
    "populations": { "EBN": { "neuron": "burst", "size": 4, "axis": "h" }, "IFN": { "neuron": "burst", "size": 2, "axis": "h" } },
    "projections": {
      "in":    { "from": "drive", "to": "EBN", "rule": "all_to_all", "weight": "gain * g * (1 + pre.index / 4)", "delay": "1 ms" },
      "ifn":   { "from": "EBN", "to": "IFN", "rule": "all_to_all", "weight": "2 nA", "delay": "0.5 ms" },
      "back":  { "from": "IFN", "to": "EBN", "rule": "all_to_all", "sign": "inhibitory", "weight": "0.5 nA", "delay": "1 ms" },
      "cross": { "from": "EBN", "to": "EBN", "side": "contra", "rule": "one_to_one", "sign": "inhibitory", "weight": "gain * 1 nA", "delay": "2 ms" }
    } } },
  "instances": {
    "one": { "module": "generator", "ports": { "drive": "IN" } },
    "two": { "module": "generator", "ports": { "drive": "IN" }, "parameters": { "gain": 2 } }
  }
})json";

/// The same, name by name.
std::string written_out() {
  std::string populations = R"j("IN_right": { "neuron": "burst", "size": 4, "I_bias": "2.25 nA + 0.25 nA * index" },
    "IN_left": { "neuron": "burst", "size": 4, "I_bias": "2.5 nA + 0.25 nA * index" })j";
  std::string projections;
  for (const std::string name : {"two", "one"}) {
    for (const std::string side : {"left", "right"}) {
      const std::string other = side == "left" ? "right" : "left";
      populations += fmt::format(R"j(, "{0}_IFN_{1}": {{ "neuron": "burst", "size": 2 }},
        "{0}_EBN_{1}": {{ "neuron": "burst", "size": 4 }})j",
                                 name, side);
      projections += projections.empty() ? "" : ", ";
      projections += fmt::format(
          R"j("in_{0}_{1}": {{ "from": "IN_{1}", "to": "{0}_EBN_{1}", "rule": "all_to_all",
                "weight": "{3} * 1.25 nA * (1 + pre.index / 4)", "delay": "1 ms" }},
              "ifn_{0}_{1}": {{ "from": "{0}_EBN_{1}", "to": "{0}_IFN_{1}", "rule": "all_to_all", "weight": "2 nA",
                "delay": "0.5 ms" }},
              "back_{0}_{1}": {{ "from": "{0}_IFN_{1}", "to": "{0}_EBN_{1}", "rule": "all_to_all", "sign": "inhibitory",
                "weight": "0.5 nA", "delay": "1 ms" }},
              "cross_{0}_{1}": {{ "from": "{0}_EBN_{1}", "to": "{0}_EBN_{2}", "rule": "one_to_one", "sign": "inhibitory",
                "weight": "{3} * 1 nA", "delay": "2 ms" }})j",
          name, side, other, name == "two" ? 2 : 1);
    }
  }
  return fmt::format(R"j({{ "tectum": 1, "name": "long", "tick": "0.1 ms",
    "neurons": {{ "burst": {{ "model": "lif_exp", "tau_m": "5 ms", "t_ref": "1 ms" }} }},
    "populations": {{ {} }}, "projections": {{ {} }} }})j",
                     populations, projections);
}

/// Parallel synapses, weights of zero, draws by chance, same-tick connections: work for every pass.
const char* const kWork = R"json({
  "tectum": 1, "name": "work", "tick": "0.1 ms", "seed": 3,
  "neurons": { "n": { "model": "lif_exp" }, "z": { "model": "izhikevich" } },
  "populations": {
    "A": { "neuron": "n", "size": 40, "I_bias": "2.2 nA + 0.02 nA * index" },
    "B": { "neuron": "n", "size": 40 }, "C": { "neuron": "z", "size": 30, "I_bias": 4 }
  },
  "projections": {
    "ab":  { "from": "A", "to": "B", "rule": { "kind": "fixed_probability", "p": 0.3 }, "weight": "3 nA", "delay": "1 ms" },
    "ab2": { "from": "A", "to": "B", "rule": { "kind": "fixed_probability", "p": 0.3 }, "weight": "1 nA", "delay": "1 ms" },
    "none":{ "from": "A", "to": "C", "rule": "all_to_all", "weight": "0 mV/ms", "delay": "1 ms" },
    "bc":  { "from": "B", "to": "C", "rule": "all_to_all", "weight": "0.25 mV/ms", "delay": "0 ms" },
    "cb":  { "from": "C", "to": "B", "rule": { "kind": "fixed_in_degree", "n": 5 }, "sign": "inhibitory", "weight": "1 nA", "delay": "0.5 ms + 0.1 ms * pre.index" }
  }
})json";

}  // namespace

TEST_CASE("a circuit with axes and modules runs as the same circuit written out in full") {
  const NamedRaster raster = named_raster(compile_text(kShort), kTicks);
  CHECK(raster.size() > 500);
  CHECK(named_raster(compile_text(written_out()), kTicks) == raster);
}

TEST_CASE("optimisation and thread count leave the raster as it is, and the same twice is the same bytes") {
  CompileOptions unoptimised;
  unoptimised.level = OptimisationLevel::O0;
  const ImageContents plain = compile_text(kWork, unoptimised);
  const ImageContents optimised = compile_text(kWork);
  CHECK(optimised.targets.size() < plain.targets.size());
  const Raster raster = run_image(image_of(plain), kTicks);
  CHECK(raster.size() > 1000);
  for (const ImageContents* contents : {&plain, &optimised}) {
    for (const unsigned threads : {1U, 2U}) {
      EngineOptions options;
      options.threads = threads;
      CHECK(run_image(image_of(*contents), kTicks, options) == raster);
    }
  }
  CHECK(write_image(compile_text(kWork)) == write_image(optimised));
  CHECK(write_image(compile_text(kWork, unoptimised)) == write_image(plain));
}

TEST_CASE("a lesion overlay of five lines over the shipped circuit is the image that --lesion makes") {
  const std::string folder = std::string(TECTUM_SOURCE_DIR) + "/circuits/";
  const std::string overlay = R"j({
    "tectum": 1,
    "extends": "oculomotor.json",
    "lesions": { "no_pause": { "remove": "OPN" } }
  })j";
  const auto image = [](SourceFile file, const CompileOptions& options) {
    Diagnostics diagnostics;
    const CompileResult result = compile_circuit(std::move(file), options, diagnostics);
    REQUIRE(result.image.has_value());
    return write_image(*result.image);
  };
  ReadSource whole = read_source(folder + "oculomotor.json");
  REQUIRE(whole.ok);
  CompileOptions lesioned;
  lesioned.lesions = {"OPN"};
  const auto by_overlay = image({folder + "no_pause.json", overlay}, {});
  CHECK(image(whole.file, lesioned) == by_overlay);
  CHECK(image(whole.file, {}) != by_overlay);
}

}  // namespace tectum::test
