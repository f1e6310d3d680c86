#include "compiler/elaborate/elaborate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "compiler/elaborate/analyse.h"
#include "compiler/elaborate/apply_lesions.h"
#include "compiler/elaborate/cell_edges.h"
#include "compiler/elaborate/connect.h"
#include "compiler/elaborate/plastic_pathways.h"
#include "compiler/elaborate/quantise.h"
#include "compiler/elaborate/same_tick_order.h"
#include "compiler/elaborate/scale_weights.h"
#include "compiler/expression/random_stream.h"
#include "compiler/validate/cell_tables.h"
#include "compiler/validate/scope.h"
#include "runtime/image/models.h"

namespace tectum {
namespace {

constexpr std::size_t kMaxSynapses = std::size_t{1} << 27U;
constexpr double kReportedRounding = 1e-3;

void add_populations(const Circuit& circuit, Network& network) {
  std::uint32_t next = 0;
  for (const Instance& instance : circuit.instances) {
    const Population& population = circuit.populations[index_of(instance.population)];
    NetworkPopulation made;
    made.name = instance.name;
    made.nucleus = population.nucleus;
    made.name_span = population.name_span;
    made.model = population.model;
    made.user_model = population.user_model;
    made.may_sleep = population.may_sleep;
    made.first_neuron = next;
    made.size = population.size;
    made.parameters = instance.parameters;
    made.receptors = population.receptors;
    made.spike_ticks = instance.spike_ticks;
    next += population.size;
    if (instance.retina) {
      network.retinas.push_back(
          {circuit.retinas[index_of(*instance.retina)], static_cast<std::uint32_t>(network.populations.size())});
    }
    network.populations.push_back(std::move(made));
  }
}

/// Does the projection join these two sides? Where both ends are given with a side, they are meant as written.
bool joins(const Projection& projection, const Circuit& circuit, const Endpoint& from, const Instance& pre,
           const Endpoint& to, const Instance& post) {
  const std::vector<AxisId>& pre_axes = circuit.populations[index_of(pre.population)].axes;
  const std::vector<AxisId>& post_axes = circuit.populations[index_of(post.population)].axes;
  for (std::size_t a = 0; a < pre_axes.size(); ++a) {
    if (from.fixed_sides[a] && *from.fixed_sides[a] != pre.sides[a]) {
      return false;
    }
  }
  for (std::size_t a = 0; a < post_axes.size(); ++a) {
    if (to.fixed_sides[a] && *to.fixed_sides[a] != post.sides[a]) {
      return false;
    }
  }
  for (std::size_t a = 0; a < pre_axes.size(); ++a) {
    const auto shared = std::find(post_axes.begin(), post_axes.end(), pre_axes[a]);
    if (shared == post_axes.end()) {
      continue;
    }
    const auto b = static_cast<std::size_t>(shared - post_axes.begin());
    Relation relation = from.fixed_sides[a] && to.fixed_sides[b] ? Relation::Both : Relation::Ipsi;
    for (const AxisRelation& given : projection.relations) {
      relation = given.axis == pre_axes[a] ? given.relation : relation;
    }
    const bool is_same = pre.sides[a] == post.sides[b];
    if ((relation == Relation::Ipsi && !is_same) || (relation == Relation::Contra && is_same)) {
      return false;
    }
  }
  return true;
}

bool passes_sides(const Projection& projection, const Circuit& circuit, const Instance& pre, const Instance& post) {
  return projection.only_sides.empty() ||
         std::any_of(projection.only_sides.begin(), projection.only_sides.end(),
                     [&](const std::string& side) { return is_on_side(side, circuit, pre, post); });
}

/// Names the random draws by what a mirror leaves alone: populations, and how far apart their sides are. The two
/// sides of a pair are thus wired alike.
std::string stream_name(const Projection& projection, const Circuit& circuit, const Instance& pre,
                        const Instance& post) {
  const Population& from = circuit.populations[index_of(pre.population)];
  const Population& to = circuit.populations[index_of(post.population)];
  std::string name = fmt::format("{}\n{}\n{}", projection.name, from.name, to.name);
  for (std::size_t a = 0; a < from.axes.size(); ++a) {
    const auto shared = std::find(to.axes.begin(), to.axes.end(), from.axes[a]);
    const auto count = static_cast<std::uint32_t>(circuit.axes[index_of(from.axes[a])].sides.size());
    if (shared != to.axes.end()) {
      const std::uint32_t other = post.sides[static_cast<std::size_t>(shared - to.axes.begin())];
      name += fmt::format("\n{}", (other + count - pre.sides[a]) % count);
    }
  }
  return name;
}

class Wiring {
 public:
  Wiring(const Circuit& circuit, Network& network, Diagnostics& diagnostics, const ElaborateProgress& progress)
      : circuit_(circuit),
        network_(network),
        diagnostics_(diagnostics),
        plasticity_(circuit, network, diagnostics),
        progress_(progress) {}

