#include "tools/diff/divergence.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/diff/neuron_cause.h"

namespace tectum {
namespace {

constexpr double kFollowS = 0.2;        // of what follows from the first difference
constexpr std::size_t kMostLinks = 24;  // populations whose cause is looked for

class DivergenceFinder {
 public:
  explicit DivergenceFinder(const DivergenceInput& input) : input_(input) {}

  Divergence run() {
    lock_ = lock_step(input_.a, input_.b, input_.structure.match, input_.recording_a, input_.recording_b,
                      input_.produce_b, kFollowS);
    result_.compared_s = lock_.run_s;
    spikes_a_ = spike_ticks(input_.recording_a.spikes, input_.a.image.header.neuron_count);
    spikes_b_ = spike_ticks(input_.recording_b.spikes, input_.b.image.header.neuron_count);
    if (lock_.field) {
      field(*lock_.field);
    }
    for (std::size_t k = 0; k < std::min(lock_.spikes.size(), kMostLinks); ++k) {
      spike(first_of_tick(k));
    }
    for (const FirstCommand& command : lock_.commands) {
      this->command(command);
    }
    if (lock_.is_same()) {
      potential();
    }
    std::stable_sort(result_.links.begin(), result_.links.end(),
                     [](const DivergenceLink& x, const DivergenceLink& y) { return x.time_ms < y.time_ms; });
    return std::move(result_);
  }

 private:
  static double ms(std::uint64_t time_ns) { return static_cast<double>(time_ns) * 1e-6; }

  /// Same-tick synapses carry a difference within one tick: what the engine updates first comes first.
  const FirstSpike& first_of_tick(std::size_t k) {
    const auto rank = [&](const FirstSpike& spike) {
      const auto& groups = input_.b.image.groups;
      return std::find_if(groups.begin(), groups.end(),
                          [&](const GroupRecord& group) { return group.population == spike.population; }) -
             groups.begin();
    };
    if (k == 0) {
      std::stable_sort(lock_.spikes.begin(), lock_.spikes.end(), [&](const FirstSpike& x, const FirstSpike& y) {
        return x.time_ns != y.time_ns ? x.time_ns < y.time_ns : rank(x) < rank(y);
      });
    }
    return lock_.spikes[k];
  }

  void spike(const FirstSpike& first) {
    DivergenceLink link;
    link.kind = LinkKind::Spike;
    link.what = neuron_name(input_.b, first.neuron_b);
    link.population = input_.b.populations[first.population].name;
    link.time_ms = ms(first.time_ns);
    link.how = first.fires_in_a ? "does not fire in the second" : "fires in the second only";
    link.others = first.neurons_at_once - 1;
    NeuronCause cause =
        neuron_cause({input_.a, input_.b, input_.structure, spikes_a_, spikes_b_, first.neuron_a, first.neuron_b,
                      static_cast<std::uint32_t>(first.time_ns / input_.a.image.header.tick_ns), first.fires_in_a});
    link.why = cause.why;
    link.how += cause.numbers.empty() ? "" : " (" + cause.numbers + ")";
    link.from = std::move(cause.from);
    link.changes = std::move(cause.changes);
    result_.links.push_back(std::move(link));
  }

  void field(const FirstField& first) {
    const bool is_in_b = first.neuron_b != kNoMatch;
    const CircuitView& view = is_in_b ? input_.b : input_.a;
    const std::uint32_t neuron = is_in_b ? first.neuron_b : first.neuron_a;
    DivergenceLink link;
    link.kind = LinkKind::Field;
    link.what = neuron_name(view, neuron);
    link.population = view.populations[view.population_of(neuron)].name;
    link.time_ms = ms(first.time_ns);
    link.how = first.is_lit_in_a ? "is lit in the first only" : "is lit in the second only";
    for (const RetinaRecord& retina : view.image.retinas) {
      if (neuron >= retina.first_neuron && neuron < retina.first_neuron + retina.field_count) {
        link.changes = changes_of(input_.structure, Element::Retina, std::string(view.image.name(retina.name)));
      }
    }
    if (link.changes.empty()) {  // the input came or went with its population
      link.changes = changes_of(input_.structure, Element::Population, link.population);
    }
    link.why = link.changes.empty() ? "" : change_sentence(input_.structure.changes[link.changes.front()]);
    result_.links.push_back(std::move(link));
  }

