// Neuron models declared by their equations in a circuit file, run for 10 s on a periodic drive beside the built-in
// model, or against a double-precision reference: the same spikes, tick by tick.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "tests/compiler/compiled_text.h"

namespace tectum::test {
namespace {

constexpr std::uint32_t kTicks = 100'000;  // 10 s at 0.1 ms
constexpr std::uint32_t kSize = 20;

/// Six spike trains whose periods never fall into step drive `built_in` and `declared` alike.
std::string side_by_side(const std::string& models, const std::string& built_in, const std::string& declared,
                         const std::string& weight_unit) {
  std::string neurons = fmt::format(R"j("built_in": {}, "declared": {})j", built_in, declared);
  std::string populations = fmt::format(
      R"j("B": {{ "neuron": "built_in", "size": {0} }}, "D": {{ "neuron": "declared", "size": {0} }})j", kSize);
  std::string projections;
  for (std::uint32_t k = 0; k < 6; ++k) {
    neurons += fmt::format(R"j(, "train{}": {{ "model": "spike_list", "times": {} }})j", k,
                           spike_times(5 + 3 * k, 223 + 37 * k, kTicks));
    populations += fmt::format(R"j(, "T{0}": {{ "neuron": "train{0}", "size": 1 }})j", k);
    projections += fmt::format(R"j({0}"t{1}": {{ "from": "T{1}", "to": ["B", "D"], "rule": "all_to_all",
        "weight": "{2} {3} * (1 + post.index / 10)", "delay": "{4} ms" }})j",
                               k == 0 ? "" : ", ", k, 6 + 0.25 * k, weight_unit, 1 + k);
  }
  return fmt::format(R"j({{ "tectum": 1, "name": "pair", "tick": "0.1 ms", "models": {{ {} }}, "neurons": {{ {} }},
      "populations": {{ {} }}, "projections": {{ {} }} }})j",
                     models, neurons, populations, projections);
}

/// Spikes of one population, without its name.
std::vector<std::pair<std::uint64_t, std::uint32_t>> spikes_of(const NamedRaster& raster, const std::string& name) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> spikes;
  for (const auto& [tick, population, neuron] : raster) {
    if (population == name) {
      spikes.emplace_back(tick, neuron);
    }
  }
  return spikes;
}

void check_side_by_side(const std::string& circuit) {
  const NamedRaster raster = named_raster(compile_text(circuit), kTicks);
  const auto built_in = spikes_of(raster, "B");
  CHECK(built_in.size() > 1000);
  CHECK(spikes_of(raster, "D") == built_in);
}

}  // namespace

TEST_CASE("LIF declared in a circuit file fires as the built-in lif_exp does") {
  check_side_by_side(
      side_by_side(R"j("my_lif": {
      "parameters": { "tau_m": "20 ms", "E_L": "-70 mV", "V_th": "-50 mV", "V_reset": "-65 mV", "R_m": "10 MOhm",
                      "I_bias": "0 nA", "tau_ex": "2 ms", "t_ref": "2 ms" },
      "inputs": { "ex": "nA" },
      "states": { "v": "E_L", "I": "0 nA" },
      "equations": { "dv/dt": "(E_L - v + R_m * (I + I_bias)) / tau_m", "dI/dt": "-I / tau_ex", "I": "I + ex" },
      "threshold": "v >= V_th", "reset": { "v": "V_reset" }, "refractory": "t_ref" })j",
                   R"j({ "model": "lif_exp", "I_bias": "0.9 nA", "receptors": { "ex": { "tau": "5 ms" } } })j",
                   R"j({ "model": "my_lif", "I_bias": "0.9 nA", "tau_ex": "5 ms" })j", "nA"));
}

