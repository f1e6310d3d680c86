// Cells by the names that data give them. A name is any text: "29", "MBON-a1".
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace tectum {

/// Numbers the names that it is given in the order in which they first come. Looked up, never walked through.
class CellNumbers {
 public:
  /// The number of `name`, and whether it is new.
  std::pair<std::uint32_t, bool> add(std::string_view name) {
    const auto found = number_of_.find(name);
    if (found != number_of_.end()) {
      return {found->second, false};
    }
    const auto number = static_cast<std::uint32_t>(number_of_.size());
    number_of_.emplace(std::string(name), number);
    return {number, true};
  }
  [[nodiscard]] std::optional<std::uint32_t> find(std::string_view name) const {
    const auto found = number_of_.find(name);
    return found == number_of_.end() ? std::nullopt : std::optional(found->second);
  }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(number_of_.size()); }

 private:
  struct TextHash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
  };
  std::unordered_map<std::string, std::uint32_t, TextHash, std::equal_to<>> number_of_;
};

}  // namespace tectum
