#include <algorithm>
#include <vector>

#include "runtime/image/models.h"
#include "runtime/image/verify_parts.h"

namespace tectum {
namespace {

std::string number(std::uint64_t value) { return std::to_string(value); }

std::string verify_rows(const SpikeImage& image) {
  if (image.segments.empty()) {
    return "the segments have no sentinel";
  }
  const std::size_t segment_count = image.segments.size() - 1;
  if (image.row_begin.size() != std::size_t{image.header.neuron_count} + 1 || image.row_begin.front() != 0 ||
      image.row_begin.back() != segment_count) {
    return "the rows do not cover the segments";
  }
  if (!std::is_sorted(image.row_begin.begin(), image.row_begin.end())) {
    return "the rows are out of order";
  }
  return {};
}

std::string verify_segments(const SpikeImage& image) {
  const std::size_t count = image.segments.size() - 1;
  const SegmentRecord& sentinel = image.segments[count];
  if (image.segments[0].target_begin != 0 || sentinel.target_begin != image.targets.size() ||
      sentinel.weight_begin != image.weights.size() || sentinel.delay_ticks != 0 || sentinel.flags != 0) {
    return "the segments do not cover the targets and weights";
  }
  std::uint32_t longest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const SegmentRecord& segment = image.segments[k];
    const std::uint32_t end = image.segments[k + 1].target_begin;
    if (segment.target_begin >= end) {
      return "segment " + number(k) + " is empty or out of order";
    }
    const bool has_one_weight = (segment.flags & kSegmentOneWeight) != 0;
    const std::uint64_t needed = has_one_weight ? 1 : end - segment.target_begin;
    if ((segment.flags & ~std::uint32_t{kSegmentOneWeight}) != 0 ||
        std::uint64_t{segment.weight_begin} + needed > image.weights.size()) {
      return "segment " + number(k) + " has weights outside their section or unknown flags";
    }
    longest = std::max(longest, segment.delay_ticks);
  }
  if (longest != image.header.max_delay_ticks || longest > kMaxDelayTicks) {
    return "the longest delay is " + number(longest) + " ticks, the header says " +
           number(image.header.max_delay_ticks);
  }
  for (std::size_t row = 0; row + 1 < image.row_begin.size(); ++row) {
    for (std::uint32_t k = image.row_begin[row] + 1; k < image.row_begin[row + 1]; ++k) {
      if (image.segments[k].delay_ticks <= image.segments[k - 1].delay_ticks) {
        return "the delays of neuron " + number(row) + " do not ascend";
      }
    }
  }
  return {};
}

std::string verify_targets(const SpikeImage& image) {
  const std::size_t count = image.segments.size() - 1;
  const std::uint32_t* const targets = image.targets.data();
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t begin = image.segments[k].target_begin;
    const std::uint32_t end = image.segments[k + 1].target_begin;
    // Branch-free over the run, so that it vectorises: this loop reads every synapse.
    std::uint32_t disorder = 0;
    for (std::uint32_t t = begin + 1; t < end; ++t) {
      disorder |= static_cast<std::uint32_t>(targets[t] < targets[t - 1]);
    }
    if (disorder != 0 || targets[end - 1] >= image.header.slot_count) {
      return "the targets of segment " + number(k) + " are out of order or no slots";
    }
  }
  return {};
}

// A same-tick synapse leads to a group that the tick updates later.
std::string verify_same_tick_order(const SpikeImage& image) {
  const auto order_of = [&](std::uint32_t key, auto first_of) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> starts;
    for (std::uint32_t g = 0; g < image.groups.size(); ++g) {
      if (key == 0 || image.groups[g].receptor_count > 0) {
        starts.emplace_back(first_of(image.groups[g]), g);
      }
    }
    std::sort(starts.begin(), starts.end());
    return starts;
  };
  const auto by_slot = order_of(1, [](const GroupRecord& group) { return group.first_slot; });
  const auto group_of_slot = [&](std::uint32_t slot) {
    const auto after = std::upper_bound(by_slot.begin(), by_slot.end(), std::pair{slot, 0xFFFFFFFFU});
    return std::prev(after)->second;
  };
  for (std::uint32_t g = 0; g < image.groups.size(); ++g) {
    const GroupRecord& group = image.groups[g];
    for (std::uint32_t i = 0; i < group.size; ++i) {
      const std::uint32_t neuron = group.first_neuron + i;
      const std::uint32_t first = image.row_begin[neuron];
      if (first == image.row_begin[neuron + 1] || image.segments[first].delay_ticks != 0) {
        continue;  // delays ascend, so only a row's first segment can have delay 0
      }
      for (std::uint32_t t = image.segments[first].target_begin; t < image.segments[first + 1].target_begin; ++t) {
        if (group_of_slot(image.targets[t]) <= g) {
          return "neuron " + number(neuron) + " has a same-tick synapse onto a group that is not updated after its own";
        }
      }
    }
  }
  return {};
}

std::string verify_projections(const SpikeImage& image) {
  const auto count = static_cast<std::uint32_t>(image.populations.size());
  std::vector<std::uint32_t> receptor_counts(count, 0);
  for (const GroupRecord& group : image.groups) {
    receptor_counts[group.population] = std::max(receptor_counts[group.population], group.receptor_count);
  }
  for (std::size_t p = 0; p < image.projections.size(); ++p) {
    const ProjectionRecord& projection = image.projections[p];
    const bool is_named = projection.name < image.strings.size() &&
                          (projection.cite == kNoString || projection.cite < image.strings.size());
    if (!is_named || projection.pre_population >= count || projection.post_population >= count ||
        projection.receptor >= receptor_counts[projection.post_population]) {
      return "projection " + number(p) + " names a string, population or receptor that does not exist";
    }
  }
  return {};
}

}  // namespace

std::string verify_synapses(const SpikeImage& image) {
  for (const auto check : {verify_rows, verify_segments, verify_targets, verify_same_tick_order, verify_projections}) {
    std::string error = check(image);
    if (!error.empty()) {
      return error;
    }
  }
  return {};
}

}  // namespace tectum
