// What the receptors of a threshold or Izhikevich group make of the quanta that arrive: this
// tick's, an exponentially decaying current, or the sum over the last k ticks.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/engine/group_parameters.h"

namespace tectum {

class ReceptorInputs {
 public:
  ReceptorInputs(const SpikeImage& image, const GroupRecord& group);

  void reset() noexcept;
  /// Consumes receptor accumulators of one tick, for all neurons, and leaves the physical input in
  /// value(). An exponential current decays first, then takes the arrivals, which act in this tick.
  void advance(std::uint64_t tick, std::int32_t* inputs) noexcept;
  /// Input of receptor r in its physical unit.
  [[nodiscard]] double value(std::uint32_t r, std::uint32_t neuron) const noexcept {
    return values_[std::size_t{r} * size_ + neuron];
  }
  /// Inputs of receptor r, neuron by neuron.
  [[nodiscard]] const double* values(std::uint32_t r) const noexcept { return values_.data() + std::size_t{r} * size_; }
  /// Sum over the receptors, in their order.
  [[nodiscard]] double sum(std::uint32_t neuron) const noexcept;
  [[nodiscard]] std::uint32_t receptor_count() const noexcept { return static_cast<std::uint32_t>(receptors_.size()); }

 private:
  struct Receptor {
    ReceptorKind kind;
    double quantum;
    double decay;
    std::vector<std::int32_t> history;  // boxcar: [tick % window][neuron]
    std::vector<std::int64_t> window_sum;
    std::uint32_t window_ticks;
  };

  std::uint32_t size_;
  std::vector<Receptor> receptors_;
  std::vector<double> values_;  // [receptor][neuron]
};

}  // namespace tectum
