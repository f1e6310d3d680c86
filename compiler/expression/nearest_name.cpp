// Suggestions for misspelt names.
#include <algorithm>
#include <cctype>

#include "compiler/expression/expression.h"

namespace tectum {
namespace {

// Optimal string alignment distance: insert, delete, replace, or swap two neighbours. Damerau 1964,
// doi:10.1145/363958.363994. A change of case counts half (distances are doubled), so "mv" is nearer
// to "mV" than to "ms".
std::size_t doubled_distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    above[j] = 2 * j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = 2 * i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = a[i - 1] == b[j - 1] ? 0 : lower(a[i - 1]) == lower(b[j - 1]) ? 1 : 2;
      row[j] = std::min({above[j] + 2, row[j - 1] + 2, above[j - 1] + replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 2);
      }
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view misspelt, std::span<const std::string> names) {
  constexpr std::size_t kLongestName = 200;  // keeps a hostile name from costing time
  if (misspelt.empty() || misspelt.size() > kLongestName) {
    return std::nullopt;
  }
  std::size_t best = 2 * std::max<std::size_t>(1, misspelt.size() / 3) + 1;
  const std::string* nearest = nullptr;
  for (const std::string& name : names) {
    if (name.empty() || name.size() > kLongestName) {
      continue;
    }
    const std::size_t distance = doubled_distance(misspelt, name);
    // A one-letter name is "near" to any other one-letter name; only its other case is a suggestion.
    if (misspelt.size() == 1 && distance > 1) {
      continue;
    }
    if (distance < best) {
      best = distance;
      nearest = &name;
    }
  }
  return nearest ? std::optional(*nearest) : std::nullopt;
}

}  // namespace tectum
