#include "tools/evaluate/evaluation_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

bool is_random(const Protocol& protocol) { return protocol.scenario.kind == ScenarioKind::Random; }
bool has_steps(const Protocol& protocol) { return is_random(protocol) || protocol.scenario.kind == ScenarioKind::Step; }

std::string head_text(const Protocol& protocol) {
  return fmt::format(
      "protocol {}: {} trial{} of {:g} s, seeds {} to {}, {:g} Hz, wall at {:g} m{}\n", protocol.name, protocol.trials,
      protocol.trials == 1 ? "" : "s", protocol.duration_s, protocol.first_seed,
      protocol.first_seed + static_cast<std::uint64_t>(protocol.trials) - 1, protocol.frame_rate_hz,
      protocol.wall_distance_m,
      protocol.servo_speed_deg_s > 0 ? fmt::format(", servos at {:.1f} deg/s", protocol.servo_speed_deg_s) : "");
}

/// A line of a table: a circuit, or what it is held against.
struct NamedResult {
  std::string name;
  const ControllerResult* result;
};

constexpr const char* kRecordedName = "recorded";

std::vector<NamedResult> lines_of(std::span<const CircuitEvaluation> circuits, std::size_t setting,
                                  const RecordedHead* recorded) {
  std::vector<NamedResult> lines;
  for (const CircuitEvaluation& circuit : circuits) {
    lines.push_back({circuits.size() == 1 ? kControllerNames[0] : circuit.circuit,
                     &circuit.evaluation.settings[setting].of(Controller::Circuit)});
  }
  for (std::size_t c = 1; c < kControllers; ++c) {
    lines.push_back({kControllerNames[c], &circuits.front().evaluation.settings[setting].controllers[c]});
  }
  if (recorded != nullptr) {
    lines.push_back({kRecordedName, &recorded->result});
  }
  return lines;
}

/// Blanks that make room for names longer than `usual`.
std::size_t name_width(std::span<const CircuitEvaluation> circuits, std::size_t usual) {
  std::size_t width = usual;
  for (const CircuitEvaluation& circuit : circuits) {
    width = std::max(width, circuits.size() == 1 ? 0 : circuit.circuit.size() + 1);
  }
  return width;
}

std::string controller_row(const std::string& name, std::size_t width, const ControllerResult& result,
                           double oracle_rmse_deg) {
  const ChannelSummary& all = result.all;
  return fmt::format(
      "  {:<{}}{:5.2f}{:6.2f}{:6.2f}{:6.2f}{:8.2f} ±{:4.2f}{:7.2f}{:8.2f}{:8.2f}{:8.2f}{:7.0f} %{:8.2f}\n", name, width,
      result.channels[0].rmse_deg, result.channels[1].rmse_deg, result.channels[2].rmse_deg,
      result.channels[3].rmse_deg, all.rmse_deg, all.rmse_sd_deg,
      oracle_rmse_deg > 0 ? all.rmse_deg / oracle_rmse_deg : 0.0, all.wall_rmse_deg, all.settled_rmse_deg,
      all.median_abs_deg, 100 * all.fovea_share, all.jitter_deg);
}

std::string steps_table(std::span<const CircuitEvaluation> circuits, const RecordedHead* recorded) {
  const std::size_t width = name_width(circuits, 26);
  const std::string blanks(width - 26, ' ');
  std::string text =
      "\nafter each jump (medians over trials)\n" + blanks +
      "                                  starts   overshoot       p90   within 2 deg       p90     settled\n" + blanks +
      "                                    (ms)         (%)       (%)           (ms)      (ms)\n";
  for (std::size_t i = 0; i < circuits.front().evaluation.settings.size(); ++i) {
    text += setting_text(circuits.front().evaluation.settings[i].setting) + '\n';
    for (const NamedResult& line : lines_of(circuits, i, recorded)) {
      const StepSummary& s = line.result->steps;
      text += fmt::format("  {:<{}}{:12.0f}{:12.1f}{:10.1f}{:15.0f}{:10.0f}{:6} of {}\n", line.name, width,
                          1000 * s.median_latency_s, 100 * s.median_overshoot_share, 100 * s.p90_overshoot_share,
                          1000 * s.median_settled_s, 1000 * s.p90_settled_s, s.settled, s.steps);
    }
  }
  return text;
}

