#include "compiler/elaborate/quantise.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "runtime/image/models.h"

namespace tectum {
namespace {

constexpr int kSumBits = 30;
constexpr std::int32_t kQuantumWithoutSynapses = -20;
// The far tail of a kernel may vanish: errors are seen against at least this share of the strongest weight.
constexpr double kNegligible = 1e-3;

constexpr int kMantissaBits = 53;

/// Exponent of the last bit that is set: every coarser power of two rounds the weight.
int last_bit(double weight) {
  int exponent = 0;
  const auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::abs(std::frexp(weight, &exponent)), kMantissaBits));
  return mantissa == 0 ? std::numeric_limits<int>::max() : exponent - kMantissaBits + std::countr_zero(mantissa);
}

/// What arrives at each (neuron, receptor).
struct SlotSums {
  std::vector<std::size_t> first;  // of each population
  std::vector<double> magnitude;   // sum of |weight|
  std::vector<std::uint32_t> count;
  std::vector<int> last_bit;  // of all weights
};

/// The most that learning can make of a synapse's weight, as a share of it.
double highest_factor(const Network& network, std::size_t synapse) {
  const std::uint32_t rule = network.pathways[network.synapses.pathway[synapse]].rule;
  return rule == kNoRule ? 1.0 : network.rules[rule].plasticity.highest;
}

SlotSums sum_slots(const Network& network, const std::vector<double>& weights) {
  SlotSums sums;
  std::size_t total = 0;
  for (const NetworkPopulation& population : network.populations) {
    sums.first.push_back(total);
    total += population.receptors.size() * population.size;
  }
  sums.magnitude.assign(total, 0);
  sums.count.assign(total, 0);
  sums.last_bit.assign(total, std::numeric_limits<int>::max());
  const Synapses& synapses = network.synapses;
  for (std::size_t s = 0; s < synapses.size(); ++s) {
    const Pathway& pathway = network.pathways[synapses.pathway[s]];
    const NetworkPopulation& post = network.populations[pathway.post_population];
    const std::size_t slot = sums.first[pathway.post_population] + std::size_t{pathway.receptor} * post.size +
                             (synapses.post[s] - post.first_neuron);
    sums.magnitude[slot] += std::abs(weights[s]) * highest_factor(network, s);
    ++sums.count[slot];
    // What learning makes of a weight has to be rounded, whatever the declared one is.
    const int lowest_bit = pathway.rule == kNoRule ? last_bit(weights[s]) : std::numeric_limits<int>::min();
    sums.last_bit[slot] = std::min(sums.last_bit[slot], lowest_bit);
  }
  return sums;
}

/// Smallest exponent q with sum / 2^q + count / 2 < 2^30: rounding adds at most half a quantum a synapse, and nothing
/// where all weights are whole quanta. Weights that were quanta before, of an exported circuit, thus stay what they
/// are.
std::int32_t quantum_for(double sum, std::uint32_t count, int lowest_bit) {
  int exponent = 0;
  std::frexp(sum, &exponent);
  std::int32_t q = exponent - kSumBits;
  while (std::ldexp(sum, -q) + (lowest_bit >= q ? 0.0 : count / 2.0) >= std::ldexp(1.0, kSumBits)) {
    ++q;
  }
  return std::clamp(q, kMinQuantumLog2, kMaxQuantumLog2);
}

}  // namespace

RoundingReport quantise(const Circuit& circuit, const std::vector<double>& weights, Network& network) {
  const SlotSums sums = sum_slots(network, weights);
  for (const Population& population : circuit.populations) {
    const std::size_t first = index_of(population.first_instance);
    for (std::size_t r = 0; r < population.receptors.size(); ++r) {
      // A boxcar adds the arrivals of its whole window.
      const double window = std::max(1U, population.receptors[r].window_ticks);
      std::int32_t q = kMinQuantumLog2 - 1;
      for (std::size_t i = first; i < first + population.instance_count; ++i) {
        for (std::size_t n = 0; n < population.size; ++n) {
          const std::size_t slot = sums.first[i] + r * population.size + n;
          if (sums.magnitude[slot] > 0) {
            q = std::max(q, quantum_for(sums.magnitude[slot] * window,
                                        static_cast<std::uint32_t>(sums.count[slot] * window), sums.last_bit[slot]));
          }
        }
      }
      for (std::size_t i = first; i < first + population.instance_count; ++i) {
        network.populations[i].quantum_log2.push_back(q < kMinQuantumLog2 ? kQuantumWithoutSynapses : q);
      }
    }
  }
  RoundingReport report;
  report.largest_relative_error.assign(circuit.projections.size(), 0);
  std::vector<double> strongest(circuit.projections.size(), 0);
  for (std::size_t s = 0; s < weights.size(); ++s) {
    double& weight = strongest[index_of(network.pathways[network.synapses.pathway[s]].projection)];
    weight = std::max(weight, std::abs(weights[s]));
  }
  // Powers of two: multiplying by them is exact, and faster than ldexp a synapse.
  std::vector<double> quantum;  // of each pathway
  for (const Pathway& pathway : network.pathways) {
    quantum.push_back(std::ldexp(1.0, network.populations[pathway.post_population].quantum_log2[pathway.receptor]));
  }
  Synapses& synapses = network.synapses;
  synapses.quanta.resize(synapses.size());
  for (std::size_t s = 0; s < synapses.size(); ++s) {
    const Pathway& pathway = network.pathways[synapses.pathway[s]];
    const double exact = weights[s] / quantum[synapses.pathway[s]];
    const double rounded = std::nearbyint(exact);
    synapses.quanta[s] = static_cast<std::int32_t>(rounded);
    if (exact != 0) {
      const std::size_t p = index_of(pathway.projection);
      const double scale = std::max(std::abs(weights[s]), kNegligible * strongest[p]);
      double& worst = report.largest_relative_error[p];
      worst = std::max(worst, std::abs(rounded - exact) * quantum[synapses.pathway[s]] / scale);
    }
    if (!synapses.scale.empty() && network.pathways[synapses.pathway[s]].rule != kNoRule) {
      synapses.base_quanta[s] = synapses.quanta[s];
      synapses.quanta[s] = plastic_quanta(synapses.base_quanta[s], synapses.scale[s]);
    }
  }
  return report;
}

}  // namespace tectum
