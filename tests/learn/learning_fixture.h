// Circuits that learn, compiled from text.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <regex>
#include <string>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"
#include "runtime/learn/learner.h"

namespace tectum::test {

inline ImageContents compiled(const std::string& circuit) {
  Diagnostics diagnostics;
  CompileResult result = compile_circuit({"learn.json", circuit}, {}, diagnostics);
  REQUIRE_MESSAGE(result.image.has_value(), render_text(diagnostics, result.sources));
  return std::move(*result.image);
}

inline SpikeImage loaded(const ImageContents& contents) {
  LoadedImage image = load_image(write_image(contents));
  REQUIRE_MESSAGE(image.image.has_value(), image.error);
  return std::move(*image.image);
}

/// Two Poisson sources, three neurons that they drive by weights that learn, and a loop that does not.
inline std::string noisy_circuit(const std::string& plasticity) {
  return fmt::format(R"j({{
    "tectum": 1, "name": "noisy", "tick": "0.5 ms", "seed": 5,
    "neurons": {{
      "source": {{ "model": "poisson", "rate": "60 Hz" }},
      "cell": {{ "model": "lif_exp", "tau_m": "10 ms", "V_th": "-60 mV", "V_reset": "-70 mV", "I_bias": "0.9 nA" }} }},
    "inputs": {{ "eye": {{ "retina": {{ "eye": "left", "frame": [8, 8], "field_of_view": "30 deg",
      "rings": [{{ "outer": 4, "block": [2, 2] }}], "lit": {{ "channel": "luma", "above": 9 }} }} }} }},
    "populations": {{
      "A": {{ "neuron": "source", "size": 6 }}, "B": {{ "neuron": "cell", "size": 5 }}, "C": {{ "neuron": "cell", "size": 4 }},
      "SC": {{ "input": "eye", "rate": "100 Hz" }} }},
    "projections": {{
      "ab": {{ "from": "A", "to": "B", "rule": "all_to_all", "weight": "0.5 nA + 0.125 nA * pre.index", "delay": "1 ms",
        "plasticity": {{ {0} }} }},
      "bc": {{ "from": "B", "to": "C", "rule": "all_to_all", "weight": "0.75 nA", "delay": "0.5 ms * (1 + post.index)",
        "plasticity": {{ {0}, "bounds": [0.25, 4] }} }},
      "cb": {{ "from": "C", "to": "B", "rule": "all_to_all", "weight": "0.75 nA", "delay": "1.5 ms", "sign": "inhibitory" }} }}
  }})j",
                     plasticity);
}

/// The same circuit without `plasticity`.
inline std::string unlearned(const std::string& circuit) {
  return std::regex_replace(circuit, std::regex(R"(,\s*"plasticity": \{[^}]*\})"), "");
}

/// One source and one target that fire when they are told, joined by one synapse that learns.
inline std::string pair_circuit(const std::string& plasticity) {
  return fmt::format(R"j({{
    "tectum": 1, "name": "pair", "tick": "1 ms",
    "neurons": {{ "cell": {{ "model": "lif_exp" }} }},
    "inputs": {{ "eye": {{ "retina": {{ "eye": "left", "frame": [8, 8], "field_of_view": "30 deg",
      "rings": [{{ "outer": 4, "block": [2, 2] }}], "lit": {{ "channel": "luma", "above": 9 }} }} }} }},
    "populations": {{ "A": {{ "neuron": "cell", "size": 1, "I_bias": "1 nA" }}, "B": {{ "neuron": "cell", "size": 1 }},
      "SC": {{ "input": "eye", "rate": "100 Hz" }} }},
    "projections": {{ "ab": {{ "from": "A", "to": "B", "rule": "all_to_all", "weight": "1 nA", "delay": "1 ms",
      "plasticity": {{ {} }} }} }}
  }})j",
                     plasticity);
}

inline RewardSample pan_reward(double value) {
  RewardSample sample;
  sample.value[static_cast<std::size_t>(RewardChannel::Pan)] = value;
  sample.given = 1U << static_cast<std::uint32_t>(RewardChannel::Pan);
  return sample;
}

}  // namespace tectum::test
