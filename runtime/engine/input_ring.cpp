#include "runtime/engine/input_ring.h"

#include <algorithm>

namespace tectum {

InputRing::InputRing(const SpikeImage& image, const UpdateGroups& groups, std::uint32_t tick_count)
    : image_(image),
      ranges_(image),
      reach_(image, ranges_, groups),
      stride_(image.header.slot_count),
      group_words_((groups.size() + kWordBits - 1) / kWordBits),
      inputs_(stride_ * tick_count),
      touched_of_(groups.size(), kNotMarked),
      has_input_(group_words_ * tick_count) {
  std::size_t words = 0;
  std::size_t neurons = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g]->wants_marks()) {
      touched_of_[g] = marked_count_++;
      words += (image.groups[g].size + kWordBits - 1) / kWordBits;
      neurons += image.groups[g].size;
    }
  }
  marks_.resize(words * tick_count);
  lists_ = std::make_unique_for_overwrite<std::uint32_t[]>((neurons + marked_count_) * tick_count);
  std::uint64_t* marks = marks_.data();
  std::uint32_t* list = lists_.get();
  for (std::uint32_t k = 0; k < tick_count; ++k) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (groups[g]->wants_marks()) {
        touched_.emplace_back(marks, list, hot_arrays_of(*groups[g]));
        marks += (image.groups[g].size + kWordBits - 1) / kWordBits;
        list += image.groups[g].size + 1;  // a neuron that is listed already is written behind the end
      }
    }
  }
}

void InputRing::clear() noexcept {
  std::fill(inputs_.begin(), inputs_.end(), 0);
  std::fill(has_input_.begin(), has_input_.end(), std::uint64_t{0});
  for (TouchedNeurons& touched : touched_) {
    touched.clear();
  }
}

void InputRing::deliver_run(std::uint32_t k, const SlotRange& range, const SynapseRun& run) noexcept {
  groups_with_input(k, range.group / kWordBits) |= std::uint64_t{1} << (range.group % kWordBits);
  std::int32_t* const inputs = inputs_.data() + k * stride_;
  if (TouchedNeurons* const listed = touched(k, range.group)) {
    listed->add_run(inputs, range.begin, run);
  } else {
    add_run(inputs, run);
  }
}

// Where a group wants to know who was touched, its own part of the segment is told to it.
void InputRing::deliver_runs(std::uint32_t k, SynapseRun run) noexcept {
  const std::uint32_t* const end = run.end;
  const std::uint32_t last = end[-1];
  while (true) {
    const SlotRange& range = ranges_.of(*run.target);
    run.end = last < range.end ? end : std::lower_bound(run.target, end, range.end);
    deliver_run(k, range, run);
    if (run.end == end) {
      return;
    }
    run.weight += run.has_one_weight ? 0 : run.end - run.target;
    run.target = run.end;
  }
}

void InputRing::deliver(std::uint32_t k, std::uint32_t index) noexcept {
  const SegmentRecord& segment = image_.segments[index];
  const SynapseRun run{image_.targets.data() + segment.target_begin,
                       image_.targets.data() + image_.segments[index + 1].target_begin,
                       image_.weights.data() + segment.weight_begin, (segment.flags & kSegmentOneWeight) != 0};
  if (reach_.wants_marks(index)) {
    deliver_runs(k, run);
    return;
  }
  const std::span<const std::uint64_t> reached = reach_.groups(index);
  for (std::size_t w = 0; w < reached.size(); ++w) {
    groups_with_input(k, w) |= reached[w];
  }
  std::int32_t* const inputs = inputs_.data() + k * stride_;
  if (reach_.is_dense(index)) {
    add_dense_run(inputs, run);
  } else {
    add_run(inputs, run);
  }
}

void InputRing::prefetch(std::uint32_t index) const noexcept {
  const SegmentRecord& segment = image_.segments[index];
  __builtin_prefetch(image_.targets.data() + segment.target_begin);
  __builtin_prefetch(image_.weights.data() + segment.weight_begin);
}

void InputRing::add(std::uint32_t k, std::uint32_t slot, std::int32_t quanta) noexcept {
  const SynapseRun run{&slot, &slot + 1, &quanta, true};
  deliver_run(k, ranges_.of(slot), run);
}

}  // namespace tectum
