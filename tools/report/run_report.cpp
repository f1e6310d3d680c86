#include "tools/report/run_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/analysis/gaze_traces.h"
#include "tools/analysis/run_summary.h"
#include "tools/report/lane_plot.h"
#include "tools/report/report_page.h"
#include "tools/report/run_figures.h"

namespace tectum {
namespace {

constexpr double kGridHeightPx = 300;

struct Run {
  const Recording& recording;
  RunSummary summary;
  LaneWindow whole;
  LaneWindow zoom;
  [[nodiscard]] const std::vector<double>& jumps_s() const { return summary.tracking.target_jumps_s; }
};

std::string degrees_text(double value_deg) { return number_text(value_deg, 2) + "°"; }

std::string subtitle(const Run& run, const RunReportOptions& options) {
  const Recording& recording = run.recording;
  std::string text = fmt::format("scenario {}, seed {}, {} s", recording.scenario, recording.seed,
                                 number_text(run.summary.duration_s, 1));
  if (recording.frame_period_ns > 0) {
    text += fmt::format(", {} frames/s", number_text(1e9 / static_cast<double>(recording.frame_period_ns), 1));
  }
  text += fmt::format(", tick {} ms, {} neurons in {} populations",
                      number_text(static_cast<double>(recording.tick_ns) * 1e-6, 2), count_text(run.summary.neurons),
                      recording.populations.size());
  if (options.times_real_time) {
    text += fmt::format(", {} × real time", number_text(*options.times_real_time, 1));
  }
  return text;
}

void add_cards(ReportPage& page, const Run& run, const RunReportOptions& options) {
  std::vector<ReportCard> cards;
  const RunSummary& summary = run.summary;
  if (summary.tracking.has_truth) {
    double worst_deg = 0;
    double share = 1;
    for (const EyeMetrics& eye : summary.tracking.eye) {
      worst_deg = std::max({worst_deg, eye.pan.all.rmse_deg, eye.tilt.all.rmse_deg});
      share = std::min(share, eye.angle.fovea_share);
    }
    cards.push_back({degrees_text(worst_deg), "largest RMSE of any eye and axis"});
    cards.push_back({number_text(share * 100, 0) + " %", "of the time within 1° of the target, the worse eye"});
  }
  const std::size_t saccades = std::max(summary.saccades[0].saccades.size(), summary.saccades[1].saccades.size());
  cards.push_back({count_text(saccades), "saccades"});
  if (!summary.saccades[0].latencies_s.empty()) {
    cards.push_back(
        {number_text(summary.saccades[0].median_latency_s * 1e3, 0) + " ms", "median latency, jump to saccade"});
  }
  cards.push_back(
      {count_text(summary.spikes), fmt::format("spikes, {} Hz a neuron", number_text(summary.mean_rate_hz, 1))});
  cards.push_back({number_text(summary.tracking.neck_pan_travel_deg + summary.tracking.neck_tilt_travel_deg, 0) + "°",
                   "neck travel, both axes"});
  if (options.times_real_time) {
    cards.push_back({number_text(*options.times_real_time, 0) + " ×", "real time"});
  }
  page.cards(cards);
}

void add_metrics_table(ReportPage& page, const TrackingMetrics& tracking) {
  ReportTable table;
  table.header = {"error", "left H", "left V", "right H", "right V"};
  const auto row = [&](const std::string& name, const std::string& note, auto value) {
    table.rows.push_back({name, value(tracking.eye[0].pan), value(tracking.eye[0].tilt), value(tracking.eye[1].pan),
                          value(tracking.eye[1].tilt)});
    table.notes.push_back(note);
  };
  row("median", "signed; + is target right of or above the gaze",
      [](const AxisMetrics& m) { return degrees_text(m.all.median_deg); });
  row("median of size", "", [](const AxisMetrics& m) { return degrees_text(m.all.median_abs_deg); });
  row("RMSE", "", [](const AxisMetrics& m) { return degrees_text(m.all.rmse_deg); });
  row("90th percentile", "of size", [](const AxisMetrics& m) { return degrees_text(m.all.p90_abs_deg); });
  row("on the fovea", "less than 1°",
      [](const AxisMetrics& m) { return number_text(m.all.fovea_share * 100, 0) + " %"; });
  if (!tracking.target_jumps_s.empty()) {
    row("RMSE, settled", "without the 300 ms after each jump",
        [](const AxisMetrics& m) { return degrees_text(m.settled.rmse_deg); });
    row("on the fovea, settled", "",
        [](const AxisMetrics& m) { return number_text(m.settled.fovea_share * 100, 0) + " %"; });
    row("jitter", "peak to peak while the target rests",
        [](const AxisMetrics& m) { return degrees_text(m.jitter_deg); });
  }
  page.table(table);
}

std::string gaze_caption(const Run& run) {
  std::string caption = "Directions in the head's fixed frame. ";
  caption += run.summary.tracking.has_truth
                 ? "The eyes sit apart, so the target lies in a different direction for each. "
                 : "Gaze is the sum of the measured eye and neck angles. ";
  return caption + "The shaded part is enlarged below.";
}

void add_gaze(ReportPage& page, const Run& run) {
  page.heading(run.summary.tracking.has_truth ? "Target, eyes and neck" : "Eyes and neck");
  const std::vector<double> none;
  for (const GazeAxis axis : {GazeAxis::Horizontal, GazeAxis::Vertical}) {
    const std::string name = axis == GazeAxis::Horizontal ? "Horizontal" : "Vertical";
    Chart whole = gaze_chart(run.recording, axis, run.whole, none);
    whole.shades.push_back({run.zoom.begin_s, run.zoom.end_s});
    page.figure(name + ", whole run", axis == GazeAxis::Horizontal ? gaze_caption(run) : "",
                responsive_chart(whole, 250));
    page.figure(fmt::format("{}, {} s", name, number_text(run.zoom.end_s - run.zoom.begin_s, 0)),
                run.jumps_s().empty() ? "" : "Thin vertical lines: the target jumps.",
                responsive_chart(gaze_chart(run.recording, axis, run.zoom, run.jumps_s()), 250));
  }
}

void add_errors(ReportPage& page, const Run& run) {
  page.heading("Error");
  page.paragraph("Target minus optical axis in each eye's own frame.");
  for (const GazeAxis axis : {GazeAxis::Horizontal, GazeAxis::Vertical}) {
    page.figure(axis == GazeAxis::Horizontal ? "Horizontal" : "Vertical", "",
                responsive_chart(error_chart(run.recording, axis, run.whole, {}), 190));
  }
  page.begin_grid();
  page.figure("How often, horizontal", "",
              chart_svg(error_histogram(run.recording, GazeAxis::Horizontal), kNarrowPx, kGridHeightPx, "both"));
  page.figure("How often, vertical", "",
              chart_svg(error_histogram(run.recording, GazeAxis::Vertical), kNarrowPx, kGridHeightPx, "both"));
  page.figure("Path on the wall", "",
              chart_svg(wall_chart(run.recording, run.whole), kNarrowPx, kGridHeightPx, "both"));
  page.end_grid();
}

void add_seen(ReportPage& page, const Run& run) {
  page.heading("What the eyes saw");
  page.paragraph(
      "Mean direction of the active receptive fields' centres, in each eye's own frame; a gap where no field was "
      "active.");
  for (const GazeAxis axis : {GazeAxis::Horizontal, GazeAxis::Vertical}) {
    page.figure(axis == GazeAxis::Horizontal ? "Horizontal" : "Vertical", "",
                responsive_chart(seen_chart(run.recording, axis, run.whole), 220));
  }
}

void add_saccades(ReportPage& page, const Run& run) {
  page.heading("Saccades");
  page.paragraph(
      "Found by velocity (Engbert and Kliegl 2003) in the gaze, sampled once a frame: amplitudes and counts hold, peak "
      "velocities of movements that last a frame or two are lower bounds.");
  page.begin_grid();
  page.figure("Main sequence", "", chart_svg(main_sequence_chart(run.summary), kNarrowPx, kGridHeightPx, "both"));
  if (!run.summary.saccades[0].latencies_s.empty() || !run.summary.saccades[1].latencies_s.empty()) {
    page.figure("Latency", "", chart_svg(latency_histogram(run.summary), kNarrowPx, kGridHeightPx, "both"));
  }
  page.end_grid();
}

void add_servos(ReportPage& page, const Run& run) {
  page.heading("Servos");
  page.paragraph("What each servo was told and what it measured, over the enlarged seconds.");
  page.begin_grid();
  for (std::uint32_t j = 0; j < kJointCount; ++j) {
    const auto joint = static_cast<Joint>(j);
    page.figure(joint_title(joint), "", chart_svg(servo_chart(run.recording, joint, run.zoom), kNarrowPx, 190, "both"));
  }
  page.end_grid();
  page.begin_details("Servos, whole run");
  for (std::uint32_t j = 0; j < kJointCount; ++j) {
    const auto joint = static_cast<Joint>(j);
    page.figure(joint_title(joint), "", responsive_chart(servo_chart(run.recording, joint, run.whole), 170));
  }
  page.end_details();
}

void add_spikes(ReportPage& page, const Run& run) {
  if (run.recording.populations.empty()) {
    return;
  }
  page.heading("Spikes");
  const std::vector<PopulationSummary>& summaries = run.summary.populations;
  page.figure("Rates over the enlarged seconds",
              "Bins of 20 ms; each lane has its own scale, whose top is at the side.",
              RatePlot(run.recording, summaries, {.window = run.zoom, .marks_s = run.jumps_s(), .shades = {}})
                  .responsive("firing rates by population"));
  page.figure("Raster over the enlarged seconds",
              "One row a neuron; the more spikes on one spot, the darker. Mean rates of these seconds at the side.",
              RasterPlot(run.recording, summaries, {.window = run.zoom, .marks_s = run.jumps_s(), .shades = {}})
                  .responsive("spike raster of the enlarged seconds"));
  page.figure("Raster, whole run", "Mean rates of the whole run at the side.",
              RasterPlot(run.recording, summaries,
                         {.window = run.whole, .max_lane_px = 40, .marks_s = {}, .shades = {run.zoom}})
                  .responsive("spike raster"));
}

}  // namespace

std::string run_report_html(const Recording& recording, const RunReportOptions& options) {
  const TimeRange range = time_range(recording);
  Run run{recording, summarize_run(recording), {range.begin_s, range.end_s}, {}};
  run.zoom = zoom_window(recording, run.jumps_s(), options.zoom_length_s, options.zoom_begin_s);
  ReportPage page;
  if (!options.command_line.empty()) {
    page.html(fmt::format("<p><code>{}</code></p>\n", xml_escape(options.command_line)));
  }
  for (const std::string& note : options.notes) {
    page.paragraph(note);
  }
  add_cards(page, run, options);
  if (run.summary.tracking.has_truth) {
    add_metrics_table(page, run.summary.tracking);
  }
  if (recording.frames.empty()) {
    page.paragraph("The recording holds no frames.");
  } else {
    if (!run.summary.tracking.has_truth) {
      add_seen(page, run);
    }
    add_gaze(page, run);
    if (run.summary.tracking.has_truth) {
      add_errors(page, run);
    }
    add_saccades(page, run);
    add_servos(page, run);
  }
  add_spikes(page, run);
  const std::string title = recording.circuit_name.empty() ? "Run" : recording.circuit_name;
  return page.finish(title + ": run report", subtitle(run, options));
}

}  // namespace tectum
