#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/diff/behaviour.h"

namespace tectum {
namespace {

std::string spread_text(const PairedFigure& figure) {
  return figure.a.size() < 2 ? "-" : fmt::format("{:.3g}", figure.spread());
}

std::string figure_line(const PairedFigure& figure) {
  const std::optional<bool> exceeds = figure.exceeds_spread();
  const char* verdict = !exceeds ? "one run" : *exceeds ? "beyond the spread" : "within the spread";
  return fmt::format("  {:<18} {:>9.4g} {:>9.4g} {:>+9.3g} {:>9}  {:<5}  {}\n", figure.name, figure.mean_a(),
                     figure.mean_b(), figure.difference(), spread_text(figure), figure.unit, verdict);
}

std::string kinematics_text(const Behaviour& behaviour) {
  std::string text = fmt::format("  {:<18} {:>9} {:>9} {:>9} {:>9}\n", "eyes", "first", "second", "change", "spread");
  std::string missing;
  for (const PairedFigure& figure : behaviour.kinematics) {
    text += figure.a.empty() ? "" : figure_line(figure);
    missing += figure.a.empty() ? (missing.empty() ? "" : ", ") + figure.name : "";
  }
  return text + (missing.empty() ? "" : fmt::format("  not to be had of both: {}\n", missing));
}

const char* star(const PairedFigure& figure) { return figure.exceeds_spread().value_or(false) ? "*" : " "; }

/// Of a battery how much later a population answers a step; otherwise how much later it does everything.
std::string later_text(const PopulationDifference& p, bool is_closed_loop) {
  if (!p.latency.a.empty()) {
    return fmt::format("{:+.1f}{}", p.latency.difference(), star(p.latency));
  }
  return is_closed_loop || !p.lag_ms ? "- " : fmt::format("{:+.0f} ", *p.lag_ms);
}

std::string populations_text(const Behaviour& behaviour) {
  constexpr std::size_t kMost = 10;
  std::vector<const PopulationDifference*> order;
  for (const PopulationDifference& population : behaviour.populations) {
    order.push_back(&population);
  }
  std::stable_sort(order.begin(), order.end(), [](const PopulationDifference* x, const PopulationDifference* y) {
    return x->van_rossum > y->van_rossum;
  });
  std::string text =
      fmt::format("  {:<18} {:>9} {:>9} {:>9} {:>9} {:>8} {:>10} {:>9} {:>6}\n", "population", "first Hz", "second Hz",
                  "change", "spread", "later ms", "van Rossum", "Vic.-Pur.", "SPIKE");
  for (std::size_t k = 0; k < std::min(order.size(), kMost); ++k) {
    const PopulationDifference& p = *order[k];
    text += fmt::format("  {:<18} {:>9.1f} {:>9.1f} {:>+8.1f}{} {:>9} {:>8} {:>10.2f} {:>9.1f} {:>6.3f}\n", p.name,
                        p.rate.mean_a(), p.rate.mean_b(), p.rate.difference(), star(p.rate), spread_text(p.rate),
                        later_text(p, behaviour.is_closed_loop), p.van_rossum, p.victor_purpura, p.spike);
  }
  if (order.size() > kMost) {
    text += fmt::format("  and {} more, which differ less\n", order.size() - kMost);
  }
  return text;
}

/// Those beyond their spread, the largest change for its size first. Of a single pair of runs nobody knows the spread.
std::vector<const PairedFigure*> telling_figures(const Behaviour& behaviour) {
  std::vector<const PairedFigure*> found;
  for (const PairedFigure& figure : behaviour.kinematics) {
    if (!figure.a.empty() && figure.exceeds_spread().value_or(figure.difference() != 0)) {
      found.push_back(&figure);
    }
  }
  const auto relative = [](const PairedFigure* figure) {
    return std::abs(figure->difference()) / std::max({std::abs(figure->mean_a()), std::abs(figure->mean_b()), 1e-12});
  };
  std::stable_sort(found.begin(), found.end(),
                   [&](const PairedFigure* x, const PairedFigure* y) { return relative(x) > relative(y); });
  return found;
}

std::string cause_text(const StructureDiff& structure, const DivergenceLink& first) {
  if (first.changes.empty()) {
    return "";
  }
  const Change& change = structure.changes[first.changes.front()];
  if (!change.because.empty()) {
    return change.because;
  }
  const std::string subject = fmt::format("{} {}", element_name(change.element), change.name);
  if (change.kind != ChangeKind::Changed) {
    return fmt::format("{} is {}", subject, change_name(change.kind));
  }
  return fmt::format("{} of {} is {} instead of {}", change.property, subject, change.after, change.before);
}

}  // namespace

std::string verdict_text(const StructureDiff& structure, const Behaviour& behaviour) {
  if (behaviour.is_same) {
    return structure.is_same() ? "the same behaviour\n" : "written differently, but the same behaviour\n";
  }
  std::string text;
  if (!behaviour.divergence.links.empty()) {
    const DivergenceLink& first = behaviour.divergence.links.front();
    const std::string cause = cause_text(structure, first);
    text += cause.empty() ? "" : cause + ": ";
    text += fmt::format("from {:.1f} ms on {} differs", first.time_ms, first.what);
  }
  const std::vector<const PairedFigure*> telling = telling_figures(behaviour);
  constexpr std::size_t kMost = 3;
  for (std::size_t k = 0; k < std::min(telling.size(), kMost); ++k) {
    const PairedFigure& figure = *telling[k];
    text += fmt::format("{}{} {:.3g}{} instead of {:.3g}{}",
                        text.empty() ? ""
                        : k == 0     ? "; "
                                     : ", ",
                        figure.name, figure.mean_b(), figure.unit.empty() ? "" : " " + figure.unit, figure.mean_a(),
                        figure.unit.empty() ? "" : " " + figure.unit);
  }
  if (telling.empty() && !behaviour.kinematics.empty()) {
    text += "; no change of the eyes' movements beyond the spread";
  }
  return text + "\n";
}

std::string behaviour_text(const Behaviour& behaviour) {
  std::string text = divergence_text(behaviour.divergence);
  text += "\nbehaviour: " + behaviour.what + "\n";
  if (behaviour.is_same) {
    return text + "  the same, spike for spike and command for command\n";
  }
  if (!behaviour.kinematics.empty()) {
    text += kinematics_text(behaviour);
  }
  if (!behaviour.populations.empty()) {
    text += populations_text(behaviour);
  }
  return text;
}

}  // namespace tectum
