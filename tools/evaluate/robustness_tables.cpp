// What the robustness protocol found, as tables and pictures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/analysis/statistics.h"
#include "tools/evaluate/robustness.h"

namespace tectum {
namespace {

std::optional<double> mean_if_any(const std::vector<double>& sample) {
  return sample.empty() ? std::nullopt : std::optional(mean(sample));
}

/// Half the range between the best and the worst trial, so that three trials do not pretend to be a distribution.
double half_range(const std::vector<double>& sample) {
  const auto [low, high] = std::minmax_element(sample.begin(), sample.end());
  return (*high - *low) / 2;
}

std::optional<double> ratio(const std::optional<double>& value, const std::vector<double>& undisturbed) {
  return value ? std::optional(*value / mean(undisturbed)) : std::nullopt;
}

MeasureRow row_of(const std::string& what, const DisturbedRmse& at, const DisturbedRmse& undisturbed) {
  const std::optional<double> circuit = mean(at.circuit_deg), pid = mean_if_any(at.pid_deg);
  return {what,
          {circuit, half_range(at.circuit_deg), ratio(circuit, undisturbed.circuit_deg), pid,
           ratio(pid, undisturbed.pid_deg), mean_if_any(at.oracle_deg)}};
}

/// A disturbance that is not there is 0 of it; of the brightnesses every level is a disturbance.
bool begins_at_zero(Disturbance disturbance) {
  return disturbance != Disturbance::DotBrightness && disturbance != Disturbance::RoomBrightness;
}

std::string level_text(const DisturbanceFacts& facts, double level) {
  return fmt::format("{:.3g}{}{}", level * facts.as_shown, facts.unit == std::string("%") ? " " : "",
                     facts.unit == std::string("%") ? "%" : "");
}

/// Means over the levels, with a bar from the best to the worst trial of the circuit.
Chart chart_of(Disturbance disturbance, const std::vector<DisturbedRmse>& levels, const DisturbedRmse& undisturbed) {
  const DisturbanceFacts& facts = facts_of(disturbance);
  std::vector<DisturbedRmse> shown = levels;
  if (begins_at_zero(disturbance)) {
    shown.insert(shown.begin(), undisturbed);
  }
  std::sort(shown.begin(), shown.end(), [](const auto& a, const auto& b) { return a.level < b.level; });
  Chart chart;
  chart.description = fmt::format("RMSE against {}", facts.title);
  chart.x.label = fmt::format("{} ({})", facts.title, facts.unit);
  chart.y = {.label = "RMSE (deg)", .min = 0, .max = {}};
  Series circuit{.name = "circuit", .ink = "left", .x = {}, .y = {}, .width_px = 2};
  Series pid{.name = "PID", .ink = "c2", .x = {}, .y = {}};
  Series oracle{.name = "oracle", .ink = "target", .x = {}, .y = {}, .is_dashed = true};
  Series trials{.kind = SeriesKind::Points, .name = "single trials", .ink = "left", .x = {}, .y = {}, .opacity = 0.5};
  for (const DisturbedRmse& at : shown) {
    const double x = at.level * facts.as_shown;
    const auto add = [x](Series& to, double y) {
      to.x.push_back(x);
      to.y.push_back(y);
    };
    add(circuit, mean(at.circuit_deg));
    for (const double each : at.circuit_deg) {
      add(trials, each);
    }
    if (!facts.is_of_the_circuit) {
      add(pid, mean(at.pid_deg));
      add(oracle, mean(at.oracle_deg));
    }
  }
  chart.series.push_back(std::move(circuit));
  chart.series.push_back(std::move(trials));
  if (!facts.is_of_the_circuit) {
    chart.series.push_back(std::move(pid));
    chart.series.push_back(std::move(oracle));
  }
  return chart;
}

}  // namespace

MeasuredProtocol robustness_tables(const RobustnessResult& result) {
  MeasuredProtocol measured;
  for (std::size_t d = 0; d < kDisturbances; ++d) {
    const auto disturbance = static_cast<Disturbance>(d);
    const DisturbanceFacts& facts = facts_of(disturbance);
    if (result.levels[d].empty()) {
      continue;
    }
    MeasureTable table;
    table.title = fmt::format("{} ({})", facts.title, facts.unit);
    table.columns = {{"circuit", "deg", 2}, {"+- trials", "deg", 2},        {"of undisturbed", "times", 2},
                     {"PID", "deg", 2},     {"PID of its own", "times", 2}, {"oracle", "deg", 2}};
    table.rows.push_back(row_of("undisturbed", result.undisturbed, result.undisturbed));
    for (const DisturbedRmse& at : result.levels[d]) {
      table.rows.push_back(row_of(level_text(facts, at.level), at, result.undisturbed));
    }
    measured.tables.push_back(std::move(table));
    const char* caption =
        facts.is_of_the_circuit ? "The servo has no such parts." : "The servo gets the same pictures.";
    measured.pictures.push_back({facts.title, caption, chart_of(disturbance, result.levels[d], result.undisturbed)});
  }
  return measured;
}

}  // namespace tectum
