#include "compiler/elaborate/symmetry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "compiler/elaborate/mirror_partner.h"

namespace tectum {
namespace {

constexpr std::uint32_t kNoImage = 0xFFFFFFFFU;

/// A pair of sides that a mirror swaps, and the axes that have them.
struct MirrorPlane {
  std::pair<std::string, std::string> sides;
  std::vector<AxisId> axes;  // may be empty: populations are then paired by name
};

class Mirror {
 public:
  Mirror(const Circuit& circuit, const Network& network, MirrorPlane plane)
      : circuit_(circuit),
        network_(network),
        plane_(std::move(plane)),
        partner_(mirror_partners(circuit, plane_.axes, plane_.sides)) {
    flips_x_ = swaps("left", "right");
    flips_y_ = swaps("up", "down");
    image_.assign(network.neuron_count(), kNoImage);
    for (std::size_t i = 0; i < circuit.instances.size(); ++i) {
      map_neurons(i, partner_[i]);
    }
  }

  SymmetryVerdict verdict() {
    SymmetryVerdict verdict;
    for (const AxisId axis : plane_.axes) {
      verdict.axes += (verdict.axes.empty() ? "" : ", ") + circuit_.axes[index_of(axis)].name;
    }
    verdict.sides = plane_.sides.first + "/" + plane_.sides.second;
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
  [[nodiscard]] bool swaps(const char* a, const char* b) const {
    return (plane_.sides.first == a && plane_.sides.second == b) ||
           (plane_.sides.first == b && plane_.sides.second == a);
  }

  // Fields lie at 32-bit pixels, so that two that mirror each other may be some 3e-6 deg off.
  static constexpr double kCellsInAUnit = 1e4;  // places are the same within a ten-thousandth of a degree or metre
  using Places = std::map<std::pair<std::int64_t, std::int64_t>, std::uint32_t>;
  static std::int64_t cell(double place) { return std::llround(place * kCellsInAUnit); }

  static std::uint32_t neuron_at(const Places& at, double x, double y) {
    for (const std::int64_t dx : {0, -1, 1}) {
      for (const std::int64_t dy : {0, -1, 1}) {
        if (const auto found = at.find({cell(x) + dx, cell(y) + dy}); found != at.end()) {
          return found->second;
        }
      }
    }
    return kNoImage;
  }

  void map_neurons(std::size_t from, std::size_t to) {
    const NetworkPopulation& source = network_.populations[from];
    const NetworkPopulation& target = network_.populations[to];
    const Instance& a = circuit_.instances[from];
    const Instance& b = circuit_.instances[to];
    const bool has_places = (flips_x_ || flips_y_) && !a.x.empty() && a.x.size() == b.x.size();
    Places at;
    for (std::uint32_t i = 0; has_places && i < target.size; ++i) {
      at.emplace(std::pair(cell(b.x[i]), cell(b.y[i])), i);
    }
    for (std::uint32_t i = 0; i < source.size; ++i) {
      std::uint32_t image = i;
      if (has_places) {
        image = neuron_at(at, flips_x_ ? -a.x[i] : a.x[i], flips_y_ ? -a.y[i] : a.y[i]);
      }
      image_[source.first_neuron + i] = image == kNoImage ? kNoImage : target.first_neuron + image;
    }
  }

  bool differs(const Population& population) const {
    for (std::size_t k = 0; k < population.instance_count; ++k) {
      const std::size_t i = index_of(population.first_instance) + k;
      const NetworkPopulation& own = network_.populations[i];
      const NetworkPopulation& other = network_.populations[partner_[i]];
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

  struct Edge {
    std::array<std::uint64_t, 2> ends;  // pre and post, receptor and delay
    double millionths;                  // of the weight's unit
    std::uint32_t pathway;
    friend bool operator<(const Edge& a, const Edge& b) {
      return std::tie(a.ends, a.millionths) < std::tie(b.ends, b.millionths);
    }
  };

  /// Quanta of the two sides may differ in size, and weights that go by a place are as good as the place is: they are
  /// the same within a ten-thousandth of themselves or a millionth of the unit.
  static bool is_same_weight(double a, double b) {
    return std::abs(a - b) <= std::max(1.0, 1e-4 * std::max(std::abs(a), std::abs(b)));
  }

  Edge edge(std::size_t s, bool is_mirrored) const {
    const Synapses& synapses = network_.synapses;
    const Pathway& pathway = network_.pathways[synapses.pathway[s]];
    const std::uint32_t pre = is_mirrored ? image_[synapses.pre[s]] : synapses.pre[s];
    const std::uint32_t post = is_mirrored ? image_[synapses.post[s]] : synapses.post[s];
    return {{(std::uint64_t{pre} << 32U) | post, (std::uint64_t{pathway.receptor} << 32U) | synapses.delay_ticks[s]},
            synapses.quanta[s] * millionths_of_quantum_[synapses.pathway[s]],
            synapses.pathway[s]};
  }

  /// A sum over a set of synapses that does not depend on their order. Two different sets have the same sum once in
  /// 2^128, so equal sums are taken for equal sets, and only what differs is sorted and compared synapse by synapse.
  struct Sum {
    std::uint64_t low = 0;
    std::uint64_t high = 0;

    void add(const Edge& edge) {
      const auto weight = static_cast<std::uint64_t>(std::llrint(edge.millionths));
      const std::uint64_t hash = mix(mix(mix(edge.ends[0]) + edge.ends[1]) + weight);
      low += hash;
      high += mix(hash + edge.ends[0]);
    }
    friend bool operator==(const Sum&, const Sum&) = default;

   private:
    /// The finaliser of SplitMix64: Steele, Lea & Flood 2014, doi:10.1145/2660193.2660195.
    static std::uint64_t mix(std::uint64_t x) {
      x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
      x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
      return x ^ (x >> 31U);
    }
  };

  /// Numbers the pairs of populations that synapses join; `mirrored` is the number of the mirrored pair.
  struct PairsOfPathways {
    std::vector<std::uint32_t> own;
    std::vector<std::uint32_t> mirrored;
    std::size_t count = 0;
  };

  PairsOfPathways number_pairs() {
    std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> number_of;
    const auto number = [&](std::size_t pre, std::size_t post) {
      return number_of.emplace(std::pair(pre, post), static_cast<std::uint32_t>(number_of.size())).first->second;
    };
    PairsOfPathways pairs;
    for (const Pathway& pathway : network_.pathways) {
      pairs.own.push_back(number(pathway.pre_population, pathway.post_population));
      pairs.mirrored.push_back(number(partner_[pathway.pre_population], partner_[pathway.post_population]));
      const std::int32_t log2 = network_.populations[pathway.post_population].quantum_log2[pathway.receptor];
      millionths_of_quantum_.push_back(std::ldexp(1e6, log2));
    }
    pairs.count = number_of.size();
    return pairs;
  }

  std::set<std::size_t> unmatched_projections(std::size_t& count) {
    const PairsOfPathways pairs = number_pairs();
    const std::vector<std::uint32_t>& pathway_of = network_.synapses.pathway;
    std::vector<Sum> own_sums(pairs.count);
    std::vector<Sum> mirrored_sums(pairs.count);
    for (std::size_t s = 0; s < pathway_of.size(); ++s) {
      own_sums[pairs.own[pathway_of[s]]].add(edge(s, false));
      mirrored_sums[pairs.mirrored[pathway_of[s]]].add(edge(s, true));
    }
    std::vector<Edge> own;
    std::vector<Edge> mirrored;
    const auto differ = [&](std::uint32_t pair) { return own_sums[pair] != mirrored_sums[pair]; };
    for (std::size_t s = 0; s < pathway_of.size(); ++s) {
      if (differ(pairs.own[pathway_of[s]])) {
        own.push_back(edge(s, false));
      }
      if (differ(pairs.mirrored[pathway_of[s]])) {
        mirrored.push_back(edge(s, true));
      }
    }
    std::sort(own.begin(), own.end());
    std::sort(mirrored.begin(), mirrored.end());
    std::set<std::size_t> projections;
    auto other = mirrored.begin();
    for (const Edge& e : own) {
      const auto is_before = [&](const Edge& m) {
        return m.ends < e.ends ||
               (m.ends == e.ends && m.millionths < e.millionths && !is_same_weight(m.millionths, e.millionths));
      };
      while (other != mirrored.end() && is_before(*other)) {
        ++other;
      }
      if (other != mirrored.end() && other->ends == e.ends && is_same_weight(other->millionths, e.millionths)) {
        ++other;
      } else {
        ++count;
        projections.insert(index_of(network_.pathways[e.pathway].projection));
      }
    }
    return projections;
  }

  const Circuit& circuit_;
  const Network& network_;
  MirrorPlane plane_;
  std::vector<std::size_t> partner_;  // instance by instance
  bool flips_x_ = false;
  bool flips_y_ = false;
  std::vector<std::uint32_t> image_;           // neuron by neuron
  std::vector<double> millionths_of_quantum_;  // pathway by pathway
};

/// Axes of the same two sides, in whatever order they list them, are swapped together; left/right and up/down also
/// where no axis has them, but names.
std::vector<MirrorPlane> mirror_planes(const Circuit& circuit) {
  std::vector<MirrorPlane> planes;
  const auto plane_of = [&](const std::string& a, const std::string& b) {
    return std::find_if(planes.begin(), planes.end(), [&](const MirrorPlane& plane) {
      return plane.sides == std::pair(a, b) || plane.sides == std::pair(b, a);
    });
  };
  for (std::size_t a = 0; a < circuit.axes.size(); ++a) {
    const std::vector<std::string>& sides = circuit.axes[a].sides;
    if (sides.size() != 2) {
      continue;
    }
    auto plane = plane_of(sides[0], sides[1]);
    if (plane == planes.end()) {
      plane = planes.insert(planes.end(), {{sides[0], sides[1]}, {}});
    }
    plane->axes.push_back(static_cast<AxisId>(a));
  }
  for (const auto& sides : {std::pair<std::string, std::string>("left", "right"), {"up", "down"}}) {
    if (plane_of(sides.first, sides.second) == planes.end() && has_named_pairs(circuit, sides)) {
      planes.push_back({sides, {}});
    }
  }
  return planes;
}

}  // namespace

std::vector<SymmetryVerdict> mirror_symmetry(const Circuit& circuit, const Network& network) {
  std::vector<SymmetryVerdict> verdicts;
  for (MirrorPlane& plane : mirror_planes(circuit)) {
    verdicts.push_back(Mirror(circuit, network, std::move(plane)).verdict());
  }
  return verdicts;
}

}  // namespace tectum
