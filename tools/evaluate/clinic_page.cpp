// The clinic's results as a page: a table of verdicts, and for each lesion how the eyes moved without and with it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/evaluate/clinic_words.h"
#include "tools/report/chart.h"
#include "tools/report/report_page.h"

namespace tectum {
namespace {

constexpr double kPictureHeightPx = 220;
constexpr double kReachDeg = 25;
constexpr std::array<const char*, kEyeCount> kInks = {"left", "right"};
constexpr std::array<const char*, kEyeCount> kNames = {"left eye", "right eye"};

/// Every fourth sample: 125 Hz are enough for a picture.
Series eye_series(const AngleTrace& trace, std::size_t eye, bool is_whole, bool is_vertical) {
  const std::vector<double>& value = is_vertical ? trace.tilt_deg : trace.pan_deg;
  Series series{
      .name = std::string(kNames[eye]) + (is_whole ? ", whole" : ", lesioned"), .ink = kInks[eye], .x = {}, .y = {}};
  series.is_dashed = is_whole;
  series.opacity = is_whole ? 0.5 : 1;
  series.width_px = is_whole ? 1 : 1.6;
  for (std::size_t k = 0; k < trace.time_s.size(); k += 4) {
    series.x.push_back(trace.time_s[k]);
    series.y.push_back(value[k]);
  }
  return series;
}

/// One of the two rounds, and the rest in the dark.
std::string picture(const ClinicPlan& plan, const ClinicTrial& trial, const ClinicTrial& whole, bool is_vertical) {
  const std::vector<ClinicStep> steps = clinic_steps(plan);
  Chart chart;
  chart.description = is_vertical ? "vertical angle of both eyes over time" : "horizontal angle of both eyes over time";
  chart.x = {.label = "time (s)", .min = 0, .max = steps.back().end_s};
  chart.y = {.label = is_vertical ? "up (deg)" : "right (deg)", .min = -kReachDeg, .max = kReachDeg};
  chart.has_cursor = true;
  Series target{.kind = SeriesKind::Step, .name = "dot", .ink = "target", .x = {}, .y = {}};
  for (const ClinicStep& step : steps) {
    target.x.push_back(step.begin_s);
    target.y.push_back(step.is_dark ? std::nan("") : is_vertical ? step.tilt_deg : step.pan_deg);
    if (step.is_dark) {
      chart.shades.push_back({step.begin_s, step.end_s});
    }
  }
  chart.series.push_back(std::move(target));
  for (const bool is_whole : {true, false}) {
    for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
      chart.series.push_back(eye_series((is_whole ? whole : trial).command[eye], eye, is_whole, is_vertical));
    }
  }
  return responsive_chart(chart, kPictureHeightPx);
}

bool is_of_vertical_gaze(const ClinicFinding& finding) {
  return std::any_of(finding.any.begin(), finding.any.end(), [](const ClinicCondition& condition) {
    return condition.measure.ends_with(".up") || condition.measure.ends_with(".down");
  });
}

bool is_of_vergence(const ClinicFinding& finding) {
  return std::any_of(finding.any.begin(), finding.any.end(),
                     [](const ClinicCondition& condition) { return condition.measure.ends_with(".convergence"); });
}

/// The look at a near wall, from straight ahead.
std::string near_picture(const ClinicTrial& trial, const ClinicTrial& whole) {
  Chart chart;
  chart.description = "horizontal angle of both eyes over time before a near wall";
  chart.x.label = "time (s)";
  chart.y = {.label = "right (deg)", .min = -kReachDeg, .max = kReachDeg};
  for (const bool is_whole : {true, false}) {
    for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
      chart.series.push_back(eye_series((is_whole ? whole : trial).near[eye], eye, is_whole, false));
    }
  }
  return responsive_chart(chart, kPictureHeightPx);
}

void lesion_section(ReportPage& page, const ClinicLesion& lesion, const ClinicResult& result, const ClinicPlan& plan,
                    const ClinicReport& report) {
  page.heading(fmt::format("{}: {}", lesion.name, verdict_text(result.verdict)));
  page.paragraph(fmt::format("{} Expected: {} ({}). Taken out: {}.", lesion.about, lesion.sign, source_text(lesion),
                             removed_text(lesion, result)));
  ReportTable table;
  table.header = {"finding", "there?", "lesioned, whole, asked"};
  table.holds_text = true;
  for (const FindingResult& finding : result.findings) {
    std::string figures;
    for (const Observation& seen : finding.observed) {
      figures += (figures.empty() ? "" : "; or ") + observation_text(seen);
    }
    table.rows.push_back({finding.says, finding.is_there ? "yes" : "NO", figures});
  }
  page.table(table);
  const bool is_vertical = std::any_of(lesion.findings.begin(), lesion.findings.end(), is_of_vertical_gaze);
  page.figure("Horizontal gaze", is_vertical ? "" : "Broken lines: the same circuit whole. Dark: no dot to be seen.",
              picture(plan, result.trial, report.whole, false));
  if (is_vertical) {
    page.figure("Vertical gaze", "Broken lines: the same circuit whole.",
                picture(plan, result.trial, report.whole, true));
  }
  if (std::any_of(lesion.findings.begin(), lesion.findings.end(), is_of_vergence)) {
    page.figure("A near wall", "Both eyes turn inwards.", near_picture(result.trial, report.whole));
  }
}

ReportTable verdicts(const ClinicPlan& plan, const std::vector<ClinicReport>& reports) {
  ReportTable table;
  table.holds_text = true;
  table.header = {"lesion"};
  for (const ClinicReport& report : reports) {
    table.header.push_back(report.circuit);
  }
  table.header.emplace_back("expected sign");
  for (std::size_t k = 0; k < plan.lesions.size(); ++k) {
    std::vector<std::string>& row = table.rows.emplace_back();
    row.push_back(plan.lesions[k].name);
    for (const ClinicReport& report : reports) {
      row.push_back(verdict_text(report.results[k].verdict));
    }
    row.push_back(plan.lesions[k].sign);
  }
  return table;
}

}  // namespace

std::string clinic_html(const ClinicPlan& plan, const std::vector<ClinicReport>& reports) {
  ReportPage page;
  for (const ClinicReport& report : reports) {
    page.paragraph(report.circuit + ": " + tally_text(report) + ".");
  }
  page.table(verdicts(plan, reports));
  page.paragraph(
      "Eyes are where the motoneurons command them to be, at 500 Hz; the neck is held. A dot jumps between the middle "
      "and four places, twice; then it goes out while the eyes look to the right.");
  for (const ClinicReport& report : reports) {
    if (reports.size() > 1) {
      page.html(fmt::format("<h1>{}</h1>\n", xml_escape(report.circuit)));
    }
    for (std::size_t k = 0; k < plan.lesions.size(); ++k) {
      if (report.results[k].verdict != ClinicVerdict::NoStructure) {
        lesion_section(page, plan.lesions[k], report.results[k], plan, report);
      }
    }
  }
  return page.finish(reports.size() == 1 ? reports.front().circuit + ": the clinic" : "the clinic",
                     "lesions as disease makes them, and the signs that follow");
}

}  // namespace tectum
