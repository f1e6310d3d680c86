// Each edit is found, and the first thing that differs is put down to it.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/diff/edited_circuit.h"
#include "tools/analysis/simulated_run.h"
#include "tools/diff/battery.h"
#include "tools/diff/divergence.h"
#include "tools/diff/open_loop_run.h"

using namespace tectum;

namespace {

struct World {
  Recording recording;
  LitNeurons lit_b;
};

/// The first circuit's own run, and what the second one's retina makes of it.
World run_first(const CircuitView& a, const CircuitView& b, double duration_s) {
  Battery battery = make_battery({}, 1);
  battery.head.scenario.path = {{0, {0.06, 0.03}}};  // not straight ahead: the periphery is lit
  SimulatedRunOptions options = battery_options(a.image, battery);
  options.duration_s = duration_s;
  PictureTap tap(a.image, b.image);
  RunObserver observer;
  std::size_t frame = 0;
  observer.pictures = [&](const Frame& left, const Frame& right) { tap.see(frame, left, right); };
  observer.progress = [&](double) { ++frame; };
  World world;
  world.recording = run_simulated_head(a.image, options, observer);
  world.lit_b = tap.lit_neurons(world.recording);
  return world;
}

struct Found {
  StructureDiff structure;
  Divergence divergence;
};

Found diverge(const CircuitView& a, const CircuitView& b, double duration_s = 0.3) {
  Found found;
  found.structure = diff_structure(a, b);
  const World world = run_first(a, b, duration_s);
  OpenLoopRun driven(b.image, world.recording, world.lit_b);
  found.divergence = find_divergence({a, b, found.structure, world.recording, driven.recording(),
                                      [&](std::size_t frame) { driven.run_frame(frame); }});
  return found;
}

struct Edit {
  std::string what, with;
  LinkKind kind;
  std::string element, name, property;  // of the change that the first difference must be put down to
  std::string where;                    // population or joint of the first difference; empty: any
};

void check_edits(const std::string& text, const std::vector<Edit>& edits, double duration_s) {
  const CircuitView circuit = compiled_view(text);
  for (const Edit& edit : edits) {
    CAPTURE(edit.what);
    const Found found = diverge(circuit, compiled_view(edited(text, edit.what, edit.with)), duration_s);
    const std::string shown = structure_text(found.structure) + divergence_text(found.divergence);
    CAPTURE(shown);
    REQUIRE_FALSE(found.divergence.links.empty());
    const DivergenceLink& first = found.divergence.links.front();
    CHECK(first.kind == edit.kind);
    CHECK(first.from.empty());
    CHECK_FALSE(first.why.empty());
    REQUIRE_FALSE(first.changes.empty());
    const Change& change = found.structure.changes[first.changes.front()];
    CHECK(element_name(change.element) == edit.element);
    CHECK(sided_name(change.name).base == edit.name);
    CHECK(change.property == edit.property);
    if (!edit.where.empty()) {
      CHECK(sided_name(first.population.empty() ? first.what : first.population).base == edit.where);
    }
  }
}

constexpr LinkKind kSpike = LinkKind::Spike;

}  // namespace

TEST_CASE(
    "each edit of a weight, a delay, a sign, a side, a rule or a selection is what the first spike is put down to") {
  check_edits(
      small_eye_text(),
      {
          {R"("g": { "value": "0.9 nA")", R"("g": { "value": "1.3 nA")", kSpike, "projection", "seen_relay", "weight",
           "relay"},
          {R"("1.5 * g")", R"("1.2 * g")", kSpike, "projection", "relay_motor", "weight", "motor"},
          {R"("weight": "0.4 nA")", R"("weight": "0.1 nA")", kSpike, "projection", "tired_motor", "weight", "motor"},
          {R"("w_relay", "delay": "2 ms")", R"("w_relay", "delay": "2.5 ms")", kSpike, "projection", "relay_motor",
           "delay", "motor"},
          {R"("weight": "g", "delay": "1 ms")", R"("weight": "g", "delay": "3 ms")", kSpike, "projection", "seen_relay",
           "delay", "relay"},
          {R"("sign": "inhibitory", )", "", kSpike, "projection", "gate_motor", "receptor", "motor"},
          {R"("side": "contra", )", "", kSpike, "projection", "gate_motor", "", "motor"},
          {R"("p": 0.7)", R"("p": 0.3)", kSpike, "projection", "hiss_tired", "synapses", "tired"},
          {R"("pre.index >= 2")", R"("pre.index >= 5")", kSpike, "projection", "relay_gate", "synapses", "gate"},
      },
      0.3);
}

