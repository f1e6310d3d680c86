#include "compiler/elaborate/plastic_pathways.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/image/plasticity.h"

namespace tectum {

bool is_on_side(const std::string& side, const Circuit& circuit, const Instance& pre, const Instance& post) {
  const Instance& end = post.sides.empty() ? pre : post;
  const std::vector<AxisId>& axes = circuit.populations[index_of(end.population)].axes;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (circuit.axes[index_of(axes[a])].sides[end.sides[a]] == side) {
      return true;
    }
  }
  return false;
}

void PlasticPathways::add(const Plasticity& plasticity, const Instance& pre, const Instance& post, std::size_t first) {
  const auto use = std::find_if(plasticity.rewards.begin(), plasticity.rewards.end(), [&](const RewardUse& reward) {
    return reward.side.empty() || is_on_side(reward.side, circuit_, pre, post);
  });
  if (use == plasticity.rewards.end()) {
    return;
  }
  Synapses& synapses = network_.synapses;
  const std::size_t count = synapses.size() - first;
  network_.pathways.back().rule = static_cast<std::uint32_t>(network_.rules.size());
  network_.rules.push_back({plasticity, use->channel, static_cast<std::uint32_t>(count)});
  network_.rules.back().plasticity.learned.clear();
  synapses.scale.resize(synapses.size(), kScaleOne);
  synapses.ordinal.resize(synapses.size(), 0);
  std::iota(synapses.ordinal.begin() + static_cast<std::ptrdiff_t>(first), synapses.ordinal.end(), 0U);
  pathways_.push_back(pre.name + "->" + post.name);
  for (const LearnedFactors& learned : plasticity.learned) {
    if (learned.pathway == pathways_.back()) {
      take_factors(learned, first);
    }
  }
}

void PlasticPathways::take_factors(const LearnedFactors& learned, std::size_t first) {
  Synapses& synapses = network_.synapses;
  const std::size_t count = synapses.size() - first;
  if (learned.factors.size() != count) {
    diagnostics_
        .add(Code::LearnedMismatch, learned.span,
             {fmt::format("`{}` has {} learned factors for {} synapses", learned.pathway, learned.factors.size(),
                          count)})
        .help("they belong to another version of this circuit; learn again, or take them out");
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    synapses.scale[first + i] = static_cast<std::int32_t>(std::nearbyint(std::ldexp(learned.factors[i], kScaleBits)));
  }
}

void PlasticPathways::report_unused(const Projection& projection) {
  for (const LearnedFactors& learned : projection.plasticity->learned) {
    if (std::find(pathways_.begin(), pathways_.end(), learned.pathway) == pathways_.end()) {
      diagnostics_
          .add(Code::LearnedMismatch, learned.span,
               {fmt::format("`{}` is no pathway of `{}` that learns", learned.pathway, projection.name)})
          .help(pathways_.empty() ? "none of its pathways learns"
                                  : fmt::format("it has {}", fmt::join(pathways_, ", ")));
    }
  }
  pathways_.clear();
}

void PlasticPathways::finish() {
  Synapses& synapses = network_.synapses;
  if (network_.rules.empty()) {
    return;
  }
  synapses.scale.resize(synapses.size(), kScaleOne);
  synapses.ordinal.resize(synapses.size(), 0);
  synapses.base_quanta.resize(synapses.size(), 0);
}

}  // namespace tectum
