// The loops over synapses, and the list of neurons that they touch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/engine/group_parameters.h"
#include "runtime/engine/update_group.h"

namespace tectum {

/// A run of synapses onto one receptor of one group.
struct SynapseRun {
  const std::uint32_t* target;  // slots
  const std::uint32_t* end;
  const std::int32_t* weight;
  bool has_one_weight;
};

/// `inputs` is the accumulator of slot 0.
inline void add_run(std::int32_t* inputs, const SynapseRun& run) noexcept {
  if (run.has_one_weight) {
    const std::int32_t weight = *run.weight;
    for (const std::uint32_t* target = run.target; target != run.end; ++target) {
      inputs[*target] = add_quanta(inputs[*target], weight);
    }
    return;
  }
  const std::int32_t* weight = run.weight;
  for (const std::uint32_t* target = run.target; target != run.end; ++target, ++weight) {
    inputs[*target] = add_quanta(inputs[*target], *weight);
  }
}

/// The same where the targets follow each other without a gap: a loop over vectors.
inline void add_dense_run(std::int32_t* inputs, const SynapseRun& run) noexcept {
  std::int32_t* const first = inputs + *run.target;
  const auto count = static_cast<std::size_t>(run.end - run.target);
  if (run.has_one_weight) {
    const std::int32_t weight = *run.weight;
    for (std::size_t t = 0; t < count; ++t) {
      first[t] = add_quanta(first[t], weight);
    }
    return;
  }
  for (std::size_t t = 0; t < count; ++t) {
    first[t] = add_quanta(first[t], run.weight[t]);
  }
}

/// The neurons of a group (counted from 0) that have input, each listed once.
class TouchedNeurons {
 public:
  static constexpr std::size_t kMaxHotArrays = 4;
  using HotArrays = std::array<const std::uint32_t*, kMaxHotArrays>;

  /// Needs: `marks` a bit a neuron, all 0; `list` with room for every neuron that may be touched.
  TouchedNeurons(std::uint64_t* marks, std::uint32_t* list, const HotArrays& hot)
      : marks_(marks), list_(list), hot_(hot) {}

  [[nodiscard]] const std::uint32_t* list() const noexcept { return list_; }
  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }

  /// Delivers a run whose receptor's first slot is `first_slot`, lists its targets and starts to load
  /// what their group will need of them.
  void add_run(std::int32_t* inputs, std::uint32_t first_slot, const SynapseRun& run) noexcept {
    std::uint32_t count = count_;
    const std::int32_t* weight = run.weight;
    const std::ptrdiff_t step = run.has_one_weight ? 0 : 1;
    for (const std::uint32_t* target = run.target; target != run.end; ++target, weight += step) {
      inputs[*target] = add_quanta(inputs[*target], *weight);
      const std::uint32_t neuron = *target - first_slot;
      std::uint64_t& word = marks_[neuron / 64];
      list_[count] = neuron;
      count += static_cast<std::uint32_t>(~(word >> (neuron % 64)) & 1U);
      word |= std::uint64_t{1} << (neuron % 64);
      for (const std::uint32_t* hot : hot_) {
        __builtin_prefetch(hot + neuron, 1);
      }
    }
    count_ = count;
  }

  void clear() noexcept {
    for (std::uint32_t k = 0; k < count_; ++k) {
      marks_[list_[k] / 64] = 0;
    }
    count_ = 0;
  }

 private:
  std::uint64_t* marks_;
  std::uint32_t* list_;
  HotArrays hot_;
  std::uint32_t count_ = 0;
};

[[nodiscard]] TouchedNeurons::HotArrays hot_arrays_of(const UpdateGroup& group);

}  // namespace tectum