TEST_CASE("each edit of a population, a model or a receptor is what the first spike is put down to") {
  check_edits(
      small_eye_text(),
      {
          {R"("neuron": "cell", "size": 6)", R"("neuron": "cell", "size": 7)", kSpike, "population", "relay", "size",
           ""},
          {R"("neuron": "gate", "size": 3)", R"("neuron": "gate", "size": 2)", kSpike, "population", "gate", "size",
           "motor"},
          {R"("tau_m": "12 ms")", R"("tau_m": "11 ms")", kSpike, "population", "tired", "tau_m", "tired"},
          {R"("tau_w": "80 ms")", R"("tau_w": "200 ms")", kSpike, "population", "tired", "tau_w", "tired"},
          {R"("b_w": "0.05 nA")", R"("b_w": "0.1 nA")", kSpike, "population", "tired", "b_w", "tired"},
          {R"("V_th": "-55 mV")", R"("V_th": "-54.5 mV")", kSpike, "population", "relay", "V_th", "relay"},
          {R"("V_th": "-56 mV")", R"("V_th": "-55.5 mV")", kSpike, "population", "tired", "V_th", "tired"},
          {R"("theta": 2)", R"("theta": 3)", kSpike, "population", "gate", "theta", "gate"},
          {R"("t_ref": "1.5 ms")", R"("t_ref": "4 ms")", kSpike, "population", "tired", "t_ref", "tired"},
          {R"("V_reset": "-69 mV")", R"("V_reset": "-65 mV")", kSpike, "population", "tired", "V_reset", "tired"},
          {R"("V_init": "-68 mV")", R"("V_init": "-60 mV")", kSpike, "population", "relay", "V_init", "relay"},
          {R"("I_bias": "1.62 nA")", R"("I_bias": "1.66 nA")", kSpike, "population", "motor", "I_bias", "motor"},
          {R"(1.45 nA + 0.05 nA)", R"(1.45 nA + 0.06 nA)", kSpike, "population", "relay", "I_bias", "relay"},
          {R"("tau": "4 ms")", R"("tau": "8 ms")", kSpike, "population", "tired", "receptor ex", "tired"},
          {R"("window": "3 ms")", R"("window": "6 ms")", kSpike, "population", "gate", "receptor ex", "gate"},
          {R"("rate": "40 Hz")", R"("rate": "90 Hz")", kSpike, "population", "hiss", "rate", "hiss"},
          {R"("seed": 3)", R"("seed": 4)", kSpike, "circuit", "circuit", "seed", ""},
          {R"("60 ms")", R"("70 ms")", kSpike, "population", "beat", "times", "beat"},
          {R"("rate": "100 Hz")", R"("rate": "50 Hz")", kSpike, "population", "seen", "rate", "seen"},
          {R"("tick": "0.5 ms")", R"("tick": "0.25 ms")", kSpike, "circuit", "circuit", "tick", ""},
      },
      0.3);
}

TEST_CASE("edits that need no spike are found in fields and commands") {
  check_edits(small_eye_text(),
              {
                  {R"("outer": "360 px")", R"("outer": "300 px")", LinkKind::Field, "retina", "camera",
                   "number of fields", "seen"},
                  {R"(green - max(red, blue))", "luma", LinkKind::Field, "retina", "camera", "lit channel", "seen"},
                  {R"("above": 20)", R"("above": 250)", LinkKind::Field, "retina", "camera", "lit threshold", "seen"},
                  {R"("-0.05 deg/Hz")", R"("-0.06 deg/Hz")", LinkKind::Command, "output", "pan", "gain of motor.left",
                   "left_eye_pan"},
                  {R"("window": "20 ms")", R"("window": "22 ms")", LinkKind::Command, "output", "pan", "window",
                   "left_eye_pan"},
                  {R"(["-50 deg", "38 deg"])", R"(["-0.5 deg", "0.5 deg"])", LinkKind::Command, "joint", "left_eye_pan",
                   "limits", "left_eye_pan"},
              },
              0.5);
}

