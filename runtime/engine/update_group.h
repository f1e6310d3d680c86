// A group of neurons of one model: its state and how a tick changes it.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "runtime/engine/spike_engine.h"
#include "runtime/image/load_image.h"

namespace tectum {

inline constexpr std::uint64_t kNeverTick = std::numeric_limits<std::uint64_t>::max();

/// What a group needs to advance neurons [begin, end) by one tick.
struct GroupTick {
  std::uint64_t tick;
  std::uint32_t begin;           // a multiple of 64
  std::uint32_t end;             // a multiple of 64 or the group's size
  std::int32_t* inputs;          // [receptor][group size] accumulators; the group zeroes what it consumes
  const std::uint32_t* touched;  // neurons that have input, each once, in any order; only if wants_marks()
  std::uint32_t touched_count;
  std::uint32_t* fired;           // room for every neuron of [begin, end)
  std::uint32_t fired_count = 0;  // out: neurons of the group (counted from 0), ascending
  std::uint64_t idle_until = 0;   // out: before this tick nothing happens in [begin, end) without input

  void fire(std::uint32_t neuron) noexcept { fired[fired_count++] = neuron; }
};

class UpdateGroup {
 public:
  UpdateGroup() = default;
  UpdateGroup(const UpdateGroup&) = delete;
  UpdateGroup& operator=(const UpdateGroup&) = delete;
  virtual ~UpdateGroup() = default;

  /// Back to the initial state. Real-time safe.
  virtual void reset() noexcept = 0;
  /// Consumes this tick's inputs and lists who fired. Real-time safe.
  virtual void advance(GroupTick& tick) noexcept = 0;
  /// State variable `column` of neuron i after `tick` ticks. Real-time safe.
  [[nodiscard]] virtual double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept = 0;

  /// Parts of the group may be advanced apart, each by its own thread.
  [[nodiscard]] virtual bool is_divisible() const noexcept { return false; }
  /// Who delivers input also lists the neuron in GroupTick::touched.
  [[nodiscard]] virtual bool wants_marks() const noexcept { return false; }
  /// Arrays of 4-byte elements, one a neuron, that a touched neuron will need.
  [[nodiscard]] virtual std::vector<const void*> hot_arrays() const { return {}; }
  /// Only a FieldSource listens. Real-time safe.
  virtual void set_active(std::uint32_t neuron, bool is_active) noexcept {
    (void)neuron;
    (void)is_active;
  }
};

/// Not real-time safe: allocates the group's state.
[[nodiscard]] std::unique_ptr<UpdateGroup> make_update_group(const SpikeImage& image, const GroupRecord& group,
                                                             const EngineOptions& options);

}  // namespace tectum