  void run() {
    for (std::size_t p = 0; p < circuit_.projections.size() && !is_full_; ++p) {
      add(circuit_.projections[p], static_cast<ProjectionId>(p));
    }
    plasticity_.finish();
  }

  std::vector<double> weights;  // physical and signed

 private:
  void add(const Projection& projection, ProjectionId id) {
    const std::size_t before = network_.synapses.size();
    has_failed_ = false;
    if (projection.edges && projection.edges->names_cells) {
      add_cell_edges(projection, id);
    } else {
      add_pairs(projection, id);
    }
    if (projection.plasticity && !has_failed_) {
      plasticity_.report_unused(projection);
    }
    if (network_.synapses.size() == before && !has_failed_) {
      diagnostics_.add(Code::MatchesNoPair, projection.name_span).help_if(why_empty(projection), "{}");
    }
  }

  void add_pairs(const Projection& projection, ProjectionId id) {
    for (const Endpoint& from : projection.from) {
      for (const Endpoint& to : projection.to) {
        const Population& pre_population = circuit_.populations[index_of(from.population)];
        const Population& post_population = circuit_.populations[index_of(to.population)];
        for (std::uint32_t i = 0; i < pre_population.instance_count; ++i) {
          for (std::uint32_t j = 0; j < post_population.instance_count; ++j) {
            const std::size_t pre = index_of(pre_population.first_instance) + i;
            const std::size_t post = index_of(post_population.first_instance) + j;
            if (!has_failed_ &&
                joins(projection, circuit_, from, circuit_.instances[pre], to, circuit_.instances[post]) &&
                passes_sides(projection, circuit_, circuit_.instances[pre], circuit_.instances[post])) {
              add_pathway(projection, id, pre, post, to.receptor);
            }
          }
        }
      }
    }
  }

  /// The rows of an edge list that names cells, two populations at a time.
  void add_cell_edges(const Projection& projection, ProjectionId id) {
    const CellEdges edges(circuit_, network_, projection);
    if (edges.bad_rows().count > 0) {
      report_bad_rows(diagnostics_, Code::BadEdgeList, projection.edges->span, projection.edges->path,
                      edges.bad_rows());
    } else if (!edges.error().empty()) {
      diagnostics_.add(Code::BadEdgeList, projection.edges->span, {edges.error()});
    }
    has_failed_ = edges.bad_rows().count > 0 || !edges.error().empty();
    if (has_failed_) {
      return;
    }
    edges.for_each_pathway([&](std::uint32_t pre, std::uint32_t post, std::span<const std::uint32_t> rows) {
      const Instance& from = circuit_.instances[pre];
      const Instance& to = circuit_.instances[post];
      PairVariables variables(circuit_, from, to, stream_name(projection, circuit_, from, to));
      const auto pathway = static_cast<std::uint32_t>(network_.pathways.size());
      const std::size_t before = network_.synapses.size();
      PairBlock block;
      for (std::size_t begin = 0; begin < rows.size() && !has_failed_; begin += kPairBlockSize) {
        block.clear();
        edges.fill(rows.subspan(begin, std::min(kPairBlockSize, rows.size() - begin)), block);
        keep_where(projection, variables, block, where_values_);
        has_failed_ = !take(projection, values_between(projection, from, to), block, variables,
                            network_.populations[pre].first_neuron, network_.populations[post].first_neuron, pathway);
      }
      if (network_.synapses.size() > before) {
        network_.pathways.push_back({id, projection.name, projection.cite, projection.name_span, pre, post,
                                     receptor_of(projection, to.population), kNoRule});
        if (projection.plasticity) {
          plasticity_.add(*projection.plasticity, from, to, before);
        }
      }
      return !has_failed_;
    });
  }

  static std::uint32_t receptor_of(const Projection& projection, PopulationId target) {
    const auto end = std::find_if(projection.to.begin(), projection.to.end(),
                                  [&](const Endpoint& endpoint) { return endpoint.population == target; });
    return end->receptor;
  }

  static std::optional<std::string> why_empty(const Projection& projection) {
    if (projection.where) {
      return "no pair of neurons fulfils its `where`";
    }
    return std::nullopt;
  }