TEST_CASE("lesions, and a projection put in, are what the first difference is put down to") {
  const std::string text = small_eye_text();
  const std::string cells = R"("lesions": { "gone": { "remove": ["tired.left"] } }, "joints": { "left)";
  const std::string wires = R"("lesions": { "gone": { "remove": ["relay->motor"] } }, "joints": { "left)";
  check_edits(text,
              {
                  {R"("joints": { "left)", cells, kSpike, "population", "tired", "silenced neurons", "tired"},
                  {R"("joints": { "left)", wires, kSpike, "projection", "relay_motor", "", "motor"},
              },
              0.3);
  std::string more = edited(text, R"("beat": { "neuron": "beat", "size": 1 },)",
                            R"("beat": { "neuron": "beat", "size": 1 }, "extra": { "neuron": "hiss", "size": 4 },)");
  more = edited(more, R"("tired_motor": {)",
                R"("extra_motor": { "from": "extra", "to": "motor", "rule": "all_to_all", "weight": "0.5 nA",
                                    "delay": "1 ms" }, "tired_motor": {)");
  const Found found = diverge(compiled_view(text), compiled_view(more));
  REQUIRE_FALSE(found.divergence.links.empty());
  REQUIRE_FALSE(found.divergence.links.front().changes.empty());
  const Change& change = found.structure.changes[found.divergence.links.front().changes.front()];
  CHECK(change.name == "extra_motor");
  CHECK(change.kind == ChangeKind::Added);
}

TEST_CASE("edits of the shipped circuit are found, and the chain goes on through the projections that carry it") {
  const std::string text = oculomotor_text();
  check_edits(text,
              {
                  {R"("1.7 nA")", R"("1.3 nA")", kSpike, "projection", "llbn_ebn", "weight", "EBN"},
                  {R"("tau_llbn": { "value": "10 ms")", R"("tau_llbn": { "value": "12 ms")", kSpike, "population",
                   "LLBN", "tau_m", "LLBN"},
                  {R"("out_gain": { "value": "1.17")", R"("out_gain": { "value": "1.1")", LinkKind::Command, "output",
                   "left_eye_pan", "gain of MN_lateral.left", "left_eye_pan"},
              },
              0.3);
  const Found found =
      diverge(compiled_view(text), compiled_view(edited(text, R"("0.01884 nA")", R"("0.00942 nA")")), 0.3);
  REQUIRE_FALSE(found.divergence.links.empty());
  const DivergenceLink& first = found.divergence.links.front();
  CHECK(sided_name(first.population).base.substr(0, 4) == "LLBN");
  CHECK(first.why.find("is -0.00942001 nA instead of -0.01884 nA: w_ifn_llbn is 0.00942 nA instead of 0.01884 nA") !=
        std::string::npos);
  const auto via = [&](const std::string& population, const std::string& from) {
    return std::any_of(found.divergence.links.begin(), found.divergence.links.end(), [&](const DivergenceLink& link) {
      return sided_name(link.population).base == population && sided_name(link.from).base == from;
    });
  };
  CHECK(via("EBN", "LLBN"));
  CHECK(via("IFN", "EBN"));
}

TEST_CASE("an edit that no spike shows is found in the potential") {
  const std::string quiet = edited(small_eye_text(), R"("I_bias": "1.62 nA")", R"("I_bias": "0.1 nA")");
  const Found found = diverge(compiled_view(edited(quiet, R"("1.5 * g")", R"("0.001 * g")")),
                              compiled_view(edited(quiet, R"("1.5 * g")", R"("0.002 * g")")));
  REQUIRE_FALSE(found.divergence.links.empty());
  const DivergenceLink& first = found.divergence.links.front();
  CHECK(first.kind == LinkKind::Potential);
  REQUIRE_FALSE(first.changes.empty());
  CHECK(found.structure.changes[first.changes.front()].name == "relay_motor");
}

TEST_CASE("a name alone changes no spike, no potential and no command") {
  std::string renamed = small_eye_text();
  for (std::size_t at = 0; (at = renamed.find("\"relay\"", at)) != std::string::npos; ++at) {
    renamed.replace(at, 7, "\"interneuron\"");
  }
  const Found found = diverge(compiled_view(small_eye_text()), compiled_view(renamed));
  CHECK_FALSE(found.structure.is_same());
  CHECK(found.divergence.links.empty());
  CHECK(divergence_text(found.divergence) == "no spike, potential or command differs in 0.3111 s\n");
}
