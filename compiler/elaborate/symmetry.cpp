#include "compiler/elaborate/symmetry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace tectum {
namespace {

constexpr std::uint32_t kNoImage = 0xFFFFFFFFU;

class Mirror {
 public:
  Mirror(const Circuit& circuit, const Network& network, std::vector<AxisId> axes)
      : circuit_(circuit), network_(network), axes_(std::move(axes)) {
    const std::vector<std::string>& sides = circuit.axes[index_of(axes_.front())].sides;
    flips_x_ = std::set<std::string>(sides.begin(), sides.end()) == std::set<std::string>{"left", "right"};
    flips_y_ = std::set<std::string>(sides.begin(), sides.end()) == std::set<std::string>{"down", "up"};
    image_.assign(network.neuron_count(), kNoImage);
    for (std::size_t i = 0; i < circuit.instances.size(); ++i) {
      map_neurons(i, partner(i));
    }
  }

  SymmetryVerdict verdict() {
    SymmetryVerdict verdict;
    for (const AxisId axis : axes_) {
      verdict.axes += (verdict.axes.empty() ? "" : ", ") + circuit_.axes[index_of(axis)].name;
    }
    const std::vector<std::string>& sides = circuit_.axes[index_of(axes_.front())].sides;
    verdict.sides = sides[0] + "/" + sides[1];
    for (const Population& population : circuit_.populations) {
      if (differs(population)) {
        verdict.broken_by.push_back("population " + population.name);
      }
    }
    const std::set<std::size_t> broken = unmatched_projections(verdict.unmatched_synapses);
    for (const std::size_t p : broken) {
      verdict.broken_by.push_back("projection " + circuit_.projections[p].name);
    }
    return verdict;
  }

 private:
  /// The same population with its sides swapped on these axes.
  std::size_t partner(std::size_t i) const {
    const Instance& instance = circuit_.instances[i];
    const Population& population = circuit_.populations[index_of(instance.population)];
    std::vector<std::uint32_t> sides = instance.sides;
    for (std::size_t a = 0; a < sides.size(); ++a) {
      const bool is_swapped = std::find(axes_.begin(), axes_.end(), population.axes[a]) != axes_.end();
      sides[a] = is_swapped ? 1 - sides[a] : sides[a];
    }
    for (std::size_t k = 0; k < population.instance_count; ++k) {
      if (circuit_.instances[index_of(population.first_instance) + k].sides == sides) {
        return index_of(population.first_instance) + k;
      }
    }
    return i;
  }

  using Place = std::pair<std::int64_t, std::int64_t>;
  /// Places are compared to a millionth of a degree, metre or unit.
  static Place place(double x, double y) { return {std::llround(x * 1e6), std::llround(y * 1e6)}; }

  void map_neurons(std::size_t from, std::size_t to) {
    const NetworkPopulation& source = network_.populations[from];
    const NetworkPopulation& target = network_.populations[to];
    const Instance& a = circuit_.instances[from];
    const Instance& b = circuit_.instances[to];
    const bool has_places = (flips_x_ || flips_y_) && !a.x.empty() && a.x.size() == b.x.size();
    std::map<Place, std::uint32_t> at;
    for (std::uint32_t i = 0; has_places && i < target.size; ++i) {
      at.emplace(place(b.x[i], b.y[i]), i);
    }
    for (std::uint32_t i = 0; i < source.size; ++i) {
      std::uint32_t image = i;
      if (has_places) {
        const auto found = at.find(place(flips_x_ ? -a.x[i] : a.x[i], flips_y_ ? -a.y[i] : a.y[i]));
        image = found == at.end() ? kNoImage : found->second;
      }
      image_[source.first_neuron + i] = image == kNoImage ? kNoImage : target.first_neuron + image;
    }
  }

  bool differs(const Population& population) const {
    for (std::size_t k = 0; k < population.instance_count; ++k) {
      const std::size_t i = index_of(population.first_instance) + k;
      const NetworkPopulation& own = network_.populations[i];
      const NetworkPopulation& other = network_.populations[partner(i)];
      for (std::uint32_t n = 0; n < own.size; ++n) {
        if (image_[own.first_neuron + n] == kNoImage) {
          return true;
        }
      }
      if (own.silenced_neurons != other.silenced_neurons || own.spike_ticks != other.spike_ticks ||
          !has_same_parameters(own, other)) {
        return true;
      }
    }
    return false;
  }

