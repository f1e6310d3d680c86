// A circuit whose weights are not what its file says.
#include <cmath>
#include <memory>
#include <vector>

#include "runtime/image/philox.h"
#include "tools/evaluate/robustness.h"

namespace tectum {
namespace {

enum Draw : std::uint32_t { kOfSynapse = 1, kOfPathway = 2 };

/// Evenly between -1 and 1.
double even(std::uint64_t seed, Draw draw, std::uint32_t a, std::uint32_t b) {
  const PhiloxWords words = philox4x32(seed, {a, b, draw, 0});
  return 2 * (words[0] + 0.5) * 0x1p-32 - 1;
}

/// With a weight of its own for every synapse: `offset(neuron, target, slot)` is how far from 1 its factor is.
template <typename Offset>
SpikeImage scaled(const SpikeImage& image, const Offset& offset) {
  struct Own {
    std::shared_ptr<const void> base;
    std::vector<std::int32_t> weights;
    std::vector<SegmentRecord> segments;
  };
  auto own = std::make_shared<Own>();
  own->base = image.storage;
  own->segments.assign(image.segments.begin(), image.segments.end());
  own->weights.resize(image.targets.size());
  for (std::uint32_t neuron = 0; neuron < image.header.neuron_count; ++neuron) {
    for (std::uint32_t s = image.row_begin[neuron]; s < image.row_begin[neuron + 1]; ++s) {
      SegmentRecord& segment = own->segments[s];
      const bool is_shared = (segment.flags & kSegmentOneWeight) != 0;
      for (std::uint32_t t = segment.target_begin; t < image.segments[s + 1].target_begin; ++t) {
        const std::uint32_t place = is_shared ? segment.weight_begin : segment.weight_begin + t - segment.target_begin;
        own->weights[t] =
            static_cast<std::int32_t>(std::lrint(image.weights[place] * (1 + offset(neuron, t, image.targets[t]))));
      }
      segment.weight_begin = segment.target_begin;
      segment.flags &= ~static_cast<std::uint32_t>(kSegmentOneWeight);
    }
  }
  SpikeImage changed = image;
  changed.weights = own->weights;
  changed.segments = own->segments;
  changed.storage = std::move(own);
  return changed;
}

}  // namespace

SpikeImage with_weight_noise(const SpikeImage& image, double share, std::uint64_t seed) {
  return scaled(image, [&](std::uint32_t /*neuron*/, std::uint32_t target, std::uint32_t /*slot*/) {
    return share * even(seed, kOfSynapse, target, 0);
  });
}

SpikeImage with_pathway_noise(const SpikeImage& image, double share, std::uint64_t seed) {
  std::vector<std::uint32_t> population_of(image.header.neuron_count);
  for (std::uint32_t p = 0; p < image.populations.size(); ++p) {
    for (std::uint32_t i = 0; i < image.populations[p].size; ++i) {
      population_of[image.populations[p].first_neuron + i] = p;
    }
  }
  // A receptor of a population: groups of one population (lesioned neurons are a group of their own) count as one.
  std::vector<std::uint32_t> receptor_of(image.header.slot_count);
  for (const GroupRecord& group : image.groups) {
    for (std::uint32_t k = 0; k < group.receptor_count * group.size; ++k) {
      receptor_of[group.first_slot + k] = group.population * 16 + k / group.size;
    }
  }
  return scaled(image, [&](std::uint32_t neuron, std::uint32_t /*target*/, std::uint32_t slot) {
    return share * even(seed, kOfPathway, population_of[neuron], receptor_of[slot]);
  });
}

}  // namespace tectum