  void add_pathway(const Projection& projection, ProjectionId id, std::size_t pre, std::size_t post,
                   std::uint32_t receptor) {
    const Instance& from = circuit_.instances[pre];
    const Instance& to = circuit_.instances[post];
    const std::size_t before = network_.synapses.size();
    const auto pathway = static_cast<std::uint32_t>(network_.pathways.size());
    if (before + expected_synapses(projection, from, to) > kMaxSynapses) {
      report_full(projection);
      return;
    }
    make_room(before + expected_synapses(projection, from, to));
    const std::string stream = stream_name(projection, circuit_, from, to);
    PairVariables variables(circuit_, from, to, stream);
    const RandomStream random(circuit_.seed, stream);
    const Values values = values_between(projection, from, to);
    std::string error;
    const auto take_block = [&](PairBlock& block) {
      return take(projection, values, block, variables, network_.populations[pre].first_neuron,
                  network_.populations[post].first_neuron, pathway);
    };
    const bool is_done = connect(projection, circuit_, from, to, random, variables, take_block, error);
    if (!error.empty()) {
      diagnostics_.add(Code::BadEdgeList, projection.edges->span, {error});
    }
    has_failed_ = has_failed_ || !is_done;
    if (network_.synapses.size() > before) {
      network_.pathways.push_back({id, projection.name, projection.cite, projection.name_span,
                                   static_cast<std::uint32_t>(pre), static_cast<std::uint32_t>(post), receptor,
                                   kNoRule});
      if (projection.plasticity) {
        plasticity_.add(*projection.plasticity, from, to, before);
      }
    }
  }

  /// At least doubles, so that many small pathways do not move the columns each time.
  void make_room(std::size_t synapse_count) {
    Synapses& synapses = network_.synapses;
    if (synapse_count <= weights.capacity()) {
      return;
    }
    const std::size_t room = std::max(synapse_count, 2 * weights.capacity());
    synapses.pre.reserve(room);
    synapses.post.reserve(room);
    synapses.delay_ticks.reserve(room);
    synapses.pathway.reserve(room);
    weights.reserve(room);
  }

  /// How many a rule will make, where that is known beforehand; 0 where it depends on `where`.
  std::size_t expected_synapses(const Projection& projection, const Instance& from, const Instance& to) const {
    const std::size_t pre = circuit_.populations[index_of(from.population)].size;
    const std::size_t post = circuit_.populations[index_of(to.population)].size;
    if (projection.where) {
      return 0;
    }
    switch (projection.rule) {
      case RuleKind::OneToOne:
        return std::min(pre, post);
      case RuleKind::AllToAll:
        return pre * post;
      case RuleKind::FixedProbability:
        return projection.probability && projection.probability->constant
                   ? static_cast<std::size_t>(*projection.probability->constant * static_cast<double>(pre * post))
                   : 0;
      case RuleKind::FixedInDegree:
        return std::min<std::size_t>(projection.degree, pre) * post;
      case RuleKind::FixedOutDegree:
        return std::min<std::size_t>(projection.degree, post) * pre;
      case RuleKind::EdgeList:
        return 0;
    }
    return 0;
  }

  void report_full(const Projection& projection) {
    diagnostics_.add(Code::TooManySynapses, projection.name_span, {fmt::format("{}", kMaxSynapses)});
    has_failed_ = true;
    is_full_ = true;
  }

  struct Values {
    const TypedExpression& weight;
    const TypedExpression& delay;
  };

  /// The projection's own expressions, or those of an exception for this side.
  Values values_between(const Projection& projection, const Instance& pre, const Instance& post) const {
    const TypedExpression* weight = &projection.weight;
    const TypedExpression* delay = &projection.delay;
    for (const SideException& exception : projection.exceptions) {
      if (is_on_side(exception.side, circuit_, pre, post)) {
        weight = exception.weight ? &*exception.weight : weight;
        delay = exception.delay ? &*exception.delay : delay;
      }
    }
    return {*weight, *delay};
  }

  bool take(const Projection& projection, const Values& values, const PairBlock& block, PairVariables& variables,
            std::uint32_t first_pre, std::uint32_t first_post, std::uint32_t pathway) {
    Synapses& synapses = network_.synapses;
    if (synapses.size() + block.size() > kMaxSynapses) {
      report_full(projection);
      return false;
    }
    if (progress_) {
      const double done = static_cast<double>(&projection - circuit_.projections.data()) + block.share_done;
      progress_(done / static_cast<double>(circuit_.projections.size()), synapses.size());
    }
    variables.evaluate(PairUse::Weight, values.weight, block, weight_values_);
    variables.evaluate(PairUse::Delay, values.delay, block, delay_values_);
    const double sign = projection.is_inhibitory ? -1 : 1;
    std::optional<std::uint64_t> ticks;
    for (std::size_t i = 0; i < block.size(); ++i) {
      if (!check_weight(projection, block, i)) {
        return false;
      }
      if (i == 0 || delay_values_[i] != delay_values_[i - 1]) {
        ticks = whole_ticks(delay_values_[i], circuit_.tick_ns);
      }
      if (!ticks || *ticks > kMaxDelayTicks) {
        report_delay(projection, block, i, ticks.has_value());
        return false;
      }
      synapses.pre.push_back(first_pre + block.pre[i]);
      synapses.post.push_back(first_post + block.post[i]);
      synapses.delay_ticks.push_back(static_cast<std::uint32_t>(*ticks));
      synapses.pathway.push_back(pathway);
      weights.push_back(sign * weight_values_[i]);
    }
    return true;
  }

