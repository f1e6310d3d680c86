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

void mark(std::uint64_t* touched, std::uint32_t first_slot, const std::uint32_t* target,
          const std::uint32_t* end) noexcept {
  for (; target != end; ++target) {
    const std::uint32_t neuron = *target - first_slot;
    touched[neuron / kWordBits] |= std::uint64_t{1} << (neuron % kWordBits);
  }
}

}  // namespace

InputRing::InputRing(const SpikeImage& image, const std::vector<bool>& wants_marks, std::uint32_t tick_count)
    : image_(image),
      ranges_(image),
      stride_(image.header.slot_count),
      group_words_((image.groups.size() + kWordBits - 1) / kWordBits) {
  for (std::size_t g = 0; g < image.groups.size(); ++g) {
    const GroupRecord& group = image.groups[g];
    groups_.push_back({group.first_slot, wants_marks[g], mark_stride_});
    mark_stride_ += wants_marks[g] ? (group.size + kWordBits - 1) / kWordBits : 0;
  }
  inputs_.resize(stride_ * tick_count);
  marks_.resize(mark_stride_ * tick_count);
  has_input_.resize(group_words_ * tick_count);
}

void InputRing::clear() noexcept {
  std::fill(inputs_.begin(), inputs_.end(), 0);
  std::fill(marks_.begin(), marks_.end(), std::uint64_t{0});
  std::fill(has_input_.begin(), has_input_.end(), std::uint64_t{0});
}

void InputRing::deliver_run(std::uint32_t k, const SlotRange& range, const Run& run) noexcept {
  has_input_[k * group_words_ + range.group / kWordBits] |= std::uint64_t{1} << (range.group % kWordBits);
  std::int32_t* const inputs = inputs_.data() + k * stride_;
  if (run.has_one_weight) {
    add_one_weight(inputs, run.target, run.end, *run.weight);
  } else {
    add_weights(inputs, run.target, run.end, run.weight);
  }
  if (std::uint64_t* const marks = touched(k, range.group)) {
    mark(marks, range.begin, run.target, run.end);
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
