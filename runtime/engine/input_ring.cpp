#include "runtime/engine/input_ring.h"

#include <algorithm>

#include "runtime/engine/group_parameters.h"

namespace tectum {
namespace {

constexpr std::size_t kWordBits = 64;

// The loops over synapses. `inputs` is the accumulator of slot 0.

void add_weights(std::int32_t* inputs, const std::uint32_t* target, const std::uint32_t* end,
                 const std::int32_t* weight) noexcept {
  for (; target != end; ++target, ++weight) {
    inputs[*target] = add_quanta(inputs[*target], *weight);
  }
}

void add_one_weight(std::int32_t* inputs, const std::uint32_t* target, const std::uint32_t* end,
                    std::int32_t weight) noexcept {
  for (; target != end; ++target) {
    inputs[*target] = add_quanta(inputs[*target], weight);
  }
}

}  // namespace

InputRing::InputRing(const SpikeImage& image, const std::vector<std::unique_ptr<UpdateGroup>>& groups,
                     std::uint32_t tick_count)
    : image_(image),
      ranges_(image),
      stride_(image.header.slot_count),
      group_words_((groups.size() + kWordBits - 1) / kWordBits) {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const GroupRecord& record = image.groups[g];
    Group group{record.first_slot, groups[g]->wants_marks(), mark_stride_, touched_stride_, {}};
    if (group.is_marked) {
      mark_stride_ += (record.size + kWordBits - 1) / kWordBits;
      touched_stride_ += record.size + 1;  // a neuron that is listed already is written behind the end
      const std::vector<const void*> hot = groups[g]->hot_arrays();
      for (std::size_t h = 0; h < kMaxHotArrays; ++h) {
        group.hot[h] = static_cast<const std::uint32_t*>(hot[std::min(h, hot.size() - 1)]);
      }
    }
    groups_.push_back(group);
  }
  inputs_.resize(stride_ * tick_count);
  marks_.resize(mark_stride_ * tick_count);
  touched_ = std::make_unique_for_overwrite<std::uint32_t[]>(touched_stride_ * tick_count);
  touched_count_.resize(groups.size() * tick_count);
  has_input_.resize(group_words_ * tick_count);
}

void InputRing::clear() noexcept {
  std::fill(inputs_.begin(), inputs_.end(), 0);
  std::fill(marks_.begin(), marks_.end(), std::uint64_t{0});
  std::fill(touched_count_.begin(), touched_count_.end(), 0U);
  std::fill(has_input_.begin(), has_input_.end(), std::uint64_t{0});
}

void InputRing::clear_touched(std::uint32_t k, std::uint32_t group) noexcept {
  std::uint64_t* const marks = marks_.data() + k * mark_stride_ + groups_[group].mark_begin;
  for (const std::uint32_t neuron : touched(k, group)) {
    marks[neuron / kWordBits] = 0;
  }
  touched_count_[k * groups_.size() + group] = 0;
}

// Lists each target that is not listed yet, and starts to load what its group will need of it.
void InputRing::deliver_marked_run(std::uint32_t k, const SlotRange& range, const Run& run) noexcept {
  const Group& group = groups_[range.group];
  std::int32_t* const inputs = inputs_.data() + k * stride_;
  std::uint64_t* const marks = marks_.data() + k * mark_stride_ + group.mark_begin;
  std::uint32_t* const touched = touched_.get() + k * touched_stride_ + group.touched_begin;
  std::uint32_t& touched_count = touched_count_[k * groups_.size() + range.group];
  std::uint32_t count = touched_count;
  const std::int32_t* weight = run.weight;
  for (const std::uint32_t* target = run.target; target != run.end; ++target) {
    inputs[*target] = add_quanta(inputs[*target], *weight);
    weight += run.has_one_weight ? 0 : 1;
    const std::uint32_t neuron = *target - range.begin;
    const std::uint64_t word = marks[neuron / kWordBits];
    touched[count] = neuron;
    count += static_cast<std::uint32_t>(~(word >> (neuron % kWordBits)) & 1U);
    marks[neuron / kWordBits] = word | (std::uint64_t{1} << (neuron % kWordBits));
    for (const std::uint32_t* hot : group.hot) {
      __builtin_prefetch(hot + neuron, 1);
    }
  }
  touched_count = count;
}

void InputRing::deliver_run(std::uint32_t k, const SlotRange& range, const Run& run) noexcept {
  has_input_[k * group_words_ + range.group / kWordBits] |= std::uint64_t{1} << (range.group % kWordBits);
  std::int32_t* const inputs = inputs_.data() + k * stride_;
  if (groups_[range.group].is_marked) {
    deliver_marked_run(k, range, run);
  } else if (run.has_one_weight) {
    add_one_weight(inputs, run.target, run.end, *run.weight);
  } else {
    add_weights(inputs, run.target, run.end, run.weight);
  }
}

void InputRing::deliver(std::uint32_t k, std::uint32_t index) noexcept {
  const SegmentRecord& segment = image_.segments[index];
  const std::uint32_t* const end = image_.targets.data() + image_.segments[index + 1].target_begin;
  Run run{image_.targets.data() + segment.target_begin, end, image_.weights.data() + segment.weight_begin,
          (segment.flags & kSegmentOneWeight) != 0};
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

void InputRing::prefetch(std::uint32_t index) const noexcept {
  const SegmentRecord& segment = image_.segments[index];
  __builtin_prefetch(image_.targets.data() + segment.target_begin);
  __builtin_prefetch(image_.weights.data() + segment.weight_begin);
}

void InputRing::add(std::uint32_t k, std::uint32_t slot, std::int32_t quanta) noexcept {
  const Run run{&slot, &slot + 1, &quanta, true};
  deliver_run(k, ranges_.of(slot), run);
}

}  // namespace tectum