  bool has_same_parameters(const NetworkPopulation& own, const NetworkPopulation& other) const {
    if (own.parameters.size() != other.parameters.size()) {
      return false;
    }
    for (const auto& [name, values] : own.parameters) {
      const auto same = other.parameters.find(name);
      if (same == other.parameters.end()) {
        return false;
      }
      const auto at = [](const std::vector<double>& list, std::uint32_t n) {
        return list.size() == 1 ? list.front() : list[n];
      };
      for (std::uint32_t n = 0; n < own.size; ++n) {
        const std::uint32_t image = image_[own.first_neuron + n] - other.first_neuron;
        if (at(values, n) != at(same->second, image)) {
          return false;
        }
      }
    }
    return true;
  }

  /// (pre and post, receptor and delay, weight), and where it comes from.
  struct Edge {
    std::array<std::uint64_t, 3> key;
    std::uint32_t pathway;
    friend bool operator<(const Edge& a, const Edge& b) { return a.key < b.key; }
  };

  Edge edge(std::size_t s, bool is_mirrored) const {
    const Synapses& synapses = network_.synapses;
    const Pathway& pathway = network_.pathways[synapses.pathway[s]];
    const std::uint32_t pre = is_mirrored ? image_[synapses.pre[s]] : synapses.pre[s];
    const std::uint32_t post = is_mirrored ? image_[synapses.post[s]] : synapses.post[s];
    const std::int32_t log2 = network_.populations[pathway.post_population].quantum_log2[pathway.receptor];
    const double weight = std::ldexp(static_cast<double>(synapses.quanta[s]), log2);
    // Quanta of the two sides may differ in size: weights are compared to a millionth of a unit.
    return {{(std::uint64_t{pre} << 32U) | post, (std::uint64_t{pathway.receptor} << 32U) | synapses.delay_ticks[s],
             static_cast<std::uint64_t>(std::llround(weight * 1e6))},
            synapses.pathway[s]};
  }

  std::set<std::size_t> unmatched_projections(std::size_t& count) const {
    std::vector<Edge> own;
    std::vector<Edge> mirrored;
    for (std::size_t s = 0; s < network_.synapses.size(); ++s) {
      own.push_back(edge(s, false));
      mirrored.push_back(edge(s, true));
    }
    std::sort(own.begin(), own.end());
    std::sort(mirrored.begin(), mirrored.end());
    std::vector<Edge> alone;
    std::set_difference(own.begin(), own.end(), mirrored.begin(), mirrored.end(), std::back_inserter(alone));
    count = alone.size();
    std::set<std::size_t> projections;
    for (const Edge& e : alone) {
      projections.insert(index_of(network_.pathways[e.pathway].projection));
    }
    return projections;
  }

  const Circuit& circuit_;
  const Network& network_;
  std::vector<AxisId> axes_;
  bool flips_x_ = false;
  bool flips_y_ = false;
  std::vector<std::uint32_t> image_;  // neuron by neuron
};

}  // namespace

std::vector<SymmetryVerdict> mirror_symmetry(const Circuit& circuit, const Network& network) {
  std::vector<SymmetryVerdict> verdicts;
  std::vector<bool> is_done(circuit.axes.size(), false);
  for (std::size_t a = 0; a < circuit.axes.size(); ++a) {
    if (is_done[a] || circuit.axes[a].sides.size() != 2) {
      continue;
    }
    std::vector<AxisId> axes;
    for (std::size_t b = a; b < circuit.axes.size(); ++b) {
      if (circuit.axes[b].sides == circuit.axes[a].sides) {
        axes.push_back(static_cast<AxisId>(b));
        is_done[b] = true;
      }
    }
    verdicts.push_back(Mirror(circuit, network, std::move(axes)).verdict());
  }
  return verdicts;
}

}  // namespace tectum