std::string angle_text(const std::optional<double>& value_deg, const char* format) {
  return value_deg ? fmt::format(fmt::runtime(format), *value_deg) : std::string("-");
}

std::string published_table(const Protocol& protocol) {
  if (protocol.published.empty()) {
    return "";
  }
  std::string text = fmt::format("\npublished: {}\n", protocol.published_by);
  text += "                         median    RMSE   learned: median    RMSE   (deg)\n";
  for (const PublishedRow& row : protocol.published) {
    text += fmt::format("  {:<22}{:>7} {:>7} {:>17} {:>7}\n", row.what, angle_text(row.median_deg, "{:+.2f}"),
                        angle_text(row.rmse_deg, "{:.2f}"), angle_text(row.learned_median_deg, "{:+.2f}"),
                        angle_text(row.learned_rmse_deg, "{:.2f}"));
  }
  return text;
}

Json channel_json(const ChannelSummary& s) {
  return {{"median_deg", s.median_deg},
          {"median_abs_deg", s.median_abs_deg},
          {"rmse_deg", s.rmse_deg},
          {"rmse_sd_deg", s.rmse_sd_deg},
          {"settled_rmse_deg", s.settled_rmse_deg},
          {"p90_abs_deg", s.p90_abs_deg},
          {"fovea_share", s.fovea_share},
          {"jitter_deg", s.jitter_deg},
          {"wall_median_deg", s.wall_median_deg},
          {"wall_rmse_deg", s.wall_rmse_deg}};
}

Json steps_json(const StepSummary& s) {
  return {{"steps", s.steps},
          {"settled", s.settled},
          {"median_latency_s", s.median_latency_s},
          {"median_overshoot_share", s.median_overshoot_share},
          {"p90_overshoot_share", s.p90_overshoot_share},
          {"median_settled_s", s.median_settled_s},
          {"p90_settled_s", s.p90_settled_s}};
}

Json controller_json(const ControllerResult& result, double oracle_rmse_deg) {
  Json json;
  json["rmse_deg"] = result.all.rmse_deg;
  json["ratio_to_oracle"] = oracle_rmse_deg > 0 ? result.all.rmse_deg / oracle_rmse_deg : 0.0;
  json["all"] = channel_json(result.all);
  for (std::size_t c = 0; c < kChannels; ++c) {
    json["channels"][kChannelNames[c]] = channel_json(result.channels[c]);
  }
  json["steps"] = steps_json(result.steps);
  json["neck_travel_deg"] = result.neck_travel_deg;
  json["trial_rmse_deg"] = Json::array();
  for (const TrialResult& trial : result.trials) {
    Json row = Json::array();
    for (std::size_t c = 0; c < kChannels; ++c) {
      row.push_back(channel_of(trial.metrics, c).all.rmse_deg);
    }
    json["trial_rmse_deg"].push_back(std::move(row));
  }
  return json;
}

}  // namespace

std::string setting_text(const Setting& setting) {
  const std::string latency = fmt::format("{} frame{} of camera latency", setting.camera_latency_frames,
                                          setting.camera_latency_frames == 1 ? "" : "s");
  return setting.hold_s > 0 ? fmt::format("hold {:g} s, {}", setting.hold_s, latency) : latency;
}

std::string gains_text(const PidGains& gains) {
  return fmt::format("p {:g}, i {:g} Hz, d {:g} ms", gains.p, gains.i_hz, 1000 * gains.d_s);
}

