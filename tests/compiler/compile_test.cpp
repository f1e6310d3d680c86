// The whole pipeline on small circuits: what compiles must load, and what is wrong must say so.
#include "compiler/compile.h"

#include <doctest/doctest.h>

#include <string>

#include "compiler/diagnostics/render.h"
#include "runtime/image/load_image.h"

namespace tectum {
namespace {

const char* const kVerticalGaze = R"json({
  "tectum": 1, "name": "vertical_gaze", "tick": "0.1 ms", "seed": 7,
  "references": { "scudder1988": { "doi": "10.1152/jn.1988.59.5.1455", "title": "Local feedback" } },
  "parameters": { "g_sc": "0.9 nA", "tau_burst": { "value": "5 ms", "range": ["2 ms", "20 ms"] } },
  "axes": { "vertical": ["up", "down"] },
  "neurons": {
    "burst": { "model": "lif_exp", "tau_m": "tau_burst", "t_ref": "1 ms" },
    "tonic": { "extends": "burst", "tau_syn_ex": "100 ms" }
  },
  "populations": {
    "SC":   { "input": "left_eye", "rate": "200 Hz" },
    "LLBN": { "neuron": "burst", "size": 10, "axis": "vertical", "nucleus": "riMLF" },
    "EBN":  { "neuron": "burst", "size": 10, "axis": "vertical", "I_bias": "0.1 nA + 0.3 nA * index / size" },
    "IFN":  { "neuron": "burst", "size": 10, "axis": "vertical" },
    "TN":   { "neuron": "tonic", "size": 10, "axis": "vertical" },
    "MN":   { "neuron": "burst", "size": 10, "axis": "vertical" }
  },
  "projections": {
    "sc_llbn":  { "from": "SC", "to": "LLBN", "where": "hemifield == side", "rule": "all_to_all",
                  "weight": "g_sc * ln(1 + ecc / 12 deg)", "delay": "1 ms" },
    "llbn_ebn": { "from": "LLBN", "to": "EBN", "rule": "one_to_one", "weight": "1.1 nA", "delay": "4 ms", "cite": ["scudder1988"] },
    "ebn_ifn":  { "from": "EBN", "to": ["IFN", "TN"], "rule": "one_to_one", "weight": "2 nA", "delay": "0 ms" },
    "ifn_llbn": { "from": "IFN", "to": "LLBN", "rule": "all_to_all", "sign": "inhibitory", "weight": "0.4 nA", "delay": "1 ms" },
    "cross":    { "from": "EBN", "to": "EBN", "side": "contra", "rule": { "kind": "fixed_probability", "p": 0.5 },
                  "sign": "inhibitory", "weight": "0.5 nA", "delay": "1 ms" },
    "tn_mn":    { "from": "TN", "to": "MN", "rule": "one_to_one", "weight": "2 nA", "delay": "1 ms" }
  },
  "inputs":  { "left_eye": { "retina": { "eye": "left", "frame": [720, 720], "field_of_view": "60 deg",
     "rings": [ {"outer": 360, "fields_per_side": 5}, {"outer": 216, "fields_per_side": 4}, {"outer": 108, "block": [8, 8]} ],
     "lit": { "channel": "green - max(red, blue)", "above": 20 }, "fires_when": "lit >= 5 %" } } },
  "outputs": { "eyes_tilt": { "rate_difference": ["MN.up", "MN.down"], "window": "20 ms", "gain": "0.02 deg/Hz",
                              "joints": ["left_eye_tilt", "right_eye_tilt"], "limits": ["-35 deg", "35 deg"] } }
})json";

std::string errors_of(const CompileResult& result, const Diagnostics& diagnostics) {
  return render_text(diagnostics, result.sources);
}

TEST_CASE("the circuit of the language page compiles to an image that loads") {
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit({"gaze.json", kVerticalGaze}, {}, diagnostics);
  INFO(errors_of(result, diagnostics));
  REQUIRE(result.image);
  const LoadedImage loaded = load_image(write_image(*result.image));
  INFO(loaded.error);
  REQUIRE(loaded.image);
  CHECK(loaded.image->find_population("EBN.up").has_value());
  CHECK(loaded.image->fields.size() == 16 + 12 + 64);
}

TEST_CASE("the same file gives the same bytes") {
  Diagnostics diagnostics;
  const CompileResult a = compile_circuit({"gaze.json", kVerticalGaze}, {}, diagnostics);
  const CompileResult b = compile_circuit({"gaze.json", kVerticalGaze}, {}, diagnostics);
  REQUIRE(a.image);
  REQUIRE(b.image);
  CHECK(write_image(*a.image) == write_image(*b.image));
}

}  // namespace
}  // namespace tectum
