#include "tools/analysis/run_recorder.h"

#include <utility>

namespace tectum {

RunRecorder::RunRecorder(const SpikeImage& image) {
  recording_.circuit_name = image.name(image.header.circuit_name);
  recording_.image_checksum = image.header.checksum;
  recording_.tick_ns = image.header.tick_ns;
  for (const PopulationRecord& population : image.populations) {
    recording_.populations.push_back({.name = std::string(image.name(population.name)),
                                      .nucleus = std::string(image.name(population.nucleus)),
                                      .first_neuron = population.first_neuron,
                                      .size = population.size});
  }
  for (const RetinaRecord& retina : image.retinas) {
    const auto fields = image.fields.subspan(retina.first_field, retina.field_count);
    recording_.retinas.push_back({.name = std::string(image.name(retina.name)),
                                  .eye = retina.eye,
                                  .field_of_view_deg = retina.field_of_view_deg,
                                  .frame_width = retina.frame_width,
                                  .frame_height = retina.frame_height,
                                  .fields = {fields.begin(), fields.end()}});
  }
}

void RunRecorder::take(std::uint64_t tick, std::span<const NeuronId> spikes) noexcept {
  for (const NeuronId neuron : spikes) {
    recording_.spikes.push_back({.tick = tick, .neuron = static_cast<std::uint32_t>(neuron)});
  }
}

void RunRecorder::add_frame(RecordedFrame frame) { recording_.frames.push_back(std::move(frame)); }

}  // namespace tectum
