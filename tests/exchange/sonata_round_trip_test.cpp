// Export to SONATA and back: the same neurons, the same weights, the same spikes.
#include <doctest/doctest.h>

#include <algorithm>

#include "runtime/engine/spike_engine.h"
#include "tests/exchange/exchanged_circuit.h"

namespace tectum {
namespace {

/// Every spike of a run in which the retina's fields flicker, as (tick, neuron).
std::vector<std::pair<std::uint64_t, std::uint32_t>> raster_of(const SpikeImage& image, std::uint64_t ticks) {
  constexpr std::uint64_t kFlickerTicks = 300;
  SpikeEngine engine(image);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> raster;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    for (const RetinaRecord& retina : image.retinas) {
      for (std::uint32_t k = 0; tick % kFlickerTicks == 0 && k < retina.field_count; ++k) {
        const bool is_active = (k * 7 + tick / kFlickerTicks * 13) % 31 < 3;
        engine.set_field_active(NeuronId{retina.first_neuron + k}, is_active);
      }
    }
    engine.step();
    for (const NeuronId neuron : engine.spikes()) {
      raster.emplace_back(tick, static_cast<std::uint32_t>(neuron));
    }
  }
  return raster;
}

std::vector<std::string> population_names(const SpikeImage& image) {
  std::vector<std::string> names;
  for (const PopulationRecord& population : image.populations) {
    names.emplace_back(image.name(population.name));
  }
  return names;
}

std::size_t spiking_neurons(const std::vector<std::pair<std::uint64_t, std::uint32_t>>& raster) {
  std::vector<std::uint32_t> neurons;
  for (const auto& [tick, neuron] : raster) {
    neurons.push_back(neuron);
  }
  std::sort(neurons.begin(), neurons.end());
  return static_cast<std::size_t>(std::unique(neurons.begin(), neurons.end()) - neurons.begin());
}

std::string there_and_back(const ScratchFolder& folder, const std::string& circuit,
                           const std::vector<std::string>& options = {}) {
  std::vector<std::string> args = {"export", circuit, "--to", "sonata", "-o", folder.file("network")};
  args.insert(args.end(), options.begin(), options.end());
  tectum_succeeds(args);
  tectum_succeeds(
      {"import", "sonata", folder.file("network/circuit_config.json"), "-o", folder.file("back/again.json")});
  return folder.file("back/again.json");
}

TEST_CASE("a circuit with every model comes back from SONATA with the same raster, bit for bit") {
  const ScratchFolder folder;
  const std::string again = there_and_back(folder, every_model_path());
  const SpikeImage image = compiled_file(every_model_path());
  const SpikeImage back = compiled_file(again);
  CHECK(population_names(back) == population_names(image));
  const auto raster = raster_of(image, 10'000);
  CHECK(spiking_neurons(raster) > 80);  // of 92: nearly everything has something to lose
  CHECK(raster == raster_of(back, 10'000));
  CHECK(back.outputs.size() == image.outputs.size());
  CHECK(back.retinas.size() == image.retinas.size());
  CHECK(back.header.seed == image.header.seed);
}

TEST_CASE("the oculomotor circuit comes back from SONATA with the same raster and the same head") {
  const ScratchFolder folder;
  const std::string again = there_and_back(folder, oculomotor_path());
  const SpikeImage image = compiled_file(oculomotor_path());
  const SpikeImage back = compiled_file(again);
  CHECK(population_names(back) == population_names(image));
  CHECK(back.targets.size() == image.targets.size());
  const auto raster = raster_of(image, 2'000);
  CHECK(spiking_neurons(raster) > 1000);
  CHECK(raster == raster_of(back, 2'000));
  REQUIRE(back.outputs.size() == image.outputs.size());
  for (std::size_t o = 0; o < image.outputs.size(); ++o) {
    CHECK(back.outputs[o].joint_mask == image.outputs[o].joint_mask);
    CHECK(back.outputs[o].offset_deg == image.outputs[o].offset_deg);
  }
}

TEST_CASE("weights come back in the same quanta after a second trip, too") {
  const ScratchFolder folder;
  const std::string once = there_and_back(folder, every_model_path());
  const ScratchFolder second;
  const std::string twice = there_and_back(second, once);
  const SpikeImage first = compiled_file(once);
  const SpikeImage again = compiled_file(twice);
  CHECK(std::equal(first.weights.begin(), first.weights.end(), again.weights.begin(), again.weights.end()));
  CHECK(std::equal(first.receptors.begin(), first.receptors.end(), again.receptors.begin(), again.receptors.end(),
                   [](const ReceptorRecord& a, const ReceptorRecord& b) { return a.quantum_log2 == b.quantum_log2; }));
}

TEST_CASE("a lesioned population stays silent after the trip") {
  const ScratchFolder folder;
  const std::string again = there_and_back(folder, every_model_path(), {"--lesion", "noise.left"});
  const SpikeImage back = compiled_file(again);
  const PopulationRecord silenced = back.populations[*back.find_population("noise.left")];
  const auto raster = raster_of(back, 3'000);
  CHECK(raster.size() > 100);
  CHECK(std::none_of(raster.begin(), raster.end(), [&](const auto& spike) {
    return spike.second >= silenced.first_neuron && spike.second < silenced.first_neuron + silenced.size;
  }));
}

TEST_CASE("what NEST would do otherwise is said by name") {
  const ScratchFolder folder;
  const CommandResult result =
      tectum_succeeds({"export", every_model_path(), "--to", "sonata", "-o", folder.file("network")});
  for (const char* text : {"NEST cannot run `B.left` and `B.right`", "NEST cannot run `G`", "NEST runs `IZ` otherwise",
                           "no delay of 0 ms and refuses the synapses of `noise_g`", "`SC` get no spikes"}) {
    CAPTURE(text);
    CHECK(result.err.find(text) != std::string::npos);
  }
  CHECK(result.err.find("`R`") == std::string::npos);  // lif_delta is iaf_psc_delta to the letter
}

}  // namespace
}  // namespace tectum
