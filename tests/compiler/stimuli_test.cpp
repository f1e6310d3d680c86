// A stimulus is a current: what it does is what a bias of the same size does, and nothing before or after it.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "tests/compiler/compiled_text.h"
#include "tests/support/test_network.h"

namespace tectum::test {
namespace {

constexpr std::uint64_t kTicks = 5000;  // 0.5 s at 0.1 ms

/// One neuron `by_bias` that a bias drives, and one `by_current` that a stimulus does from the second tick on.
std::string circuit(const std::string& model, const std::string& amplitude) {
  return fmt::format(R"j({{
    "tectum": 1, "name": "stimulated", "tick": "0.1 ms",
    "neurons": {{ "n": {{ {} }} }},
    "populations": {{ "by_bias": {{ "neuron": "n", "size": 1, "I_bias": "{}" }}, "by_current": {{ "neuron": "n", "size": 1 }} }},
    "stimuli": {{ "on": {{ "into": "by_current", "amplitude": "{}", "at": "0.1 ms", "duration": "0.4 s" }} }}
  }})j",
                     model, amplitude, amplitude);
}

std::vector<std::uint64_t> spike_ticks(const NamedRaster& raster, const std::string& name) {
  std::vector<std::uint64_t> ticks;
  for (const auto& [tick, population, index] : raster) {
    if (population == name) {
      ticks.push_back(tick);
    }
  }
  return ticks;
}

}  // namespace

TEST_CASE(
    "a membrane under a stimulus fires as under a bias of the same current, from when it begins to when it ends") {
  for (const char* model :
       {R"("model": "lif_exp", "tau_m": "10 ms", "t_ref": "2 ms")", R"("model": "lif_delta", "tau_m": "10 ms")",
        R"("model": "lif_exp", "tau_m": "5 ms", "receptors": { "step": { "tau": "40 ms" } })"}) {
    CAPTURE(model);
    const NamedRaster raster = named_raster(compile_text(circuit(model, "2.5 nA")), kTicks);
    const std::vector<std::uint64_t> by_bias = spike_ticks(raster, "by_bias");
    const std::vector<std::uint64_t> by_current = spike_ticks(raster, "by_current");
    REQUIRE(by_current.size() > 20);
    const std::uint64_t lag = by_current.front() - by_bias.front();
    CHECK(lag <= 2);
    CHECK(by_current.back() <= 4001 + lag);
    for (std::size_t k = 0; k < by_current.size(); ++k) {
      CAPTURE(k);
      CHECK(by_current[k] == by_bias[k] + lag);
    }
  }
}

TEST_CASE("a negative stimulus silences what fires by itself for as long as it lasts") {
  const NamedRaster raster = named_raster(compile_text(R"j({
    "tectum": 1, "name": "silenced", "tick": "0.1 ms",
    "neurons": { "n": { "model": "lif_exp", "tau_m": "5 ms", "I_bias": "2.5 nA" } },
    "populations": { "A": { "neuron": "n", "size": 3 } },
    "stimuli": { "off": { "into": "A", "amplitude": "-3 nA", "at": "100 ms", "duration": "200 ms" } }
  })j"),
                                          kTicks);
  const std::vector<std::uint64_t> ticks = spike_ticks(raster, "A");
  const auto in = [&](std::uint64_t from, std::uint64_t to) {
    return std::count_if(ticks.begin(), ticks.end(), [&](std::uint64_t tick) { return tick >= from && tick < to; });
  };
  CHECK(in(0, 1000) > 20);
  CHECK(in(1020, 3000) == 0);
  CHECK(in(3000, 5000) > 20);
}

TEST_CASE("a train of pulses reaches the named side alone, once for each pulse") {
  const NamedRaster raster = named_raster(compile_text(R"j({
    "tectum": 1, "name": "train", "tick": "0.1 ms", "axes": { "h": ["left", "right"] },
    "neurons": { "n": { "model": "lif_exp", "tau_m": "5 ms", "t_ref": "5 ms" } },
    "populations": { "A": { "neuron": "n", "size": 2, "axis": "h" } },
    "stimuli": { "train": { "into": "A.left", "amplitude": "20 nA", "at": "50 ms", "duration": "1 ms", "pulses": 7, "every": "50 ms" } }
  })j"),
                                          kTicks);
  CHECK(spike_ticks(raster, "A_right").empty());
  const std::vector<std::uint64_t> left = spike_ticks(raster, "A_left");
  REQUIRE(left.size() == 14);
  for (std::size_t k = 0; k < left.size(); ++k) {
    CAPTURE(k);
    const std::uint64_t begin = 500 * (k / 2 + 1);
    CHECK(left[k] >= begin);
    CHECK(left[k] < begin + 12);
  }
}

TEST_CASE("a weakened projection keeps its share, and a weakened population sends that share of everything") {
  const auto raster = [](const char* weight, const char* lesion) {
    return named_raster(compile_text(fmt::format(R"j({{
      "tectum": 1, "name": "weak", "tick": "0.1 ms",
      "neurons": {{ "n": {{ "model": "lif_exp", "tau_m": "5 ms" }} }},
      "populations": {{ "A": {{ "neuron": "n", "size": 8, "I_bias": "2 nA + 0.1 nA * index" }}, "B": {{ "neuron": "n", "size": 8 }} }},
      "lesions": {{ {} }},
      "projections": {{ "ab": {{ "from": "A", "to": "B", "rule": "all_to_all", "weight": "{}", "delay": "1 ms" }} }}
    }})j",
                                                 lesion, weight)),
                        kTicks);
  };
  const NamedRaster half = raster("1 nA", "");
  CHECK(raster("2 nA", "") != half);
  CHECK(raster("2 nA", R"("weak": { "weaken": "ab", "to": 0.5 })") == half);
  CHECK(raster("2 nA", R"("weak": { "weaken": "A", "to": 0.5 })") == half);
}

}  // namespace tectum::test
