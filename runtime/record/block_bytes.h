// Little-endian numbers into and out of a block's payload. Internal to runtime/record.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace tectum {

/// Appends to a buffer. Allocates only beyond what was reserved.
class BlockWriter {
 public:
  std::vector<std::byte> bytes;

  template <typename Number>
  void put(Number value) {
    static_assert(std::is_arithmetic_v<Number> && std::endian::native == std::endian::little);
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
  }
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    bytes.insert(bytes.end(), begin, begin + text.size());
  }
  template <typename Range>
  void put_all(const Range& values) {
    for (const auto value : values) {
      put(value);
    }
  }
};

/// Reads a payload. Past its end everything is zero and is_whole() is false; no count is trusted before it is checked.
class BlockReader {
 public:
  explicit BlockReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <typename Number>
  void get(Number& value) {
    static_assert(std::is_arithmetic_v<Number>);
    value = {};
    if (rest_.size() < sizeof value) {
      fail();
      return;
    }
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_ = rest_.subspan(sizeof value);
  }
  template <typename Number>
  [[nodiscard]] Number get() {
    Number value;
    get(value);
    return value;
  }
  void get_text(std::string& text) {
    const auto size = get<std::uint32_t>();
    if (size > rest_.size()) {
      fail();
      return;
    }
    text.assign(reinterpret_cast<const char*>(rest_.data()), size);
    rest_ = rest_.subspan(size);
  }
  template <typename Range>
  void get_all(Range& values) {
    for (auto& value : values) {
      get(value);
    }
  }
  /// A count of elements of at least `element_bytes` each, or 0 when so many cannot follow.
  [[nodiscard]] std::uint32_t get_count(std::size_t element_bytes) {
    const auto count = get<std::uint32_t>();
    if (count > rest_.size() / element_bytes) {
      fail();
      return 0;
    }
    return count;
  }
  [[nodiscard]] bool is_whole() const { return !has_failed_; }
  [[nodiscard]] bool is_at_end() const { return rest_.empty(); }

 private:
  void fail() {
    has_failed_ = true;
    rest_ = {};
  }
  std::span<const std::byte> rest_;
  bool has_failed_ = false;
};

}  // namespace tectum
