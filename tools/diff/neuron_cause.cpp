#include "tools/diff/neuron_cause.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tectum {
namespace {

constexpr double kWorthNaming = 1e-9;

struct Candidate {
  double effect = 0;  // on the potential, or on the input where no potential is known
  bool decides = false;
  std::string why;
  std::string from;
  std::vector<std::size_t> changes;
};

bool same_arrivals(const std::vector<Arrival>& a, const std::vector<Arrival>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Arrival& x, const Arrival& y) { return x.tick == y.tick && x.weight == y.weight; });
}

std::string where_text(const CircuitView& view, const PathwayView& pathway) {
  return view.populations[pathway.pre_population].name + " -> " + view.populations[pathway.post_population].name;
}

const PathwayInput* input_of(const NeuronSetup& setup, std::uint32_t pathway) {
  for (const PathwayInput& input : setup.inputs) {
    if (input.pathway == pathway) {
      return &input;
    }
  }
  return nullptr;
}

class CauseFinder {
 public:
  explicit CauseFinder(const NeuronPair& pair)
      : pair_(pair),
        a_(neuron_setup(pair.a, pair.spikes_a, pair.neuron_a, pair.tick)),
        b_(neuron_setup(pair.b, pair.spikes_b, pair.neuron_b, pair.tick)),
        name_(pair.b.populations[pair.b.population_of(pair.neuron_b)].name) {}

  NeuronCause run() {
    const std::vector<std::size_t> tick = changes_of(pair_.structure, Element::Circuit, "circuit", "tick");
    if (!tick.empty()) {
      return of_changes(tick);
    }
    if (a_.is_silenced != b_.is_silenced) {
      return of_changes(changes_of(pair_.structure, Element::Population, name_, "silenced neurons"));
    }
    if (a_.model != b_.model) {
      return of_changes(changes_of(pair_.structure, Element::Population, name_, "model"));
    }
    account_a_ = account_of(a_, pair_.tick);
    account_b_ = account_of(b_, pair_.tick);
    sources();
    parameters();
    receptors();
    pathways();
    const auto better = [](const Candidate& x, const Candidate& y) {
      return x.decides != y.decides ? x.decides : std::abs(x.effect) > std::abs(y.effect);
    };
    std::stable_sort(candidates_.begin(), candidates_.end(), better);
    NeuronCause cause;
    if (!candidates_.empty()) {
      Candidate& best = candidates_.front();
      cause = {std::move(best.why), std::move(best.from), std::move(best.changes), numbers()};
    }
    return cause;
  }

 private:
  NeuronCause of_changes(std::vector<std::size_t> changes) const {
    NeuronCause cause;
    if (!changes.empty()) {
      cause.why = change_sentence(pair_.structure.changes[changes.front()]);
    }
    cause.changes = std::move(changes);
    return cause;
  }

  std::string numbers() const {
    if (!account_a_.has_potential) {
      return "";
    }
    if (account_a_.is_refractory != account_b_.is_refractory) {
      return fmt::format("still refractory in the {}", account_a_.is_refractory ? "first" : "second");
    }
    std::string threshold = quantity_text(account_a_.threshold, account_a_.unit);
    if (account_a_.threshold != account_b_.threshold) {
      threshold = fmt::format("{} and {}", threshold, quantity_text(account_b_.threshold, account_a_.unit));
    }
    const std::string unit = account_a_.unit.empty() ? "" : " " + account_a_.unit;
    return fmt::format("{:.2f}{} in the first, {:.2f}{} in the second, threshold {}", account_a_.potential, unit,
                       account_b_.potential, unit, threshold);
  }

  /// What `changed`, in place of the first circuit's neuron, would have done.
  void add(const NeuronSetup& changed, Candidate candidate) {
    const NeuronAccount account = account_of(changed, pair_.tick);
    if (account.has_potential) {
      candidate.effect = account.potential - account_a_.potential - (account.threshold - account_a_.threshold);
      candidate.decides = pair_.is_about_spike && account.fires() != pair_.fires_in_a;
      if (std::abs(candidate.effect) < kWorthNaming && !candidate.decides) {
        return;
      }
    }
    candidates_.push_back(std::move(candidate));
  }
  Candidate of_change_list(std::vector<std::size_t> changes) const {
    Candidate candidate;
    candidate.effect = std::numeric_limits<double>::max();  // where no account says how much
    candidate.why = changes.empty() ? "" : change_sentence(pair_.structure.changes[changes.front()]);
    candidate.changes = std::move(changes);
    return candidate;
  }

