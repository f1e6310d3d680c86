// Hands the newest value from one thread to one other. Neither ever waits; what was not taken in time is overwritten.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace tectum {

/// Three slots: one is the writer's, one the reader's, and the third, the newest, changes hands. Real-time safe.
template <typename T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Writer's thread.
  void put(const T& value) noexcept {
    slots_[writing_] = value;
    writing_ = middle_.exchange(writing_ | kIsNew, std::memory_order_acq_rel) & kSlot;
  }
  /// Reader's thread: whether take() would give something.
  [[nodiscard]] bool has_new() const noexcept { return (middle_.load(std::memory_order_relaxed) & kIsNew) != 0; }
  /// Reader's thread. False, and `out` untouched, when nothing was put since the last take.
  [[nodiscard]] bool take(T& out) noexcept {
    if (!has_new()) {
      return false;
    }
    reading_ = middle_.exchange(reading_, std::memory_order_acq_rel) & kSlot;
    out = slots_[reading_];
    return true;
  }

 private:
  static constexpr std::uint32_t kSlot = 3;
  static constexpr std::uint32_t kIsNew = 4;
  std::array<T, 3> slots_{};
  std::uint32_t writing_ = 0;
  std::uint32_t reading_ = 1;
  std::atomic<std::uint32_t> middle_ = 2;
};

}  // namespace tectum