  static std::string pair_text(const PairBlock& block, std::size_t i) {
    return fmt::format("for pre.index {} and post.index {}", block.pre[i], block.post[i]);
  }

  bool check_weight(const Projection& projection, const PairBlock& block, std::size_t i) {
    const double weight = weight_values_[i];
    if (!std::isfinite(weight)) {
      diagnostics_.add(Code::NotFinite, projection.weight_span, {"the weight is not finite " + pair_text(block, i)});
      return false;
    }
    if (weight < 0) {
      diagnostics_.add(Code::NegativeWeight, projection.weight_span, {shown(weight, projection.weight.dimension)})
          .help(fmt::format("this is {}; write `max(0 {}, ...)` to cut it off", pair_text(block, i),
                            display_unit(projection.weight.dimension)));
      return false;
    }
    return true;
  }

  void report_delay(const Projection& projection, const PairBlock& block, std::size_t i, bool is_too_long) {
    const std::string delay = shown(delay_values_[i], kTime);
    if (is_too_long) {
      diagnostics_.add(Code::DelayTooLong, projection.delay_span, {delay, fmt::format("{}", kMaxDelayTicks)})
          .help("this is " + pair_text(block, i));
      return;
    }
    diagnostics_.add(Code::DelayNotTicks, projection.delay_span, {delay, shown(circuit_.tick_ms(), kTime)})
        .help(
            fmt::format("this is {}; write it as a whole number of ticks with `floor` or `ceil`", pair_text(block, i)));
  }

  const Circuit& circuit_;
  Network& network_;
  Diagnostics& diagnostics_;
  PlasticPathways plasticity_;
  const ElaborateProgress& progress_;
  std::vector<double> weight_values_;
  std::vector<double> delay_values_;
  std::vector<double> where_values_;
  bool has_failed_ = false;
  bool is_full_ = false;
};

void report_rounding(const Circuit& circuit, const RoundingReport& rounding, Diagnostics& diagnostics) {
  for (std::size_t p = 0; p < circuit.projections.size(); ++p) {
    const double error = rounding.largest_relative_error[p];
    if (error > kReportedRounding) {
      diagnostics.add(Code::WeightRounded, circuit.projections[p].weight_span, {fmt::format("{:.3g} %", error * 100)})
          .help("other synapses onto the same receptor are so strong that these fall below its resolution");
    }
  }
}

void report_cycle(const Network& network, const std::vector<std::uint32_t>& cycle, Diagnostics& diagnostics) {
  std::string text = network.populations[network.pathways[cycle.front()].pre_population].name;
  for (const std::uint32_t p : cycle) {
    text += " -> " + network.populations[network.pathways[p].post_population].name;
  }
  auto builder = diagnostics.add(Code::ZeroDelayCycle, network.pathways[cycle.front()].name_span, {text});
  for (std::size_t i = 1; i < cycle.size(); ++i) {
    builder.label(network.pathways[cycle[i]].name_span, "and this one");
  }
  builder.help("give one of them a delay of at least one tick");
}

}  // namespace

std::optional<Network> elaborate(const Circuit& circuit, Diagnostics& diagnostics, const ElaborateProgress& progress) {
  const std::size_t errors_before = diagnostics.error_count();
  Network network;
  network.name = circuit.name;
  network.tick_ns = circuit.tick_ns;
  network.seed = circuit.seed;
  network.outputs = circuit.outputs;
  network.joints = circuit.joints;
  add_populations(circuit, network);
  Wiring wiring(circuit, network, diagnostics, progress);
  wiring.run();
  if (diagnostics.error_count() > errors_before) {
    return std::nullopt;
  }
  scale_weights(circuit, network, wiring.weights, diagnostics);
  if (diagnostics.error_count() > errors_before) {
    return std::nullopt;
  }
  analyse(circuit, network, wiring.weights, diagnostics);
  // Quanta are settled before lesions, so that a lesion changes nothing but what it cuts.
  report_rounding(circuit, quantise(circuit, wiring.weights, network), diagnostics);
  apply_lesions(circuit, network);
  const SameTickOrder order = same_tick_order(network);
  if (!order.cycle.empty()) {
    report_cycle(network, order.cycle, diagnostics);
    return std::nullopt;
  }
  return network;
}

}  // namespace tectum
