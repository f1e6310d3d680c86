#include "tools/diff/diff_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "tools/diff/connectome.h"
#include "tools/diff/spike_overlay.h"
#include "tools/report/chart.h"
#include "tools/report/report_page.h"
#include "tools/report/run_figures.h"

namespace tectum {
namespace {

constexpr std::size_t kMostLanes = 24;
constexpr std::size_t kMostRows = 40;
constexpr double kZoomBeforeS = 0.05, kZoomS = 0.5;
constexpr std::size_t kKeepsEvery = 2;  // of samples at 500 Hz: finer than a pixel is wide

struct Comparison {
  const DiffSubject& a;
  const DiffSubject& b;
  const StructureDiff& structure;
  const Behaviour* behaviour;
};

/// "A -> B" with an arrow that no line break takes apart.
std::string with_arrows(std::string text) {
  for (std::size_t at = 0; (at = text.find(" -> ", at)) != std::string::npos;) {
    text.replace(at, 4, "\u00a0\u2192 ");
  }
  return text;
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

void add_legend(ReportPage& page, bool has_both) {
  const auto entry = [](const char* ink, const char* text) {
    return fmt::format("<span style=\"white-space:nowrap\"><b style=\"color:var(--{})\">&#9632;</b> {}</span>&#8194;",
                       ink, text);
  };
  page.html("<p class=\"muted\">" + (has_both ? entry("target", "spikes of both") : "") +
            entry("left", has_both ? "of the first alone" : "first") +
            entry("right", has_both ? "of the second alone" : "second") + "</p>\n");
}

void add_changes(ReportPage& page, const Comparison& found) {
  page.heading("What was changed");
  if (found.structure.is_same()) {
    page.paragraph(found.a.has_circuit && found.b.has_circuit
                       ? "Nothing: the two circuits are the same."
                       : "Unknown: a recording without its circuit is compared by what its neurons did.");
    return;
  }
  ReportTable table;
  table.header = {"where", "what"};
  table.holds_text = true;
  const std::vector<ChangeLine> lines = change_lines(found.structure);
  for (std::size_t k = 0; k < std::min(lines.size(), kMostRows); ++k) {
    const ChangeLine& line = lines[k];
    const std::string sides = line.sides.empty() ? "" : fmt::format(" [{}]", line.sides);
    const std::string because = line.because.empty() ? "" : ", because " + line.because;
    table.rows.push_back({line.group.empty() ? "circuit" : line.group, with_arrows(line.text + sides + because)});
    table.notes.push_back(line.place.empty() ? "" : file_name(line.place));
  }
  page.table(table);
  if (lines.size() > kMostRows) {
    page.paragraph(fmt::format("and {} more, which --format json lists", lines.size() - kMostRows));
  }
}

/// Populations and projections that a change names in this circuit.
std::set<std::string> changed_names(const StructureDiff& structure, bool is_second) {
  std::set<std::string> names;
  for (const Change& change : structure.changes) {
    const bool is_here = is_second ? change.kind != ChangeKind::Removed : change.kind != ChangeKind::Added;
    if (is_here && (change.element == Element::Population || change.element == Element::Projection)) {
      names.insert(!is_second && change.kind == ChangeKind::Renamed ? change.before : change.name);
    }
    if (is_here && change.element == Element::Retina) {
      names.insert(change.name);
    }
  }
  return names;
}

void add_connectome(ReportPage& page, const Comparison& found) {
  if (!found.a.has_circuit || !found.b.has_circuit || found.structure.is_same()) {
    return;
  }
  const std::set<std::string> names = changed_names(found.structure, true);
  const bool loses = std::any_of(found.structure.changes.begin(), found.structure.changes.end(),
                                 [](const Change& change) { return change.kind == ChangeKind::Removed; });
  page.heading("The connectome");
  page.figure("The second circuit",
              names.empty() ? "No population and no projection differs."
                            : "Heavy and pink: populations and projections that are new or changed.",
              responsive_connectome(connectome_of(found.b.view, names)));
  if (loses) {
    page.figure("The first circuit",
                "Heavy and pink: populations and projections that are gone or changed in the second.",
                responsive_connectome(connectome_of(found.a.view, changed_names(found.structure, false))));
  }
}

void add_divergence(ReportPage& page, const Divergence& divergence) {
  page.heading("Where they part");
  if (divergence.links.empty()) {
    page.paragraph(fmt::format("No spike, potential or command differs in {:.4g} s.", divergence.compared_s));
    return;
  }
  page.paragraph(std::string(divergence.is_driven
                                 ? "Both driven by what the eyes of the first saw, so that up to the first "
                                   "difference they have the same past. "
                                 : "As recorded. ") +
                 "One row a population or joint, when it first differs.");
  ReportTable table;
  table.header = {"ms", "what differs"};
  table.holds_text = true;
  for (const DivergenceLink& link : divergence.links) {
    std::string text = fmt::format("{} {}", link.what, link.how);
    text += link.others == 0 ? "" : fmt::format(", with {} more of {}", link.others, link.population);
    text += why_clause(link);
    table.rows.push_back({number_text(link.time_ms, 1), with_arrows(text)});
  }
  page.table(table);
}

std::string change_text(const PairedFigure& figure, int decimals) {
  return (figure.difference() > 0 ? "+" : "") + number_text(figure.difference(), decimals);
}

int decimals_for(const PairedFigure& figure) {
  const double largest = std::max(std::abs(figure.mean_a()), std::abs(figure.mean_b()));
  return largest >= 100 ? 0 : largest >= 10 ? 1 : 2;
}

void add_kinematics_table(ReportPage& page, const Behaviour& behaviour) {
  ReportTable table;
  table.header = {"", "first", "second", "change", "spread"};
  for (const PairedFigure& figure : behaviour.kinematics) {
    const std::string name = figure.unit.empty() ? figure.name : fmt::format("{}, {}", figure.name, figure.unit);
    if (figure.a.empty()) {
      table.rows.push_back({name, "–", "–", "–", "–"});
      table.notes.emplace_back("not to be had of both");
      continue;
    }
    const int decimals = decimals_for(figure);
    const std::optional<bool> exceeds = figure.exceeds_spread();
    table.rows.push_back({name, number_text(figure.mean_a(), decimals), number_text(figure.mean_b(), decimals),
                          change_text(figure, decimals), exceeds ? number_text(figure.spread(), decimals) : "–"});
    table.notes.emplace_back(!exceeds ? "one run" : *exceeds ? "beyond the spread" : "within the spread");
  }
  page.table(table);
}

Series eye_series(const Recording& recording, Eye eye, GazeAxis axis, std::string name, std::string ink) {
  const AngleTrace trace = shaft_trace(recording, eye);
  Series series;
  series.name = std::move(name);
  series.ink = std::move(ink);
  const std::size_t step = recording.positions.empty() ? 1 : kKeepsEvery;
  for (std::size_t k = 0; k < trace.time_s.size(); k += step) {
    series.x.push_back(trace.time_s[k]);
    series.y.push_back(axis == GazeAxis::Horizontal ? trace.pan_deg[k] : trace.tilt_deg[k]);
  }
  return series;
}

Chart eye_chart(const Behaviour& behaviour, Eye eye, GazeAxis axis) {
  const bool is_pan = axis == GazeAxis::Horizontal;
  Chart chart;
  chart.description = fmt::format("{} direction of the {} eye in both", is_pan ? "horizontal" : "vertical",
                                  eye == Eye::Left ? "left" : "right");
  const TimeRange range = time_range(behaviour.first_a);
  chart.x = {"time (s)", range.begin_s, range.end_s, 0};
  chart.y = {is_pan ? "right + (deg)" : "up + (deg)", {}, {}, 4};
  chart.has_cursor = true;
  const AngleTrace target = target_trace(behaviour.first_a, eye);
  if (!target.time_s.empty()) {
    Series series;
    series.kind = SeriesKind::Step;
    series.name = "target";
    series.ink = "target";
    series.width_px = 2.6;
    series.x = target.time_s;
    series.y = is_pan ? target.pan_deg : target.tilt_deg;
    chart.series.push_back(std::move(series));
  }
  chart.series.push_back(eye_series(behaviour.first_a, eye, axis, "first", "left"));
  chart.series.push_back(eye_series(behaviour.first_b, eye, axis, "second", "right"));
  return chart;
}

void add_eyes(ReportPage& page, const Comparison& found) {
  const Behaviour& behaviour = *found.behaviour;
  if (behaviour.kinematics.empty()) {
    return;
  }
  page.heading("Eyes");
  page.paragraph(
      "Means over the seeds. Spread: standard deviation of the change over the seeds, in each of which both have the "
      "same "
      "target and the same noise. Beyond the spread: every seed changes the same way, and the mean change is larger.");
  add_kinematics_table(page, behaviour);
  page.paragraph("Where the eyes look, first run:");
  for (const Eye eye : {Eye::Left, Eye::Right}) {
    for (const GazeAxis axis : {GazeAxis::Horizontal, GazeAxis::Vertical}) {
      const std::string name = fmt::format("{} eye, {}", eye == Eye::Left ? "Left" : "Right",
                                           axis == GazeAxis::Horizontal ? "horizontal" : "vertical");
      page.figure(name, "", responsive_chart(eye_chart(behaviour, eye, axis), 230));
    }
  }
}

std::vector<const PopulationDifference*> by_distance(const Behaviour& behaviour) {
  std::vector<const PopulationDifference*> order;
  for (const PopulationDifference& population : behaviour.populations) {
    order.push_back(&population);
  }
  std::stable_sort(order.begin(), order.end(), [](const PopulationDifference* x, const PopulationDifference* y) {
    return x->van_rossum > y->van_rossum;
  });
  order.resize(std::min(order.size(), kMostRows));
  return order;
}

void add_populations(ReportPage& page, const Behaviour& behaviour) {
  page.heading("Populations");
  if (behaviour.populations.empty()) {
    page.paragraph("Every population fires the same spikes.");
    return;
  }
  page.paragraph(fmt::format(
      "{} of {} differ{}.", behaviour.populations.size(), behaviour.first_b.populations.size(),
      behaviour.populations.size() > kMostRows ? fmt::format(". These {} differ most", kMostRows) : std::string()));
  ReportTable rates;
  rates.header = {"mean rate, Hz", "first", "second", "change", "later, ms"};
  ReportTable distances;
  distances.header = {"distance", "van Rossum", "Vic.-Pur.", "SPIKE"};
  for (const PopulationDifference* p : by_distance(behaviour)) {
    const bool has_latency = !p->latency.a.empty();
    const std::string later =
        has_latency ? change_text(p->latency, 1) + (p->latency.exceeds_spread().value_or(false) ? "*" : "") : "–";
    rates.rows.push_back({p->name, number_text(p->rate.mean_a(), 1), number_text(p->rate.mean_b(), 1),
                          change_text(p->rate, 1) + (p->rate.exceeds_spread().value_or(false) ? "*" : ""), later});
    distances.rows.push_back(
        {p->name, number_text(p->van_rossum, 2), number_text(p->victor_purpura, 1), number_text(p->spike, 3)});
  }
  page.table(rates);
  page.paragraph("* beyond the spread over the seeds. Later: how much later its answer to a step comes.");
  page.begin_details("Distances between spike trains");
  page.paragraph(
      "Means over up to 16 neurons of the first run: van Rossum (2001) with 10 ms, Victor and Purpura (1996) with 0.1 "
      "a "
      "ms, SPIKE (Kreuz and others 2013).");
  page.table(distances);
  page.end_details();
}

void add_rasters(ReportPage& page, const Comparison& found) {
  const Behaviour& behaviour = *found.behaviour;
  const SpikeOverlay overlay(found.a.view, found.b.view, found.structure, behaviour, kMostLanes);
  if (overlay.is_empty()) {
    return;
  }
  page.heading("Spikes over each other");
  add_legend(page, true);
  const TimeRange range = time_range(behaviour.first_a);
  LaneWindow zoom{range.begin_s, std::min(range.end_s, range.begin_s + kZoomS)};
  if (!behaviour.divergence.links.empty()) {
    zoom.begin_s = std::max(range.begin_s, behaviour.divergence.links.front().time_ms * 1e-3 - kZoomBeforeS);
    zoom.end_s = std::min(range.end_s, zoom.begin_s + kZoomS);
  }
  std::vector<double> steps_s;
  for (const RunPart& part : behaviour.first_parts) {
    if (part.kind == PartKind::Step) {
      steps_s.push_back(part.begin_s);
    }
  }
  page.figure("From just before the first difference",
              fmt::format("{} of {} populations that differ: those that it reaches first, and those that end up most "
                          "different. One row a neuron.",
                          std::min(behaviour.populations.size(), kMostLanes), behaviour.populations.size()),
              overlay.picture({.window = zoom, .max_lane_px = 44, .marks_s = steps_s, .shades = {}},
                              "spikes of both circuits around their first difference"));
  page.figure(
      "Whole run",
      std::string(steps_s.empty() ? "" : "Thin vertical lines: the target jumps. ") +
          "Where several spikes share a point, it has the colour of most of them; a spike of the first and one of the "
          "second count as a spike of both there.",
      overlay.picture({.window = {range.begin_s, range.end_s}, .max_lane_px = 30, .marks_s = steps_s, .shades = {zoom}},
                      "spikes of both circuits over the whole run"));
}

std::vector<ReportCard> cards_of(const Comparison& found) {
  std::vector<ReportCard> cards;
  cards.push_back({count_text(change_lines(found.structure).size()), "changes of the circuit"});
  const Behaviour* behaviour = found.behaviour;
  if (behaviour == nullptr) {
    return cards;
  }
  if (!behaviour->divergence.links.empty()) {
    const DivergenceLink& first = behaviour->divergence.links.front();
    cards.push_back({number_text(first.time_ms, 1) + " ms", "first difference, in " + first.what});
  }
  cards.push_back({count_text(behaviour->populations.size()), "populations whose spikes differ"});
  std::size_t beyond = 0;
  for (const PairedFigure& figure : behaviour->kinematics) {
    beyond += figure.exceeds_spread().value_or(false) ? 1U : 0U;
  }
  if (!behaviour->kinematics.empty() && behaviour->kinematics.front().a.size() != 1) {
    cards.push_back({fmt::format("{} of {}", beyond, behaviour->kinematics.size()),
                     "measures of the eyes' movements change beyond their spread"});
  }
  return cards;
}

}  // namespace

std::string diff_report_html(const DiffSubject& a, const DiffSubject& b, const StructureDiff& structure,
                             const Behaviour* behaviour, const DiffReportOptions& options) {
  const Comparison found{a, b, structure, behaviour};
  ReportPage page;
  if (behaviour != nullptr) {
    std::string verdict = verdict_text(structure, *behaviour);
    verdict.pop_back();
    page.html(fmt::format("<p><b>{}</b></p>\n", xml_escape(verdict)));
  }
  add_legend(page, false);
  page.cards(cards_of(found));
  add_changes(page, found);
  if (behaviour != nullptr) {
    add_divergence(page, behaviour->divergence);
  }
  if (behaviour != nullptr && !behaviour->is_same) {
    add_eyes(page, found);
    add_rasters(page, found);
    add_populations(page, *behaviour);
  }
  add_connectome(page, found);
  if (!options.command_line.empty()) {
    page.html(fmt::format("<p class=\"muted\"><code>{}</code></p>\n", xml_escape(options.command_line)));
  }
  const std::string what = behaviour == nullptr ? "structure only" : behaviour->what;
  return page.finish(fmt::format("{} and {}", file_name(a.path), file_name(b.path)),
                     fmt::format("first: {}; second: {}; {}", a.path, b.path, what));
}

}  // namespace tectum