  /// What makes sources fire: their fields, their seed, their times, their equations.
  void sources() {
    const PopulationView& population = pair_.b.populations[pair_.b.population_of(pair_.neuron_b)];
    for (const char* property : {"times", "equations"}) {
      if (auto changes = changes_of(pair_.structure, Element::Population, name_, property); !changes.empty()) {
        candidates_.push_back(of_change_list(std::move(changes)));
      }
    }
    if (population.is_retina) {
      for (const RetinaRecord& retina : pair_.b.image.retinas) {
        const bool is_own = retina.first_neuron == population.first_neuron;
        const std::string retina_name(pair_.b.image.name(retina.name));
        auto changes = changes_of(pair_.structure, Element::Retina, is_own ? retina_name : "no retina");
        if (is_own && !changes.empty()) {
          candidates_.push_back(of_change_list(std::move(changes)));
        }
      }
    }
    if (population.model == "poisson") {
      // Its draws are keyed by seed and name.
      for (auto changes : {changes_of(pair_.structure, Element::Circuit, "circuit", "seed"),
                           changes_of(pair_.structure, Element::Population, name_, "name")}) {
        if (!changes.empty()) {
          candidates_.push_back(of_change_list(std::move(changes)));
        }
      }
    }
  }

  void parameters() {
    for (std::size_t p = 0; p < std::min(a_.parameters.size(), b_.parameters.size()); ++p) {
      const double before = a_.parameters[p].values.front(), after = b_.parameters[p].values.front();
      if (before == after) {
        continue;
      }
      NeuronSetup changed = a_;
      changed.parameters[p].values.front() = after;
      Candidate candidate =
          of_change_list(changes_of(pair_.structure, Element::Population, name_, a_.parameters[p].name));
      candidate.why =
          fmt::format("{} of {} is {} instead of {}", a_.parameters[p].name, neuron_name(pair_.b, pair_.neuron_b),
                      quantity_text(after, a_.parameters[p].unit), quantity_text(before, a_.parameters[p].unit));
      add(changed, std::move(candidate));
    }
  }

  void receptors() {
    for (std::size_t r = 0; r < a_.receptors.size(); ++r) {
      for (const ReceptorView& other : b_.receptors) {
        const ReceptorView& own = a_.receptors[r];
        const bool is_changed =
            other.kind != own.kind || other.tau_ms != own.tau_ms || other.window_ticks != own.window_ticks;
        if (other.name != own.name || !is_changed) {
          continue;
        }
        NeuronSetup changed = a_;
        changed.receptors[r] = other;
        add(changed, of_change_list(changes_of(pair_.structure, Element::Population, name_, "receptor " + own.name)));
      }
    }
  }

  /// The first circuit's neuron with the second's arrivals on one pathway.
  NeuronSetup with_arrivals(const PathwayInput* own, const PathwayInput* other) const {
    NeuronSetup changed = a_;
    if (own != nullptr) {
      for (PathwayInput& input : changed.inputs) {
        if (input.pathway == own->pathway) {
          input.arrivals.clear();
        }
      }
    }
    if (other != nullptr) {
      const ReceptorView& receptor = b_.receptors[other->receptor];
      const auto named = std::find_if(changed.receptors.begin(), changed.receptors.end(),
                                      [&](const ReceptorView& r) { return r.name == receptor.name; });
      PathwayInput input = *other;
      input.pathway = kNoMatch;
      input.receptor = static_cast<std::uint32_t>(named - changed.receptors.begin());
      if (named == changed.receptors.end()) {
        changed.receptors.push_back(receptor);
      }
      changed.inputs.push_back(std::move(input));
    }
    return changed;
  }

  void pathways() {
    for (const Correspondence::PathwayPair& match : pair_.structure.match.pathways) {
      const PathwayInput* own = match.a == kNoMatch ? nullptr : input_of(a_, match.a);
      const PathwayInput* other = match.b == kNoMatch ? nullptr : input_of(b_, match.b);
      if (own == nullptr && other == nullptr) {
        continue;
      }
      const std::vector<Arrival> none;
      const std::vector<Arrival>& before = own != nullptr ? own->arrivals : none;
      const std::vector<Arrival>& after = other != nullptr ? other->arrivals : none;
      const bool moved_receptor =
          own != nullptr && other != nullptr && a_.receptors[own->receptor].name != b_.receptors[other->receptor].name;
      if (same_arrivals(before, after) && !moved_receptor) {
        continue;
      }
      Candidate candidate = match.differs ? edited_pathway(match) : carried(match, before, after);
      double brought = 0;
      for (const Arrival& arrival : after) {
        brought += arrival.weight;
      }
      for (const Arrival& arrival : before) {
        brought -= arrival.weight;
      }
      candidate.effect = brought;
      add(with_arrivals(own, other), std::move(candidate));
    }
  }

