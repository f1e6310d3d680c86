// Every kind of edit is found and named, and nothing else is.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/diff/edited_circuit.h"

using namespace tectum;

namespace {

const std::string kSmall = R"({
  "tectum": 1, "name": "small", "tick": "0.5 ms", "seed": 3,
  "axes": {"horizontal": ["left", "right"]},
  "parameters": {"g": {"value": "0.4 nA"}, "twice": {"value": "2 * g"}},
  "neurons": {
    "cell": {"model": "lif_exp", "tau_m": "10 ms", "E_L": "-70 mV", "V_th": "-55 mV", "V_reset": "-70 mV",
             "t_ref": "1 ms", "R_m": "10 MOhm", "receptors": {"ex": {"tau": "2 ms"}, "in": {"tau": "3 ms"}}}
  },
  "populations": {
    "drive": {"neuron": "cell", "size": 4, "axis": "horizontal", "I_bias": "1.8 nA"},
    "relay": {"neuron": "cell", "size": 3, "axis": "horizontal"},
    "motor": {"neuron": "cell", "size": 2, "axis": "horizontal", "I_bias": "1.6 nA"}
  },
  "projections": {
    "drive_relay": {"from": "drive", "to": "relay", "rule": "all_to_all", "weight": "twice", "delay": "1 ms"},
    "relay_motor": {"from": "relay", "to": "motor", "rule": "all_to_all", "weight": "0.3 nA", "delay": "2 ms"},
    "cross": {"from": "motor", "to": "relay", "rule": "all_to_all", "side": "contra", "sign": "inhibitory", "weight": "0.1 nA", "delay": "1.5 ms"}
  },
  "outputs": {
    "pan": {"terms": [{"population": "motor.right", "gain": "0.2 deg/Hz"}, {"population": "motor.left", "gain": "-0.1 deg/Hz"}], "window": "20 ms", "joints": ["left_eye_pan"]}
  },
  "joints": {"left_eye_pan": {"limits": ["-50 deg", "38 deg"]}}
})";

struct Edit {
  std::string what, with;
  std::string expected;  // the whole listing
};

}  // namespace

TEST_CASE("a circuit is the same as itself, however it is laid out") {
  const CircuitView circuit = compiled_view(kSmall);
  CHECK(diff_structure(circuit, compiled_view(kSmall)).is_same());
  const std::string moved = edited(edited(kSmall, "\"I_bias\": \"1.6 nA\"", "\"I_bias\": \"1600 pA\""),
                                   "\"weight\": \"0.3 nA\"", "\"weight\": \"0.1 nA + 0.2 nA\"");
  CHECK(structure_text(diff_structure(circuit, compiled_view(moved))).empty());
}

TEST_CASE("each single edit is named, with what it was and what it is") {
  const CircuitView circuit = compiled_view(kSmall);
  const std::vector<Edit> edits = {
      {"\"0.3 nA\"", "\"0.15 nA\"",
       "projection relay_motor, relay -> motor: weight 0.15 nA instead of 0.3 nA (6 of 6 synapses) [left, right]  "
       "(circuit.json:16)\n"},
      {"\"0.4 nA\"", "\"0.2 nA\"",
       "parameter g: value 0.2 nA instead of 0.4 nA  (circuit.json:4)\n"
       "projection drive_relay, drive -> relay: weight 0.4 nA instead of 0.8 nA (12 of 12 synapses) [left, right], "
       "because g is 0.2 nA instead of 0.4 nA  (circuit.json:15)\n"},
      {"\"2 ms\"}, \"in\"", "\"4 ms\"}, \"in\"", ""},
      {"\"delay\": \"2 ms\"", "\"delay\": \"2.5 ms\"",
       "projection relay_motor, relay -> motor: delay 2.5 ms instead of 2 ms (6 of 6 synapses) [left, right]  "
       "(circuit.json:16)\n"},
      {"\"seed\": 3", "\"seed\": 4", "circuit circuit: seed 4 instead of 3\n"},
      {"\"0.2 deg/Hz\"", "\"0.3 deg/Hz\"", "output pan: gain of motor.right 0.3 deg/Hz instead of 0.2 deg/Hz\n"},
      {"\"20 ms\"", "\"22 ms\"", "output pan: window 22 ms instead of 20 ms\n"},
      {"\"38 deg\"", "\"30 deg\"", "joint left_eye_pan: limits -50 to 30 deg instead of -50 to 38 deg\n"},
      {"\"1.8 nA\"", "\"1.9 nA\"", "population drive: I_bias 1.9 nA instead of 1.8 nA [left, right]\n"},
  };
  for (const Edit& edit : edits) {
    CAPTURE(edit.what);
    const StructureDiff diff = diff_structure(circuit, compiled_view(edited(kSmall, edit.what, edit.with)));
    CHECK_FALSE(diff.is_same());
    if (!edit.expected.empty()) {
      CHECK(structure_text(diff) == edit.expected);
    }
  }
}

