#include "compiler/elaborate/mirror_partner.h"

#include <algorithm>
#include <optional>

namespace tectum {
namespace {

using Sides = std::pair<std::string, std::string>;

std::string swapped_word(std::string_view word, const Sides& sides) {
  if (word == sides.first) {
    return sides.second;
  }
  if (word == sides.second) {
    return sides.first;
  }
  const bool is_left_right = (sides.first == "left" && sides.second == "right") ||  //
                             (sides.first == "right" && sides.second == "left");
  if (is_left_right && word.size() == 1) {
    const std::size_t at = std::string_view("LRlr").find(word.front());
    return at == std::string_view::npos ? std::string(word) : std::string(1, "RLrl"[at]);
  }
  return std::string(word);
}

/// The population of the swapped name, if it is another one of the same shape.
std::optional<std::size_t> named_partner(const Circuit& circuit, std::size_t p, const Sides& sides) {
  const Population& own = circuit.populations[p];
  const std::string name = swap_side_words(own.name, sides);
  if (name == own.name) {
    return std::nullopt;
  }
  const auto found = std::find_if(circuit.populations.begin(), circuit.populations.end(), [&](const Population& other) {
    return other.name == name && other.model == own.model && other.size == own.size && other.axes == own.axes &&
           other.receptors.size() == own.receptors.size();
  });
  if (found == circuit.populations.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - circuit.populations.begin());
}

}  // namespace

std::string swap_side_words(std::string_view name, const Sides& sides) {
  std::string swapped;
  for (std::size_t at = 0; at <= name.size();) {
    const std::size_t end = std::min(name.find_first_of("_-.", at), name.size());
    swapped += swapped_word(name.substr(at, end - at), sides);
    swapped += name.substr(end, 1);
    at = end + 1;
  }
  return swapped;
}

std::vector<std::size_t> mirror_partners(const Circuit& circuit, const std::vector<AxisId>& axes, const Sides& sides) {
  std::vector<std::size_t> partners(circuit.instances.size());
  for (std::size_t p = 0; p < circuit.populations.size(); ++p) {
    const Population& own = circuit.populations[p];
    const Population& other = circuit.populations[named_partner(circuit, p, sides).value_or(p)];
    for (std::size_t k = 0; k < own.instance_count; ++k) {
      const std::size_t i = index_of(own.first_instance) + k;
      std::vector<std::uint32_t> mirrored = circuit.instances[i].sides;
      for (std::size_t a = 0; a < mirrored.size(); ++a) {
        const bool is_swapped = std::find(axes.begin(), axes.end(), own.axes[a]) != axes.end();
        mirrored[a] = is_swapped ? 1 - mirrored[a] : mirrored[a];
      }
      partners[i] = i;
      for (std::size_t j = 0; j < other.instance_count; ++j) {
        const std::size_t candidate = index_of(other.first_instance) + j;
        partners[i] = circuit.instances[candidate].sides == mirrored ? candidate : partners[i];
      }
    }
  }
  return partners;
}

bool has_named_pairs(const Circuit& circuit, const Sides& sides) {
  for (std::size_t p = 0; p < circuit.populations.size(); ++p) {
    if (named_partner(circuit, p, sides)) {
      return true;
    }
  }
  return false;
}

}  // namespace tectum
