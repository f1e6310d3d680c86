// A group of neurons of one model: its state and how a tick changes it.
#pragma once

#include <cstdint>
#include <memory>

#include "runtime/engine/spike_engine.h"
#include "runtime/image/load_image.h"

namespace tectum {

/// What a group needs to advance by one tick.
struct GroupTick {
  std::uint64_t tick;
  std::int32_t* inputs;           // this group's accumulators: [receptor][neuron]; the group zeroes what it consumes
  std::uint32_t* fired;           // room for every neuron of the group
  std::uint32_t fired_count = 0;  // neurons of the group (counted from 0), ascending

  void fire(std::uint32_t neuron) noexcept { fired[fired_count++] = neuron; }
};

class UpdateGroup {
 public:
  virtual ~UpdateGroup() = default;

  /// Back to the initial state. Real-time safe.
  virtual void reset() noexcept = 0;
  /// Consumes this tick's inputs and lists who fired. Real-time safe.
  virtual void advance(GroupTick& tick) noexcept = 0;
  /// State variable `column` of neuron i after `tick` ticks. Real-time safe.
  [[nodiscard]] virtual double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept = 0;
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