  Candidate edited_pathway(const Correspondence::PathwayPair& match) const {
    const CircuitView& view = match.b != kNoMatch ? pair_.b : pair_.a;
    const PathwayView& pathway = view.pathways[match.b != kNoMatch ? match.b : match.a];
    std::vector<std::size_t> changes =
        changes_of(pair_.structure, Element::Projection, pathway.projection, "", where_text(view, pathway));
    // Synapses that come or go with the neurons of a population are that population's doing.
    const bool is_by_size = !changes.empty() && pair_.structure.changes[changes.front()].property == "synapses";
    for (const std::uint32_t end : {pathway.pre_population, pathway.post_population}) {
      const auto sizes = changes_of(pair_.structure, Element::Population, view.populations[end].name, "size");
      changes.insert(is_by_size ? changes.begin() : changes.end(), sizes.begin(), sizes.end());
    }
    return of_change_list(std::move(changes));
  }

  /// A difference that other neurons' spikes bring; or, where they do not differ, the rounding of the weights.
  Candidate carried(const Correspondence::PathwayPair& match, const std::vector<Arrival>& before,
                    const std::vector<Arrival>& after) const {
    Candidate candidate;
    const PathwayView& pathway = pair_.b.pathways[match.b];
    const std::string where = fmt::format("{}, {}", pathway.projection, where_text(pair_.b, pathway));
    const bool same_spikes = std::equal(before.begin(), before.end(), after.begin(), after.end(),
                                        [](const Arrival& x, const Arrival& y) { return x.tick == y.tick; });
    if (same_spikes) {
      candidate.why = fmt::format("{}: weights are rounded to other quanta", where);
      const std::string receptor = pair_.b.populations[pathway.post_population].receptors[pathway.receptor].name;
      for (const Correspondence::PathwayPair& other : pair_.structure.match.pathways) {
        // The largest weights on a receptor decide on its quantum, so the edit is on the same one.
        if (other.differs && other.b != kNoMatch &&
            pair_.b.pathways[other.b].post_population == pathway.post_population &&
            pair_.b.pathways[other.b].receptor == pathway.receptor) {
          const PathwayView& edited = pair_.b.pathways[other.b];
          candidate.changes =
              changes_of(pair_.structure, Element::Projection, edited.projection, "", where_text(pair_.b, edited));
        }
      }
      return candidate;
    }
    candidate.from = pair_.b.populations[pathway.pre_population].name;
    candidate.why = fmt::format("through {}", where);
    return candidate;
  }

  const NeuronPair& pair_;
  NeuronSetup a_, b_;
  std::string name_;
  NeuronAccount account_a_, account_b_;
  std::vector<Candidate> candidates_;
};

}  // namespace

NeuronCause neuron_cause(const NeuronPair& pair) { return CauseFinder(pair).run(); }

std::vector<std::size_t> changes_of(const StructureDiff& structure, Element element, const std::string& name,
                                    const std::string& property, const std::string& where) {
  std::vector<std::size_t> found;
  for (std::size_t c = 0; c < structure.changes.size(); ++c) {
    const Change& change = structure.changes[c];
    const bool is_renamed = change.kind == ChangeKind::Renamed && property == "name";
    if (change.element == element && change.name == name && (where.empty() || change.where == where) &&
        (property.empty() || change.property == property || is_renamed)) {
      found.push_back(c);
    }
  }
  return found;
}

std::string change_sentence(const Change& change) {
  const std::string what = fmt::format("{}{}{}", change.name, change.where.empty() ? "" : ", ", change.where);
  std::string text;
  switch (change.kind) {
    case ChangeKind::Added:
      text = fmt::format("{} {} is only in the second", element_name(change.element), what);
      break;
    case ChangeKind::Removed:
      text = fmt::format("{} {} is only in the first", element_name(change.element), what);
      break;
    case ChangeKind::Renamed:
      text = fmt::format("{} {} was called {}", element_name(change.element), what, change.before);
      break;
    case ChangeKind::Changed:
      text = fmt::format("{} of {}{} is {} instead of {}", change.property, what, change.where.empty() ? "" : ",",
                         change.after, change.before);
      break;
  }
  text += change.because.empty() ? "" : ": " + change.because;
  text += change.place.empty() ? "" : " (" + change.place + ")";
  return text;
}

std::string neuron_name(const CircuitView& view, std::uint32_t neuron) {
  const PopulationView& population = view.populations[view.population_of(neuron)];
  return fmt::format("{}[{}]", population.name, neuron - population.first_neuron);
}

}  // namespace tectum
