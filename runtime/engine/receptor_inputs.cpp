#include "runtime/engine/receptor_inputs.h"

#include <algorithm>

namespace tectum {
namespace {

// Below this an exponential current counts as 0, so that it never becomes subnormal.
constexpr double kDust = 0x1p-500;

}  // namespace

ReceptorInputs::ReceptorInputs(const SpikeImage& image, const GroupRecord& group)
    : size_(group.size), values_(std::size_t{group.receptor_count} * group.size) {
  const GroupParameters parameters(image, group);
  for (std::uint32_t r = 0; r < group.receptor_count; ++r) {
    const ReceptorRecord& record = parameters.receptor(r);
    Receptor receptor{record.kind, parameters.quantum(r), parameters.receptor_decay(r), {}, {}, record.window_ticks};
    if (record.kind == ReceptorKind::Boxcar) {
      receptor.history.resize(std::size_t{record.window_ticks} * size_);
      receptor.window_sum.resize(size_);
    }
    receptors_.push_back(std::move(receptor));
  }
}

void ReceptorInputs::reset() noexcept {
  for (Receptor& receptor : receptors_) {
    std::fill(receptor.history.begin(), receptor.history.end(), 0);
    std::fill(receptor.window_sum.begin(), receptor.window_sum.end(), 0);
  }
  std::fill(values_.begin(), values_.end(), 0.0);
}

void ReceptorInputs::advance(std::uint64_t tick, std::int32_t* inputs) noexcept {
  for (std::size_t r = 0; r < receptors_.size(); ++r) {
    Receptor& receptor = receptors_[r];
    std::int32_t* const arrived = inputs + r * size_;
    double* const values = values_.data() + r * size_;
    switch (receptor.kind) {
      case ReceptorKind::Instantaneous:
        for (std::uint32_t i = 0; i < size_; ++i) {
          values[i] = receptor.quantum * arrived[i];
        }
        break;
      case ReceptorKind::Exponential:
        for (std::uint32_t i = 0; i < size_; ++i) {
          const double decayed = receptor.decay * values[i];
          values[i] = (decayed < kDust && decayed > -kDust ? 0.0 : decayed) + receptor.quantum * arrived[i];
        }
        break;
      case ReceptorKind::Boxcar: {
        std::int32_t* const oldest = receptor.history.data() + (tick % receptor.window_ticks) * size_;
        for (std::uint32_t i = 0; i < size_; ++i) {
          receptor.window_sum[i] += std::int64_t{arrived[i]} - oldest[i];
          oldest[i] = arrived[i];
          values[i] = receptor.quantum * static_cast<double>(receptor.window_sum[i]);
        }
        break;
      }
    }
    std::fill(arrived, arrived + size_, 0);
  }
}

double ReceptorInputs::sum(std::uint32_t neuron) const noexcept {
  double total = 0;
  for (std::size_t r = 0; r < receptors_.size(); ++r) {
    total += values_[r * size_ + neuron];
  }
  return total;
}

}  // namespace tectum
