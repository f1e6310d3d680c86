// Rows of a table that are at fault: how many, and the first ten of them.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tectum {

struct BadRows {
  static constexpr std::size_t kNamed = 10;
  std::uint64_t count = 0;
  std::vector<std::string> named;  // "path:line: reason"

  void add(std::string row) {
    ++count;
    if (named.size() < kNamed) {
      named.push_back(std::move(row));
    }
  }
};

}  // namespace tectum
