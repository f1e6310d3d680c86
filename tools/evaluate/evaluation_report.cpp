#include "tools/evaluate/evaluation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/evaluate/evaluation_text.h"
#include "tools/evaluate/step_chart.h"
#include "tools/report/report_page.h"
#include "tools/report/svg.h"

namespace tectum {
namespace {

constexpr double kExcerptS = 12;
constexpr std::array<const char*, kControllers> kControllerInks = {"left", "target", "right"};

std::string subtitle(const EvaluationTitle& title, const Protocol& protocol) {
  return fmt::format("{}: {} trial{}, seeds from {}, {} Hz, wall at {} m", title.circuit, protocol.trials,
                     protocol.trials == 1 ? "" : "s", protocol.first_seed, number_text(protocol.frame_rate_hz, 0),
                     number_text(protocol.wall_distance_m, 2));
}

/// A short name stays on one line, whatever the table's width.
std::string unbroken(std::string name) {
  constexpr std::size_t kShort = 20;
  if (name.size() > kShort) {
    return name;
  }
  for (std::size_t at = name.find(' '); at != std::string::npos; at = name.find(' ', at)) {
    name.replace(at, 1, "\u00a0");
  }
  return name;
}

ReportPage begin_page(const EvaluationTitle& title, const Protocol& protocol) {
  ReportPage page;
  if (!title.command_line.empty()) {
    page.html(fmt::format("<p><code>{}</code></p>\n", xml_escape(title.command_line)));
  }
  page.paragraph(protocol.about);
  return page;
}

// Tracking

std::vector<std::string> tracking_row(const std::string& name, const ControllerResult& result, double oracle_deg) {
  const ChannelSummary& all = result.all;
  return {name,
          number_text(all.rmse_deg, 2) + "°",
          oracle_deg > 0 ? number_text(all.rmse_deg / oracle_deg, 2) : "–",
          number_text(all.settled_rmse_deg, 2) + "°",
          number_text(all.median_abs_deg, 2) + "°",
          number_text(100 * all.fovea_share, 0) + " %",
          number_text(1000 * result.steps.median_latency_s, 0) + " ms",
          number_text(100 * result.steps.median_overshoot_share, 0) + " %",
          number_text(1000 * result.steps.median_settled_s, 0) + " ms"};
}

/// Left eye, horizontally: the target as the oracle's run has it, and each controller's gaze.
Chart excerpt(const SettingResult& setting) {
  Chart chart;
  chart.description = "target and gaze of the left eye over time, circuit, oracle and PID servo";
  const AngleTrace target = target_trace(setting.of(Controller::Oracle).first_trial, Eye::Left);
  const double end_s = target.time_s.empty() ? 0 : target.time_s.back();
  const double begin_s = std::max(0.0, std::min(4.0, end_s - kExcerptS));
  chart.x = {.label = "time (s)", .min = begin_s, .max = std::min(end_s, begin_s + kExcerptS)};
  chart.y = {.label = "left eye, horizontal (deg)", .min = {}, .max = {}};
  const auto add = [&](const AngleTrace& trace, const char* name, const char* ink, bool is_dashed) {
    Series series{.kind = SeriesKind::Line, .name = name, .ink = ink, .x = {}, .y = {}, .is_dashed = is_dashed};
    for (std::size_t k = 0; k < trace.time_s.size(); ++k) {
      if (trace.time_s[k] >= *chart.x.min && trace.time_s[k] <= *chart.x.max) {
        series.x.push_back(trace.time_s[k]);
        series.y.push_back(trace.pan_deg[k]);
      }
    }
    chart.series.push_back(std::move(series));
  };
  add(target, "target", "fg", true);
  for (const std::size_t c : {1U, 2U, 0U}) {
    add(gaze_trace(setting.controllers[c].first_trial, Eye::Left), kControllerNames[c], kControllerInks[c], false);
  }
  return chart;
}

void add_published(ReportPage& page, const Protocol& protocol) {
  if (protocol.published.empty()) {
    return;
  }
  page.heading("Published");
  page.paragraph(protocol.published_by);
  ReportTable table;
  table.header = {"", "median", "RMSE", "learned: median", "learned: RMSE"};
  const auto text = [](const std::optional<double>& value_deg) {
    return value_deg ? number_text(*value_deg, 2) + "°" : std::string("–");
  };
  for (const PublishedRow& row : protocol.published) {
    table.rows.push_back(
        {row.what, text(row.median_deg), text(row.rmse_deg), text(row.learned_median_deg), text(row.learned_rmse_deg)});
  }
  page.table(table);
}

// Physiology

constexpr double kRowPx = 40;
constexpr double kMarkPx = 5;

/// One line a yardstick, all on one scale: 0 is the low end of what was published, 1 the high end.
std::string band_picture(const std::vector<Yardstick>& yardsticks, double width_px, const std::string& css) {
  SvgBody svg;
  const double left_px = 8, right_px = width_px - 8;
  const double low_px = left_px + 0.3 * (right_px - left_px), high_px = left_px + 0.7 * (right_px - left_px);
  double y = 4;
  for (const Yardstick& yardstick : yardsticks) {
    const bool is_open = yardstick.high >= 1e4;
    svg.text(left_px, y + 12, fit_text(yardstick.what, right_px - left_px - 90), "f-fg small");
    const std::string value =
        yardstick.value ? fmt::format("{:.4g} {}", *yardstick.value, yardstick.unit) : std::string("not measurable");
    svg.text(right_px, y + 12, value, "f-muted small end");
    const double line_y = y + 24;
    svg.line(left_px, line_y, right_px, line_y, "s-grid hair");
    svg.rect({low_px, line_y - 6, (is_open ? right_px : high_px) - low_px, 12}, "f-c2", 0.25);
    if (yardstick.value) {
      const double span = is_open ? std::max(yardstick.low, 1.0) : yardstick.high - yardstick.low;
      const double share = (*yardstick.value - yardstick.low) / span;
      const double x = std::clamp(low_px + share * (high_px - low_px), left_px + kMarkPx, right_px - kMarkPx);
      svg.circle(x, line_y, kMarkPx, yardstick.passes() ? "f-c2" : "f-right");
    }
    y += kRowPx;
  }
  return inline_svg(svg, width_px, y + 4, css, "each yardstick's value beside the published range");
}

}  // namespace

std::string tracking_report(const EvaluationTitle& title, const Protocol& protocol,
                            const TrackingEvaluation& evaluation, const RecordedHead* recorded) {
  ReportPage page = begin_page(title, protocol);
  std::vector<ReportCard> cards;
  for (const SettingResult& setting : evaluation.settings) {
    const double oracle_deg = setting.of(Controller::Oracle).all.rmse_deg;
    cards.push_back({number_text(setting.of(Controller::Circuit).all.rmse_deg / std::max(oracle_deg, 1e-9), 2) + " ×",
                     "the oracle's RMSE; " + setting_text(setting.setting)});
  }
  page.cards(cards);
  for (const SettingResult& setting : evaluation.settings) {
    page.heading(setting_text(setting.setting));
    ReportTable table;
    table.header = {"",         "RMSE",         "over oracle", "settled RMSE",   "median |error|",
                    "on fovea", "starts after", "overshoot",   "within 2° after"};
    for (std::size_t c = 0; c < kControllers; ++c) {
      table.rows.push_back(
          tracking_row(kControllerNames[c], setting.controllers[c], setting.of(Controller::Oracle).all.rmse_deg));
    }
    if (recorded != nullptr) {
      table.rows.push_back(tracking_row("recorded", recorded->result, setting.of(Controller::Oracle).all.rmse_deg));
    }
    page.table(table);
    page.figure("First trial", "The PID servo: " + gains_text(setting.pid), responsive_chart(excerpt(setting), 300));
    if (recorded != nullptr) {
      page.figure("After a jump, beside the recorded head",
                  fmt::format("Share of the way to the target that the eye has gone, median over the jumps and both "
                              "eyes of a trial. Recorded: {}.",
                              recorded->path),
                  responsive_chart(step_chart(setting, *recorded), 300));
    }
  }
  add_published(page, protocol);
  return page.finish("Protocol " + protocol.name, subtitle(title, protocol));
}

std::string physiology_report(const EvaluationTitle& title, const Protocol& protocol,
                              const std::vector<Yardstick>& yardsticks) {
  ReportPage page = begin_page(title, protocol);
  const auto passed = static_cast<std::size_t>(
      std::count_if(yardsticks.begin(), yardsticks.end(), [](const Yardstick& y) { return y.passes(); }));
  page.cards({{fmt::format("{} of {}", passed, yardsticks.size()), "yardsticks within what was published"}});
  page.figure("Beside what was published",
              "Shaded: the published range, stretched to the same width in every line. Green: within it. A dot at the "
              "edge lies farther out.",
              band_picture(yardsticks, kWidePx, "wide") + band_picture(yardsticks, kNarrowPx, "narrow"));
  ReportTable table;
  table.header = {"", "value", "published", "passes"};
  for (const Yardstick& y : yardsticks) {
    table.rows.push_back({y.what, y.value ? fmt::format("{:.4g} {}", *y.value, y.unit) : "–",
                          y.high >= 1e4 ? fmt::format("over {:g}", y.low) : fmt::format("{:g} to {:g}", y.low, y.high),
                          y.passes() ? "yes" : "no"});
    table.notes.push_back(y.source);
  }
  page.table(table);
  return page.finish("Protocol " + protocol.name, subtitle(title, protocol));
}

std::string measures_report(const EvaluationTitle& title, const Protocol& protocol, const MeasuredProtocol& measured) {
  ReportPage page = begin_page(title, protocol);
  for (const MeasureTable& each : measured.tables) {
    page.heading(each.title);
    ReportTable table;
    table.header = {""};
    for (const MeasureColumn& column : each.columns) {
      table.header.push_back(column.unit.empty() ? column.name : fmt::format("{} ({})", column.name, column.unit));
    }
    for (const MeasureRow& row : each.rows) {
      std::vector<std::string> cells = {unbroken(row.what)};
      for (std::size_t c = 0; c < each.columns.size(); ++c) {
        cells.push_back(row.values[c] ? number_text(*row.values[c], each.columns[c].decimals) : "–");
      }
      table.rows.push_back(std::move(cells));
    }
    page.table(table);
    for (const std::string& note : each.notes) {
      page.paragraph(note);
    }
  }
  page.begin_grid();
  for (const MeasurePicture& picture : measured.pictures) {
    page.figure(picture.title, picture.caption, chart_svg(picture.chart, kNarrowPx, 300, "both"));
  }
  page.end_grid();
  return page.finish("Protocol " + protocol.name, subtitle(title, protocol));
}

std::string text_report(const EvaluationTitle& title, const Protocol& protocol, const std::string& text) {
  ReportPage page = begin_page(title, protocol);
  page.html(fmt::format("<pre style=\"overflow-x:auto\">{}</pre>\n", xml_escape(text)));
  return page.finish("Protocol " + protocol.name, subtitle(title, protocol));
}

}  // namespace tectum
