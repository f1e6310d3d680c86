// Cells by the names that data give them. A name is any text: "29", "MBON-a1".
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tectum {

/// Numbers the names that it is given in the order in which they first come. An edge list asks for two names a row,
/// millions of times and all over the place, so a look-up of a number of up to 19 digits, which most are, costs one
/// cache line: open addressing with linear probing, the number itself in the slot. Other names cost their text too.
class CellNumbers {
 public:
  /// The number of `name`, and whether it is new.
  std::pair<std::uint32_t, bool> add(std::string_view name) {
    if (2 * (size() + 1) > slots_.size()) {
      grow();
    }
    const Key key = key_of(name);
    Slot& slot = slots_[place_of(name, key)];
    if (slot.number != kNone) {
      return {slot.number, false};
    }
    slot = {key.value, size(), key.is_decimal};
    text_ += name;
    ends_.push_back(text_.size());
    return {slot.number, true};
  }
  [[nodiscard]] std::optional<std::uint32_t> find(std::string_view name) const {
    if (slots_.empty()) {
      return std::nullopt;
    }
    const std::uint32_t number = slots_[place_of(name, key_of(name))].number;
    return number == kNone ? std::nullopt : std::optional(number);
  }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(ends_.size()); }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  struct Key {
    std::uint64_t value;  // the number that a decimal name is, or the hash of another one
    bool is_decimal;
  };
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t number = kNone;
    bool is_decimal = false;
  };

  static Key key_of(std::string_view name) {
    constexpr std::size_t kMostDigits = 19;  // any such number is below 2^64
    const bool has_leading_zero = name.size() > 1 && name[0] == '0';
    std::uint64_t value = 0;
    bool is_decimal = !name.empty() && name.size() <= kMostDigits && !has_leading_zero;
    for (std::size_t k = 0; k < name.size() && is_decimal; ++k) {
      is_decimal = name[k] >= '0' && name[k] <= '9';
      value = 10 * value + static_cast<std::uint64_t>(name[k] - '0');
    }
    return is_decimal ? Key{value, true} : Key{std::hash<std::string_view>{}(name), false};
  }

  [[nodiscard]] std::string_view name(std::uint32_t number) const {
    const std::size_t begin = number == 0 ? 0 : ends_[number - 1];
    return std::string_view(text_).substr(begin, ends_[number] - begin);
  }

  /// Where the name is, or the empty slot where it would be.
  [[nodiscard]] std::size_t place_of(std::string_view wanted, const Key& key) const {
    constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15U;  // spreads what comes in sequence
    constexpr unsigned kHalf = 32;
    const std::uint64_t spread = key.value * kGoldenRatio;
    const std::size_t mask = slots_.size() - 1;
    std::size_t place = (spread ^ (spread >> kHalf)) & mask;
    while (slots_[place].number != kNone && !is_at(slots_[place], wanted, key)) {
      place = (place + 1) & mask;
    }
    return place;
  }
  [[nodiscard]] bool is_at(const Slot& slot, std::string_view wanted, const Key& key) const {
    return slot.key == key.value && slot.is_decimal == key.is_decimal &&
           (key.is_decimal || name(slot.number) == wanted);
  }

  void grow() {
    constexpr std::size_t kFewest = 64;
    const std::vector<Slot> old = std::move(slots_);
    slots_.assign(old.empty() ? kFewest : 2 * old.size(), Slot{});  // a power of two
    for (const Slot& slot : old) {
      if (slot.number != kNone) {
        slots_[place_of(name(slot.number), {slot.key, slot.is_decimal})] = slot;
      }
    }
  }

  std::vector<Slot> slots_;
  std::string text_;               // all names, one after the other
  std::vector<std::size_t> ends_;  // of each name
};

}  // namespace tectum
