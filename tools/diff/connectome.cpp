#include "tools/diff/connectome.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tectum {
namespace {

/// Least and most of what a pathway's synapses of one sign have.
struct Tally {
  std::size_t count = 0;
  double least = 0, most = 0;  // magnitudes
  std::uint32_t soonest = 0, latest = 0;

  void add(const SynapseView& synapse) {
    const double weight = std::abs(synapse.weight);
    least = count == 0 ? weight : std::min(least, weight);
    most = count == 0 ? weight : std::max(most, weight);
    soonest = count == 0 ? synapse.delay_ticks : std::min(soonest, synapse.delay_ticks);
    latest = count == 0 ? synapse.delay_ticks : std::max(latest, synapse.delay_ticks);
    ++count;
  }
};

std::string range_text(double low, double high) {
  return low == high ? fmt::format("{:.4g}", low) : fmt::format("{:.4g} to {:.4g}", low, high);
}

}  // namespace

Connectome connectome_of(const CircuitView& view, const std::set<std::string>& set_off, const std::string& ink) {
  Connectome connectome;
  connectome.name = std::string(view.image.name(view.image.header.circuit_name));
  const auto ink_of = [&](const std::string& name) { return set_off.count(name) != 0 ? ink : std::string(); };
  for (const PopulationView& population : view.populations) {
    ConnectomeNode node;
    node.name = population.name;
    node.nucleus = population.nucleus;
    node.model = population.model;
    node.size = population.size;
    node.is_input = population.is_retina;
    node.ink = ink_of(population.name);
    node.ink = node.ink.empty() ? ink_of(sided_name(population.name).base) : node.ink;
    if (!population.silenced.empty()) {
      node.note = fmt::format("silenced: {} of {}", population.silenced.size(), population.size);
    }
    connectome.nodes.push_back(std::move(node));
  }
  for (const PathwayView& pathway : view.pathways) {
    std::array<Tally, 2> by_sign;
    for (const SynapseView& synapse : pathway.synapses) {
      by_sign[synapse.weight < 0 ? 1 : 0].add(synapse);
    }
    const PopulationView& post = view.populations[pathway.post_population];
    for (std::size_t sign = 0; sign < 2; ++sign) {
      const Tally& tally = by_sign[sign];
      if (tally.count == 0) {
        continue;
      }
      const std::string receptor =
          pathway.receptor < post.receptors.size() ? post.receptors[pathway.receptor].name : std::string();
      connectome.edges.push_back(
          {pathway.pre_population, pathway.post_population, sign == 1, tally.count,
           pathway.projection.empty() ? "pathway" : pathway.projection, ink_of(pathway.projection),
           fmt::format("weight {} {}, delay {} ms, receptor {}", range_text(tally.least, tally.most), post.weight_unit,
                       range_text(tally.soonest * view.tick_ms(), tally.latest * view.tick_ms()), receptor)});
    }
  }
  for (const OutputView& output : view.outputs) {
    for (std::uint32_t joint = 0; joint < kJointCount; ++joint) {
      if ((output.joint_mask >> joint & 1U) != 0) {
        for (const OutputView::Term& term : output.terms) {
          connectome.outputs.push_back({kJointNames[joint], term.population, term.gain < 0});
        }
      }
    }
  }
  return connectome;
}

}  // namespace tectum
