// The mirror verdict where the two sides are populations of their own.
#include "compiler/elaborate/symmetry.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string>
#include <vector>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"
#include "compiler/elaborate/mirror_partner.h"

namespace tectum {
namespace {

std::vector<SymmetryVerdict> verdicts_of(const std::string& text) {
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit({"circuit.json", text}, {}, diagnostics);
  REQUIRE_MESSAGE(result.network.has_value(), render_text(diagnostics, result.sources));
  return mirror_symmetry(*result.circuit, *result.network);
}

const char* const kRings = R"("rings": [ { "outer": 360, "fields_per_side": 4 }, { "outer": 180, "block": [4, 4] } ])";

/// Two eyes, each with a sheet of receptive fields, wired to two motor populations.
std::string two_eyes(const std::string& right_weight, const std::string& left_weight = "1 nA",
                     const std::string& fields = kRings) {
  const auto retina = [&](const char* eye) {
    return fmt::format(R"j({{ "retina": {{ "eye": "{}", "frame": [720, 720], "field_of_view": "60 deg", {},
      "lit": {{ "channel": "luma", "above": 20 }}, "fires_when": "lit >= 5 %" }} }})j",
                       eye, fields);
  };
  return fmt::format(R"j({{ "tectum": 1, "name": "eyes",
    "neurons": {{ "n": {{ "model": "lif_exp" }} }},
    "populations": {{
      "SC_left": {{ "input": "left_eye", "rate": "200 Hz" }}, "SC_right": {{ "input": "right_eye", "rate": "200 Hz" }},
      "MN_left": {{ "neuron": "n", "size": 2 }}, "MN_right": {{ "neuron": "n", "size": 2 }}
    }},
    "projections": {{
      "l": {{ "from": "SC_left", "to": "MN_left", "rule": "all_to_all", "where": "x < 0 deg", "weight": "{}", "delay": "1 ms" }},
      "r": {{ "from": "SC_right", "to": "MN_right", "rule": "all_to_all", "where": "x > 0 deg", "weight": "{}", "delay": "1 ms" }}
    }},
    "inputs": {{ "left_eye": {}, "right_eye": {} }} }})j",
                     left_weight, right_weight, retina("left"), retina("right"));
}

}  // namespace

TEST_CASE("names are mirrored word by word") {
  const std::pair<std::string, std::string> sides("left", "right");
  CHECK(swap_side_words("SC_left", sides) == "SC_right");
  CHECK(swap_side_words("gen.right-eye", sides) == "gen.left-eye");
  CHECK(swap_side_words("MN_L_2", sides) == "MN_R_2");
  CHECK(swap_side_words("leftover_LR", sides) == "leftover_LR");
  CHECK(swap_side_words("MN_up", {"up", "down"}) == "MN_down");
  CHECK(swap_side_words("MN_L", {"up", "down"}) == "MN_L");
}

TEST_CASE("two eyes with names of their own are each other's mirror image, field by field") {
  const auto verdicts = verdicts_of(two_eyes("1 nA"));
  REQUIRE(verdicts.size() == 1);
  CHECK(verdicts[0].sides == "left/right");
  CHECK(verdicts[0].axes.empty());
  CHECK(verdicts[0].is_symmetric());
}

TEST_CASE("fields between pixels, and weights that go by their places, mirror each other all the same") {
  const std::string foveated = R"("foveated": { "outer": 360, "inner": 15, "fields_per_side": 14, "fovea_px": 3 })";
  const std::string outward = "1 nA * abs(x) / 10 deg";
  CHECK(verdicts_of(two_eyes(outward, outward, foveated)).at(0).is_symmetric());
  CHECK(!verdicts_of(two_eyes("1.001 nA * abs(x) / 10 deg", outward, foveated)).at(0).is_symmetric());
}

TEST_CASE("a weight that one eye alone has breaks the mirror, and the projections of both eyes are named") {
  const auto verdicts = verdicts_of(two_eyes("1.5 nA"));
  REQUIRE(verdicts.size() == 1);
  CHECK(verdicts[0].broken_by == std::vector<std::string>{"projection l", "projection r"});
  CHECK(verdicts[0].unmatched_synapses > 0);
}

TEST_CASE("a name on one side and an axis are mirrored together") {
  const std::string text = R"j({ "tectum": 1, "name": "both", "axes": { "h": ["left", "right"] },
    "neurons": { "n": { "model": "lif_exp" } },
    "populations": { "eye_left": { "neuron": "n", "size": 2, "axis": "h", "I_bias": "3 nA" },
                     "eye_right": { "neuron": "n", "size": 2, "axis": "h", "I_bias": "3 nA" }, "M": { "neuron": "n", "size": 2 } },
    "projections": {
      "nasal":    { "from": ["eye_left.right", "eye_right.left"], "to": "M", "rule": "one_to_one", "weight": "1 nA", "delay": "1 ms" },
      "temporal": { "from": ["eye_left.left"], "to": "M", "rule": "one_to_one", "weight": "2 nA", "delay": "1 ms" }
    } })j";
  const auto verdicts = verdicts_of(text);
  REQUIRE(verdicts.size() == 1);
  CHECK(verdicts[0].broken_by == std::vector<std::string>{"projection temporal"});
  CHECK(verdicts[0].unmatched_synapses == 2);
}

}  // namespace tectum