TEST_CASE("a size, a sign, a receptor, a side and a lesion are told apart") {
  const CircuitView circuit = compiled_view(kSmall);
  const auto listed = [&](const std::string& what, const std::string& with) {
    return structure_text(diff_structure(circuit, compiled_view(edited(kSmall, what, with))));
  };
  const auto contains = [](const std::string& text, const std::string& part) {
    CAPTURE(text);
    CAPTURE(part);
    CHECK(text.find(part) != std::string::npos);
  };
  contains(listed("\"size\": 4", "\"size\": 5"), "population drive: size 5 instead of 4 [left, right]\n");
  contains(listed("\"size\": 4", "\"size\": 5"), "synapses 15 instead of 12");
  contains(listed("\"sign\": \"inhibitory\", ", ""), "receptor ex instead of in");
  contains(listed("\"side\": \"contra\", ", ""),
           "projection cross, motor -> relay: only in the second (6 synapses) [left, right]");
  contains(listed("\"side\": \"contra\", ", ""), "[left to right, right to left]");
  contains(
      listed("\"joints\": {\"left", "\"lesions\": {\"gone\": {\"remove\": [\"relay.left\"]}}, \"joints\": {\"left"),
      "population relay: silenced neurons 3 instead of 0 [left]\n");
  contains(listed("\"tau\": \"3 ms\"", "\"tau\": \"5 ms\""),
           "population relay: receptor in tau 5 ms instead of tau 3 ms [left, right]\n");
}

TEST_CASE("a population that is only called something else is a renaming and nothing more") {
  std::string renamed = kSmall;
  for (std::size_t at = 0; (at = renamed.find("\"relay", at)) != std::string::npos; at += 2) {
    if (renamed.compare(at, 7, "\"relay\"") == 0) {
      renamed.replace(at, 7, "\"interneuron\"");
    }
  }
  const StructureDiff diff = diff_structure(compiled_view(kSmall), compiled_view(renamed));
  CHECK(structure_text(diff) == "population interneuron: was called relay [left, right]\n");
}

TEST_CASE("images are compared by pathway, without knowing projections") {
  const auto bare = [](const std::string& text) {
    CircuitView view = compiled_view(text);
    forget_projections(view);
    return view;
  };
  CHECK(diff_structure(bare(kSmall), bare(kSmall)).is_same());
  const std::string listing =
      structure_text(diff_structure(bare(kSmall), bare(edited(kSmall, "\"0.3 nA\"", "\"0.15 nA\""))));
  CHECK(listing ==
        "projection relay_motor, relay -> motor: weight 0.15 nA instead of 0.3 nA (6 of 6 synapses) [left, right]\n");
}

TEST_CASE("one weight of the shipped circuit, halved, is named with its parameter") {
  const std::string text = oculomotor_text();
  const CircuitView circuit = compiled_view(text);
  const std::string half = edited(text, "\"0.01884 nA\"", "\"0.00942 nA\"");
  const StructureDiff diff = diff_structure(circuit, compiled_view(half));
  REQUIRE_FALSE(diff.changes.empty());
  CHECK(diff.changes.front().name == "w_ifn_llbn");
  for (const Change& change : diff.changes) {
    CAPTURE(change.name);
    const bool is_named =
        change.name == "w_ifn_llbn" || change.because == "w_ifn_llbn is 0.00942 nA instead of 0.01884 nA";
    CHECK(is_named);
  }
}