std::string tracking_text(const Protocol& protocol, std::span<const CircuitEvaluation> circuits,
                          const RecordedHead* recorded) {
  std::string text = head_text(protocol);
  constexpr std::size_t kUsualWidth = 8;
  const std::size_t width = name_width(circuits, recorded != nullptr ? kUsualWidth + 1 : kUsualWidth);
  const std::string blanks(width - kUsualWidth, ' ');
  text += fmt::format(
      "\nRMSE (deg){0}  left        right         mean          over   RMSE    RMSE  median      on fovea  jitter\n"
      "{0}           horiz  vert horiz  vert      ± sd        oracle    wall settled |error|    (< 1 deg)   (deg)\n",
      blanks);
  for (std::size_t i = 0; i < circuits.front().evaluation.settings.size(); ++i) {
    const SettingResult& setting = circuits.front().evaluation.settings[i];
    text += fmt::format("{}   [pid: {}]\n", setting_text(setting.setting), gains_text(setting.pid));
    const double oracle_rmse_deg = setting.of(Controller::Oracle).all.rmse_deg;
    for (const NamedResult& line : lines_of(circuits, i, recorded)) {
      text += controller_row(line.name, width, *line.result, oracle_rmse_deg);
    }
  }
  text +=
      "mean: of the four channels; wall: by the paper's definition, angles on the wall; settled: without the 300 ms "
      "after each jump\n";
  if (has_steps(protocol)) {
    text += steps_table(circuits, recorded);
  }
  if (recorded != nullptr) {
    const Recording& run = recorded->result.first_trial;
    text += fmt::format("\nrecorded: {}, {} frames in {:.1f} s; its laser and its start are its own\n", recorded->path,
                        run.frames.size(), run.duration_s);
  }
  return text + published_table(protocol);
}

std::string tracking_json(const Protocol& protocol, const std::string& circuit, const TrackingEvaluation& evaluation,
                          const RecordedHead* recorded) {
  Json json;
  json["protocol"] = protocol.name;
  json["circuit"] = circuit;
  json["trials"] = protocol.trials;
  json["duration_s"] = protocol.duration_s;
  json["first_seed"] = protocol.first_seed;
  json["settings"] = Json::array();
  for (const SettingResult& setting : evaluation.settings) {
    Json row;
    row["hold_s"] = setting.setting.hold_s;
    row["camera_latency_frames"] = setting.setting.camera_latency_frames;
    row["pid"] = {{"p", setting.pid.p}, {"i_hz", setting.pid.i_hz}, {"d_s", setting.pid.d_s}};
    const double oracle_rmse_deg = setting.of(Controller::Oracle).all.rmse_deg;
    for (std::size_t c = 0; c < kControllers; ++c) {
      row[kControllerNames[c]] = controller_json(setting.controllers[c], oracle_rmse_deg);
    }
    if (recorded != nullptr) {
      row[kRecordedName] = controller_json(recorded->result, oracle_rmse_deg);
      row[kRecordedName].erase("neck_travel_deg");  // the file does not tell where the neck was
      row[kRecordedName]["file"] = recorded->path;
    }
    json["settings"].push_back(std::move(row));
  }
  json["published"] = Json::array();
  for (const PublishedRow& row : protocol.published) {
    Json published{{"what", row.what}};
    for (const auto& [key, value] : {std::pair{"median_deg", row.median_deg},
                                     {"rmse_deg", row.rmse_deg},
                                     {"learned_median_deg", row.learned_median_deg},
                                     {"learned_rmse_deg", row.learned_rmse_deg}}) {
      if (value) {
        published[key] = *value;
      }
    }
    json["published"].push_back(std::move(published));
  }
  return json.dump(2);
}

std::string tuning_text(const Protocol& protocol, const std::vector<PidTuningResult>& results) {
  const PidTuning& tuning = protocol.tuning;
  std::string text =
      fmt::format("PID servo for protocol {}, tuned on seeds {} to {}, {:g} s each\n", protocol.name, tuning.first_seed,
                  tuning.first_seed + static_cast<std::uint64_t>(tuning.trials) - 1, tuning.duration_s);
  for (const PidTuningResult& result : results) {
    const PidGains& gains = result.tuned.gains;
    text += fmt::format(
        "    {{ \"camera_latency\": {}, \"p\": {:g}, \"i\": \"{:g} Hz\", \"d\": \"{:g} ms\" }}   RMSE {:.3f} deg, "
        "{:.3f} "
        "of the oracle's, best of {}\n",
        result.tuned.camera_latency_frames, gains.p, gains.i_hz, 1000 * gains.d_s, result.rmse_deg,
        result.rmse_deg / result.oracle_rmse_deg, result.tried);
  }
  return text;
}

}  // namespace tectum
