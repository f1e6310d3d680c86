#include "runtime/engine/block_runner.h"

#include <algorithm>
#include <numeric>

namespace tectum {
namespace {

// Parts begin at multiples of so many neurons: whole words of a group's sleep marks and their summary.
constexpr std::uint32_t kSleepingPartNeurons = kWordBits * kWordBits;

// Shares the groups out: divisible ones to all, neuron by neuron, the others to whoever has least.
std::vector<std::vector<GroupPart>> share_out(const SpikeImage& image, const UpdateGroups& groups, unsigned count) {
  std::vector<std::vector<GroupPart>> shares(count);
  std::vector<std::uint64_t> load(count, 0);
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const std::uint32_t size = image.groups[g].size;
    const std::uint32_t grain = groups[g]->wants_marks() ? kSleepingPartNeurons : kWordBits;
    const bool is_shared = groups[g]->is_divisible() && size >= grain * count;
    std::uint32_t begin = 0;
    for (unsigned m = 0; m < count && is_shared; ++m) {
      const std::uint32_t end =
          m + 1 == count ? size : static_cast<std::uint32_t>(std::uint64_t{size} * (m + 1) / count / grain * grain);
      shares[m].push_back({g, begin, end});
      load[m] += end - begin;
      begin = end;
    }
    if (!is_shared) {
      const auto least = std::min_element(load.begin(), load.end());
      shares[static_cast<std::size_t>(least - load.begin())].push_back({g, 0, size});
      *least += size;
    }
  }
  return shares;
}

}  // namespace

BlockRunner::BlockRunner(const SpikeImage& image, const UpdateGroups& groups, unsigned threads)
    : image_(image),
      slice_(shortest_delay_ticks(image)),
      ranges_(image),
      inputs_(image.header.slot_count),
      spikes_(std::make_unique_for_overwrite<NeuronId[]>(std::size_t{image.header.neuron_count} * slice_)) {
  const BlockNetwork network{image, groups, ranges_, inputs_.data()};
  for (std::vector<GroupPart>& parts : share_out(image, groups, threads)) {
    partitions_.push_back(std::make_unique<BlockPartition>(network, std::move(parts), threads > 1));
  }
  if (threads > 1) {
    team_ = std::make_unique<ThreadTeam>(threads);
  }
}

void BlockRunner::reset() noexcept {
  std::fill(inputs_.begin(), inputs_.end(), 0);
  for (const auto& partition : partitions_) {
    partition->reset();
  }
  spike_count_ = {};
}

void BlockRunner::work(unsigned member) noexcept {
  BlockPartition& own = *partitions_[member];
  own.run(now_);
  if (team_ != nullptr) {
    team_->meet();
  }
  for (const auto& partition : partitions_) {
    own.receive(now_, *partition);
  }
}

std::uint32_t BlockRunner::advance(std::uint64_t tick, std::uint64_t at_most, InjectedSpikes injected) noexcept {
  const auto ticks = static_cast<std::uint32_t>(std::min<std::uint64_t>(at_most, slice_));
  now_ = {tick, ticks, injected};
  if (team_ != nullptr) {
    team_->run([](void* self, unsigned member) noexcept { static_cast<BlockRunner*>(self)->work(member); }, this);
  } else {
    work(0);
  }
  for (std::uint32_t k = 0; k < ticks; ++k) {
    NeuronId* const first = spikes_.get() + std::size_t{k} * image_.header.neuron_count;
    NeuronId* last = first;
    for (const auto& partition : partitions_) {
      for (const std::uint32_t neuron : partition->spikes(k)) {
        *last++ = NeuronId{neuron};
      }
    }
    if (!std::is_sorted(first, last)) {
      std::sort(first, last);
    }
    spike_count_[k] = static_cast<std::uint32_t>(last - first);
  }
  return ticks;
}

void BlockRunner::add_input(std::uint32_t slot, std::int32_t quanta) noexcept {
  for (const auto& partition : partitions_) {
    partition->add_input(slot, quanta);
  }
}

void BlockRunner::rouse(std::uint32_t group) noexcept {
  for (const auto& partition : partitions_) {
    partition->rouse(group);
  }
}

std::uint64_t BlockRunner::synaptic_events() const noexcept {
  std::uint64_t events = 0;
  for (const auto& partition : partitions_) {
    events += partition->event_count();
  }
  return events;
}

std::uint64_t BlockRunner::dropped_rows() const noexcept {
  std::uint64_t dropped = 0;
  for (const auto& partition : partitions_) {
    dropped = std::max(dropped, partition->dropped_rows());
  }
  return dropped;
}

}  // namespace tectum