TEST_CASE("a per-tick update and a threshold declared in a circuit file make the built-in lif_delta") {
  check_side_by_side(side_by_side(R"j("my_delta": {
      "parameters": { "tau_m": "20 ms" },
      "inputs": { "ex": "mV" },
      "states": { "v": "-70 mV" },
      "equations": { "dv/dt": "(-70 mV - v) / tau_m", "v": "v + ex" },
      "threshold": "v >= -50 mV", "reset": { "v": "-65 mV" }, "refractory": "2 ms", "method": "exact" })j",
                                  R"j({ "model": "lif_delta" })j", R"j({ "model": "my_delta" })j", "mV"));
}

TEST_CASE("Izhikevich declared in a circuit file fires as the built-in does") {
  check_side_by_side(
      side_by_side(R"j("my_izhikevich": {
      "parameters": { "a": "0.02 /ms", "b": "0.2 /ms", "c": "-65 mV", "d": "8 mV/ms", "I_bias": "6 mV/ms" },
      "inputs": { "ex": "mV/ms" },
      "states": { "v": "c", "u": "b * c" },
      "equations": { "v": "v + dt * (0.04 /mV/ms * v ^ 2 + 5 /ms * v + 140 mV/ms - u + (ex + I_bias))",
                     "u": "u + dt * a * (b * v - u)" },
      "threshold": "v > 30 mV", "reset": { "v": "c", "u": "u + d" } })j",
                   R"j({ "model": "izhikevich", "I_bias": 6, "receptors": { "ex": { "tau": "3 ms" } } })j",
                   R"j({ "model": "my_izhikevich", "receptors": { "ex": { "tau": "3 ms" } } })j", "mV/ms"));
}

// Brette & Gerstner 2005, doi:10.1152/jn.00686.2005, forward Euler, against the same steps written plainly in double
// with libm's exp.
TEST_CASE("AdEx declared in a circuit file agrees with a double-precision reference") {
  const std::string circuit = R"j({ "tectum": 1, "name": "adex", "tick": "0.1 ms",
    "models": { "adex": {
      "parameters": { "C": "281 pF", "g_L": "30 nS", "E_L": "-70.6 mV", "V_T": "-50.4 mV", "D_T": "2 mV",
                      "tau_w": "144 ms", "a": "4 nS", "b": "80.5 pA", "I_bias": "0.8 nA" },
      "states": { "v": "E_L", "w": "0 nA" },
      "equations": { "dv/dt": "(-g_L * (v - E_L) + g_L * D_T * exp((v - V_T) / D_T) - w + I_bias) / C",
                     "dw/dt": "(a * (v - E_L) - w) / tau_w" },
      "threshold": "v >= 20 mV", "reset": { "v": "E_L", "w": "w + b" }, "method": "euler" } },
    "neurons": { "cell": { "model": "adex" } },
    "populations": { "A": { "neuron": "cell", "size": 20, "I_bias": "0.75 nA + 0.0625 nA * index" } } })j";
  const auto spikes = spikes_of(named_raster(compile_text(circuit), kTicks), "A");
  std::vector<std::pair<std::uint64_t, std::uint32_t>> reference;
  std::vector<double> v(kSize, -70.6);
  std::vector<double> w(kSize, 0.0);
  for (std::uint32_t tick = 0; tick < kTicks; ++tick) {
    for (std::uint32_t i = 0; i < kSize; ++i) {
      const double spike_current = 0.030 * 2.0 * std::exp((v[i] + 50.4) / 2.0);
      const double dv = (-0.030 * (v[i] + 70.6) + spike_current - w[i] + 0.75 + 0.0625 * i) / 0.281;
      const double dw = (0.004 * (v[i] + 70.6) - w[i]) / 144.0;
      v[i] += 0.1 * dv;
      w[i] += 0.1 * dw;
      if (v[i] >= 20) {
        v[i] = -70.6;
        w[i] += 0.0805;
        reference.emplace_back(tick, i);
      }
    }
  }
  CHECK(reference.size() > 1000);
  CHECK(spikes == reference);
}

}  // namespace tectum::test