  void command(const FirstCommand& first) {
    DivergenceLink link;
    link.kind = LinkKind::Command;
    link.what = kJointNames[first.joint];
    link.time_ms = ms(first.time_ns);
    link.how = fmt::format("is told {:.3f} deg instead of {:.3f} deg", first.b_deg, first.a_deg);
    if (first.is_decoded) {
      decoder_cause(first, link);
    } else {
      link.changes = changes_of(input_.structure, Element::Joint, link.what);
      link.why = link.changes.empty() ? "" : change_sentence(input_.structure.changes[link.changes.front()]);
    }
    result_.links.push_back(std::move(link));
  }

  void decoder_cause(const FirstCommand& first, DivergenceLink& link) const {
    for (const OutputView& output : input_.b.outputs) {
      if ((output.joint_mask >> first.joint & 1U) == 0) {
        continue;
      }
      for (const OutputView::Term& term : output.terms) {
        const auto earlier = std::find_if(lock_.spikes.begin(), lock_.spikes.end(), [&](const FirstSpike& spike) {
          return spike.population == term.population && spike.time_ns < first.time_ns;
        });
        if (earlier != lock_.spikes.end() && link.from.empty()) {
          link.from = input_.b.populations[term.population].name;
          link.why = fmt::format("through output {}, whose {} differs", output.name, link.from);
        }
      }
    }
    if (!link.from.empty()) {
      return;
    }
    // Its neurons do the same, so that the output itself is another; one that has gone drives nothing any more.
    for (std::size_t c = 0; c < input_.structure.changes.size(); ++c) {
      const Change& change = input_.structure.changes[c];
      const auto drives = [&](const CircuitView& view) {
        return std::any_of(view.outputs.begin(), view.outputs.end(), [&](const OutputView& output) {
          return output.name == change.name && (output.joint_mask >> first.joint & 1U) != 0;
        });
      };
      if (change.element == Element::Output && (drives(input_.a) || drives(input_.b))) {
        link.changes.push_back(c);
      }
    }
    link.why = link.changes.empty() ? "" : change_sentence(input_.structure.changes[link.changes.front()]);
  }

  void potential() {
    const auto first =
        first_potential(input_.a, input_.b, input_.structure.match, input_.recording_a, input_.recording_b);
    if (!first) {
      return;
    }
    const auto tick = static_cast<std::uint32_t>(first->time_ns / input_.a.image.header.tick_ns) - 1;
    const NeuronCause cause = neuron_cause({input_.a, input_.b, input_.structure, spikes_a_, spikes_b_, first->neuron_a,
                                            first->neuron_b, tick, false, false});
    DivergenceLink link;
    link.kind = LinkKind::Potential;
    link.what = neuron_name(input_.b, first->neuron_b);
    link.population = input_.b.populations[input_.b.population_of(first->neuron_b)].name;
    link.time_ms = ms(first->time_ns);
    link.how = fmt::format("has {:.5g} mV instead of {:.5g} mV, which no spike shows", first->b, first->a);
    link.why = cause.why;
    link.from = cause.from;
    link.changes = cause.changes;
    result_.links.push_back(std::move(link));
  }

  const DivergenceInput& input_;
  LockStep lock_;
  SpikeTicks spikes_a_, spikes_b_;
  Divergence result_;
};

std::string link_text(const DivergenceLink& link) {
  std::string text = fmt::format("{} {}", link.what, link.how);
  text += link.others == 0 ? "" : fmt::format(", with {} more of {}", link.others, link.population);
  return text;
}

}  // namespace

Divergence find_divergence(const DivergenceInput& input) { return DivergenceFinder(input).run(); }

std::string why_clause(const DivergenceLink& link) {
  return link.why.empty() ? "" : (link.from.empty() ? ", because " : ", ") + link.why;
}

std::string divergence_text(const Divergence& divergence, std::size_t most_links) {
  if (divergence.links.empty()) {
    return fmt::format("no spike, potential or command differs in {:.4g} s\n", divergence.compared_s);
  }
  const DivergenceLink& first = divergence.links.front();
  std::string text =
      fmt::format("first difference: at {:.1f} ms{}\n  {}\n", first.time_ms,
                  divergence.is_driven ? ", of both driven by what the eyes of the first saw" : "", link_text(first));
  text += first.why.empty() ? "" : fmt::format("  because {}\n", first.why);
  const std::size_t shown = std::min(divergence.links.size(), most_links + 1);
  for (std::size_t k = 1; k < shown; ++k) {
    const DivergenceLink& link = divergence.links[k];
    text += fmt::format("{}{:>8.1f} ms  {}{}\n", k == 1 ? "what follows:\n" : "", link.time_ms, link_text(link),
                        why_clause(link));
  }
  if (shown < divergence.links.size()) {
    text += fmt::format("             and {} more populations and joints\n", divergence.links.size() - shown);
  }
  return text;
}

}  // namespace tectum
