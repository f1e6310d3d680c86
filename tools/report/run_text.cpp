#include "tools/report/run_text.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, kEyeCount> kEyeNames = {"left", "right"};

/// A value that rounds to zero has no sign to show.
double without_negative_zero(double value) { return std::abs(value) < 0.005 ? 0 : value; }

std::string axis_row(const char* eye, const char* axis, const AxisMetrics& metrics) {
  return fmt::format("{:<5}  {:<10}  {:>+7.2f}  {:>8.2f}  {:>6.2f}  {:>6.2f}  {:>7.0f} %  {:>12.2f}  {:>6.2f}\n", eye,
                     axis, without_negative_zero(metrics.all.median_deg), metrics.all.median_abs_deg,
                     metrics.all.rmse_deg, metrics.all.p90_abs_deg, metrics.all.fovea_share * 100,
                     metrics.settled.rmse_deg, metrics.jitter_deg);
}

Json stats_json(const ErrorStats& stats) {
  return {{"frames", stats.frames},     {"median_deg", stats.median_deg},   {"median_abs_deg", stats.median_abs_deg},
          {"rmse_deg", stats.rmse_deg}, {"p90_abs_deg", stats.p90_abs_deg}, {"fovea_share", stats.fovea_share}};
}

Json axis_json(const AxisMetrics& metrics) {
  return {{"all", stats_json(metrics.all)},
          {"settled", stats_json(metrics.settled)},
          {"wall", stats_json(metrics.wall)},
          {"jitter_deg", metrics.jitter_deg}};
}

Json saccades_json(const EyeSaccades& eye) {
  Json list = Json::array();
  for (const Saccade& saccade : eye.saccades) {
    list.push_back({{"onset_s", saccade.onset_s},
                    {"duration_s", saccade.duration_s},
                    {"amplitude_deg", saccade.amplitude_deg},
                    {"peak_velocity_deg_s", saccade.peak_velocity_deg_s}});
  }
  return {{"count", eye.saccades.size()},
          {"median_amplitude_deg", eye.median_amplitude_deg},
          {"median_peak_velocity_deg_s", eye.median_peak_velocity_deg_s},
          {"median_duration_s", eye.median_duration_s},
          {"median_latency_s", eye.median_latency_s},
          {"saccades", list}};
}

}  // namespace

std::string run_table_text(const RunSummary& summary) {
  std::string text;
  if (summary.tracking.has_truth) {
    constexpr const char* kHeader = "{:<5}  {:<10}  {:>7}  {:>8}  {:>6}  {:>6}  {:>9}  {:>12}  {:>6}\n";
    text +=
        fmt::format(kHeader, "eye", "axis", "median", "|error|", "RMSE", "p90", "on fovea", "RMSE settled", "jitter");
    text += fmt::format(kHeader, "", "", "(deg)", "(deg)", "(deg)", "(deg)", "(< 1 deg)", "(deg)", "(deg)");
    for (std::size_t e = 0; e < kEyeCount; ++e) {
      text += axis_row(kEyeNames[e], "horizontal", summary.tracking.eye[e].pan);
      text += axis_row(kEyeNames[e], "vertical", summary.tracking.eye[e].tilt);
    }
    text += "|error|: median of its size; settled: without the 300 ms after each of ";
    text += fmt::format("{} target jumps\n\n", summary.tracking.target_jumps_s.size());
  }
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    const EyeSaccades& eye = summary.saccades[e];
    text += fmt::format("saccades, {:<6} {:>5}", std::string(kEyeNames[e]) + ":", eye.saccades.size());
    if (!eye.saccades.empty()) {
      text +=
          fmt::format("   median {:.1f} deg, {:.0f} deg/s", eye.median_amplitude_deg, eye.median_peak_velocity_deg_s);
    }
    if (!eye.latencies_s.empty()) {
      text += fmt::format(", {:.0f} ms after the jump", eye.median_latency_s * 1e3);
    }
    text += '\n';
  }
  text += fmt::format("spikes: {} of {} neurons in {:.1f} s ({:.1f} Hz each)\n", summary.spikes, summary.neurons,
                      summary.duration_s, summary.mean_rate_hz);
  text += fmt::format("neck travel: {:.0f} deg horizontal, {:.0f} deg vertical\n", summary.tracking.neck_pan_travel_deg,
                      summary.tracking.neck_tilt_travel_deg);
  return text;
}

std::string run_summary_json(const Recording& recording, const RunSummary& summary) {
  Json json = {{"circuit", recording.circuit_name},
               {"scenario", recording.scenario},
               {"seed", recording.seed},
               {"duration_s", summary.duration_s},
               {"neurons", summary.neurons},
               {"spikes", summary.spikes},
               {"mean_rate_hz", summary.mean_rate_hz},
               {"neck_pan_travel_deg", summary.tracking.neck_pan_travel_deg},
               {"neck_tilt_travel_deg", summary.tracking.neck_tilt_travel_deg}};
  if (summary.tracking.has_truth) {
    json["target_jumps_s"] = summary.tracking.target_jumps_s;
  }
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    Json eye;
    if (summary.tracking.has_truth) {
      eye["horizontal"] = axis_json(summary.tracking.eye[e].pan);
      eye["vertical"] = axis_json(summary.tracking.eye[e].tilt);
      eye["angle"] = stats_json(summary.tracking.eye[e].angle);
      eye["angle_settled"] = stats_json(summary.tracking.eye[e].angle_settled);
    }
    eye["saccades"] = saccades_json(summary.saccades[e]);
    json["eyes"][kEyeNames[e]] = eye;
  }
  Json populations = Json::array();
  for (std::size_t p = 0; p < recording.populations.size(); ++p) {
    const PopulationSummary& population = summary.populations[p];
    populations.push_back({{"name", recording.populations[p].name},
                           {"nucleus", recording.populations[p].nucleus},
                           {"neurons", recording.populations[p].size},
                           {"spikes", population.spikes},
                           {"mean_rate_hz", population.mean_rate_hz},
                           {"peak_rate_hz", population.peak_rate_hz},
                           {"active_share", population.active_share}});
  }
  json["populations"] = populations;
  // Names come from files; invalid UTF-8 is replaced rather than thrown about.
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace tectum
