#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/image/verify_parts.h"

namespace tectum {
namespace {

std::string number(std::uint64_t value) { return std::to_string(value); }

std::string verify_rule(const SpikeImage& image, const PlasticityRecord& rule) {
  if (rule.projection >= image.projections.size() ||
      static_cast<std::size_t>(rule.form) >= kPlasticityFormNames.size() ||
      static_cast<std::uint32_t>(rule.channel) >= kRewardChannelCount || rule.reserved != 0) {
    return "names a projection, form or reward that does not exist";
  }
  if (rule.synapse_count == 0 || rule.listed_count < rule.synapse_count) {
    return "has no synapses, or more than its circuit declared";
  }
  const std::uint64_t decay_count = std::uint64_t{kDecaysOfRule} * kDecayPowers;
  if (rule.first_decay > image.decays.size() || decay_count > image.decays.size() - rule.first_decay) {
    return "has decays outside their section";
  }
  const auto decays = image.decays.subspan(rule.first_decay, decay_count);
  const auto is_decay = [](double decay) { return decay >= 0 && decay <= 1; };
  if (!std::all_of(decays.begin(), decays.end(), is_decay)) {
    return "has a decay that is not 0 to 1";
  }
  const auto is_rate = [](double hz) { return std::isfinite(hz) && hz > 0; };
  if (!is_rate(rule.learning_rate_hz) || !is_rate(rule.reference_rate_hz)) {
    return "has a rate that is not above 0";
  }
  return rule.lowest >= 0 && rule.lowest <= rule.highest ? "" : "has bounds that are none";
}

/// Of each neuron's row: which segment a target lies in, and how its weight is stored.
class WeightCells {
 public:
  explicit WeightCells(const SpikeImage& image) : image_(image), users_(image.weights.size(), 0) {
    for (std::size_t k = 0; k + 1 < image.segments.size(); ++k) {
      const SegmentRecord& segment = image.segments[k];
      const bool has_one_weight = (segment.flags & kSegmentOneWeight) != 0;
      const std::uint32_t count = has_one_weight ? 1 : image.segments[k + 1].target_begin - segment.target_begin;
      for (std::uint32_t w = 0; w < count; ++w) {
        std::uint8_t& users = users_[segment.weight_begin + w];
        users = users < 2 ? static_cast<std::uint8_t>(users + 1) : users;
      }
    }
  }

  /// Why the synapse cannot learn; empty when it can.
  [[nodiscard]] std::string verify(const PlasticSynapseRecord& synapse, std::uint32_t neuron) const {
    const std::uint32_t first = image_.row_begin[neuron];
    const std::uint32_t last = image_.row_begin[neuron + 1];
    if (first == last || synapse.target < image_.segments[first].target_begin ||
        synapse.target >= image_.segments[last].target_begin) {
      return "is not in its neuron's row";
    }
    std::uint32_t k = first;
    while (image_.segments[k + 1].target_begin <= synapse.target) {
      ++k;
    }
    const SegmentRecord& segment = image_.segments[k];
    const std::size_t weight = std::size_t{segment.weight_begin} + (synapse.target - segment.target_begin);
    if ((segment.flags & kSegmentOneWeight) != 0 || users_[weight] != 1) {
      return "shares its weight";
    }
    return image_.weights[weight] == plastic_quanta(synapse.base_quanta, synapse.scale)
               ? ""
               : "starts at another weight than its row says";
  }

 private:
  const SpikeImage& image_;
  std::vector<std::uint8_t> users_;  // of each weight, at most 2
};

/// Slot of a neuron's receptor; none for a silenced neuron.
bool is_slot_of(const SpikeImage& image, std::uint32_t slot, std::uint32_t neuron, std::uint32_t receptor) {
  return std::any_of(image.groups.begin(), image.groups.end(), [&](const GroupRecord& group) {
    return neuron >= group.first_neuron && neuron - group.first_neuron < group.size &&
           receptor < group.receptor_count &&
           slot == group.first_slot + receptor * group.size + (neuron - group.first_neuron);
  });
}

std::string verify_synapse(const SpikeImage& image, const WeightCells& cells, const PlasticityRecord& rule,
                           const PlasticSynapseRecord& synapse) {
  const ProjectionRecord& projection = image.projections[rule.projection];
  const PopulationRecord& pre = image.populations[projection.pre_population];
  const PopulationRecord& post = image.populations[projection.post_population];
  if (synapse.pre >= pre.size || synapse.post >= post.size || synapse.ordinal >= rule.listed_count) {
    return "joins neurons that its populations do not have";
  }
  if (synapse.scale < rule.lowest || synapse.scale > rule.highest) {
    return "starts outside its bounds";
  }
  // Within these, no weight overflows.
  const std::int64_t base = std::abs(std::int64_t{synapse.base_quanta});
  if (base * rule.highest >= std::int64_t{1} << (kScaleBits + 30)) {
    return "may grow beyond 2^30 quanta";
  }
  std::string error = cells.verify(synapse, pre.first_neuron + synapse.pre);
  if (error.empty() &&
      !is_slot_of(image, image.targets[synapse.target], post.first_neuron + synapse.post, projection.receptor)) {
    error = "leads to another neuron than its row says";
  }
  return error;
}

}  // namespace

std::string verify_plasticity(const SpikeImage& image) {
  if (image.plasticity.empty()) {
    return {};
  }
  const WeightCells cells(image);
  std::uint64_t next = 0;
  for (std::size_t p = 0; p < image.plasticity.size(); ++p) {
    const PlasticityRecord& rule = image.plasticity[p];
    const std::string where = "plasticity " + number(p) + " ";
    std::string error = verify_rule(image, rule);
    if (!error.empty()) {
      return where + error;
    }
    if (rule.first_synapse != next || rule.synapse_count > image.plastic_synapses.size() - next) {
      return where + "has synapses that do not follow the last one's";
    }
    next += rule.synapse_count;
    const auto synapses = image.plastic_synapses.subspan(rule.first_synapse, rule.synapse_count);
    for (std::size_t s = 0; s < synapses.size(); ++s) {
      error = verify_synapse(image, cells, rule, synapses[s]);
      if (error.empty() && s > 0 &&
          (synapses[s].pre < synapses[s - 1].pre ||
           (synapses[s].pre == synapses[s - 1].pre && synapses[s].target <= synapses[s - 1].target))) {
        error = "is out of order";
      }
      if (!error.empty()) {
        return where + "synapse " + number(s) + " " + error;
      }
    }
  }
  return next == image.plastic_synapses.size() ? "" : "plastic synapses that belong to no rule";
}

}  // namespace tectum
