#include "tools/benchmark/export_network.h"

#include <filesystem>
#include <fstream>
#include <system_error>

#include "runtime/engine/group_parameters.h"
#include "runtime/engine/slot_ranges.h"

namespace tectum {
namespace {

template <typename T>
bool write_array(const std::string& folder, const char* name, const std::vector<T>& values) {
  std::ofstream file(std::filesystem::path(folder) / name, std::ios::binary);
  file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  return static_cast<bool>(file);
}

std::vector<std::uint32_t> ticks_of(const Stimulus& spikes) {
  std::vector<std::uint32_t> ticks;
  for (std::size_t tick = 0; tick + 1 < spikes.begin.size(); ++tick) {
    ticks.insert(ticks.end(), spikes.of(tick).size(), static_cast<std::uint32_t>(tick));
  }
  return ticks;
}

bool write_synapses(const SpikeImage& image, const std::string& folder) {
  const SlotRanges ranges(image);
  std::vector<std::uint32_t> pre, post, receptor, delay_ticks;
  std::vector<double> weight;
  for (std::uint32_t neuron = 0; neuron < image.header.neuron_count; ++neuron) {
    for (std::uint32_t s = image.row_begin[neuron]; s < image.row_begin[neuron + 1]; ++s) {
      const SegmentRecord& segment = image.segments[s];
      for (std::uint32_t t = segment.target_begin; t < image.segments[s + 1].target_begin; ++t) {
        const SlotRange& range = ranges.of(image.targets[t]);
        const GroupRecord& group = image.groups[range.group];
        const bool has_one = (segment.flags & kSegmentOneWeight) != 0;
        const std::int32_t quanta = image.weights[segment.weight_begin + (has_one ? 0 : t - segment.target_begin)];
        pre.push_back(neuron);
        post.push_back(group.first_neuron + image.targets[t] - range.begin);
        receptor.push_back(range.receptor);
        delay_ticks.push_back(segment.delay_ticks);
        weight.push_back(quanta * GroupParameters(image, group).quantum(range.receptor));
      }
    }
  }
  return write_array(folder, "pre.u32", pre) && write_array(folder, "post.u32", post) &&
         write_array(folder, "receptor.u32", receptor) && write_array(folder, "delay_ticks.u32", delay_ticks) &&
         write_array(folder, "weight.f64", weight);
}

}  // namespace

std::string export_network(const SpikeImage& image, const Stimulus& stimulus, const Stimulus& raster,
                           const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return folder + ": " + error.message();
  }
  std::vector<double> initial(image.header.neuron_count);
  for (const GroupRecord& group : image.groups) {
    for (std::uint32_t i = 0; i < group.size && group.model == ModelKind::LifExp; ++i) {
      initial[group.first_neuron + i] = GroupParameters(image, group).value(lif_parameter::kInitialV, i);
    }
  }
  const bool is_written = write_synapses(image, folder) && write_array(folder, "initial.f64", initial) &&
                          write_array(folder, "stimulus_tick.u32", ticks_of(stimulus)) &&
                          write_array(folder, "stimulus_neuron.u32", stimulus.neurons) &&
                          write_array(folder, "spike_tick.u32", ticks_of(raster)) &&
                          write_array(folder, "spike_neuron.u32", raster.neurons);
  return is_written ? "" : folder + ": cannot write";
}

}  // namespace tectum
