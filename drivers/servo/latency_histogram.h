// How long things took, in steps of 10 us up to 40 ms, in constant memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "runtime/ports/frame.h"

namespace tectum {

class LatencyHistogram {
 public:
  void add(TimeNs latency_ns) noexcept {
    const auto bin = static_cast<std::size_t>(std::clamp<TimeNs>(latency_ns / kBinNs, 0, kBins - 1));
    ++bins_[bin];
    ++count_;
    longest_ns_ = std::max(longest_ns_, latency_ns);
  }
  /// The upper end of the bin that holds this share of all, e.g. 0.99; 0 when there are none.
  [[nodiscard]] TimeNs quantile_ns(double share) const noexcept {
    const double wanted = share * static_cast<double>(count_);
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < bins_.size() && count_ > 0; ++bin) {
      seen += bins_[bin];
      if (static_cast<double>(seen) >= wanted) {
        return std::min(static_cast<TimeNs>(bin + 1) * kBinNs, longest_ns_);
      }
    }
    return longest_ns_;
  }
  [[nodiscard]] TimeNs longest_ns() const noexcept { return longest_ns_; }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

 private:
  static constexpr TimeNs kBinNs = 10'000;
  static constexpr TimeNs kBins = 4000;
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  TimeNs longest_ns_ = 0;
};

}  // namespace tectum
