#include "compiler/lower/worst_case.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/image/models.h"

namespace tectum {
namespace {

/// Two spikes of one of its neurons are at least so many ticks apart.
std::uint32_t least_interval_ticks(const GroupRecord& group, const ImageContents& image) {
  const ModelInfo* info = find_model(group.model);
  const auto parameter = info == nullptr ? std::nullopt : find_parameter(*info, "t_ref");
  if (!parameter) {
    return 1;
  }
  const double t_ref_ms = image.parameters[group.parameter_begin + *parameter];
  return 1 + static_cast<std::uint32_t>(std::llround(t_ref_ms * 1e6 / static_cast<double>(image.tick_ns)));
}

/// The most synapses of one row that can arrive in one tick: the heaviest choice of delays that differ by at least
/// `interval_ticks`. best[k] is that of the first k segments.
std::uint64_t heaviest_arrival(const ImageContents& image, std::uint32_t begin, std::uint32_t end,
                               std::uint32_t interval_ticks, std::vector<std::uint64_t>& best) {
  best.assign(1, 0);
  std::uint32_t compatible = begin;  // segments [begin, compatible) go with segment k
  for (std::uint32_t k = begin; k < end; ++k) {
    while (compatible < k && image.segments[k].delay_ticks - image.segments[compatible].delay_ticks >= interval_ticks) {
      ++compatible;
    }
    const std::uint64_t own = image.segments[k + 1].target_begin - image.segments[k].target_begin;
    best.push_back(std::max(best.back(), best[compatible - begin] + own));
  }
  return best.back();
}

}  // namespace

WorstCase worst_case(const ImageContents& image) {
  WorstCase worst;
  std::vector<std::uint64_t> best;
  for (const GroupRecord& group : image.groups) {
    const std::uint32_t interval_ticks = least_interval_ticks(group, image);
    for (std::uint32_t i = group.first_neuron; i < group.first_neuron + group.size; ++i) {
      const std::uint32_t begin = image.row_begin[i];
      const std::uint32_t end = image.row_begin[i + 1];
      worst.synaptic_events += heaviest_arrival(image, begin, end, interval_ticks, best);
      worst.longest_row =
          std::max(worst.longest_row, image.segments[end].target_begin - image.segments[begin].target_begin);
    }
  }
  worst.synapse_bytes = image.row_begin.size() * sizeof(std::uint32_t) + image.segments.size() * sizeof(SegmentRecord) +
                        image.targets.size() * sizeof(std::uint32_t) + image.weights.size() * sizeof(std::int32_t);
  return worst;
}

}  // namespace tectum
