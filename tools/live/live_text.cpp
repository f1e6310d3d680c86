#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/live/live_run.h"

namespace tectum {
namespace {

using Json = nlohmann::ordered_json;

Json latency_json(const LatencyHistogram& histogram) {
  const auto ms = [](TimeNs time_ns) { return static_cast<double>(time_ns) / 1e6; };
  return {{"median", ms(histogram.quantile_ns(0.5))},
          {"p99", ms(histogram.quantile_ns(0.99))},
          {"p99_9", ms(histogram.quantile_ns(0.999))},
          {"most", ms(histogram.longest_ns())}};
}

std::string latency_row(const char* what, const LatencyHistogram& histogram) {
  const auto ms = [](TimeNs time_ns) { return static_cast<double>(time_ns) * 1e-6; };
  return fmt::format("{:<34} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f}\n", what, ms(histogram.quantile_ns(0.5)),
                     ms(histogram.quantile_ns(0.99)), ms(histogram.quantile_ns(0.999)), ms(histogram.longest_ns()));
}

}  // namespace

std::string live_figures_text(const LiveRun& run) {
  const LiveFigures& f = run.figures;
  std::string text =
      fmt::format("{:<34} {:>8} {:>8} {:>8} {:>8}\n", "latency (ms)", "median", "99 %", "99.9 %", "most");
  text += latency_row("frames taken to command handed over", f.frame_to_command);
  text += latency_row("frames taken to last command byte", f.frame_to_last_byte);
  text += latency_row("exposure to frames taken", f.exposure_to_turn);
  text += latency_row("turn behind its schedule", f.lateness);
  text += latency_row("left exposure to right", f.eye_skew);
  constexpr std::array<const char*, 5> kStages = {"  read", "  encode", "  step", "  decode, guard", "  hand over"};
  for (std::size_t stage = 0; stage < kStages.size(); ++stage) {
    text += latency_row(kStages[stage], f.stages[stage]);
  }
  text += fmt::format("\nmissed deadlines: {} of {} periods ({} commands late, {} periods skipped)\n",
                      f.missed_deadlines, f.loop.turns + f.loop.skipped_periods,
                      f.missed_deadlines - f.loop.skipped_periods, f.loop.skipped_periods);
  constexpr double kWorthSaying = 0.005;
  if (f.stolen_share > kWorthSaying) {
    text += fmt::format(
        "host: kept {:.0f} % of this virtual machine's processors for itself; nobody in it can be in time\n",
        100 * f.stolen_share);
  }
  text += fmt::format("frames: left {}, right {}; refused {}; commands {} ({} not taken)\n", f.loop.frames[0],
                      f.loop.frames[1], f.loop.refused_frames[0] + f.loop.refused_frames[1], f.head.commands,
                      f.loop.failed_writes);
  text += fmt::format("guard: {} limited, {} slewed, {} not finite, {} clock jumps, {} holds, {} servos lost\n",
                      f.guard.limited, f.guard.slewed, f.guard.not_finite, f.guard.clock_jumps, f.guard.holds,
                      f.guard.losses);
  text += fmt::format(
      "bus: {} questions, {} retries, {} given up for a command, {} failures, {} positions, {} not confirmed, {} "
      "reconnections\n",
      f.head.wire.requests, f.head.wire.retries, f.head.wire.given_way, f.head.wire.failures, f.head.positions,
      f.head.unconfirmed, f.head.reconnections);
  if (f.lost_frames > 0 || f.lost_spikes > 0) {
    text += fmt::format("recorder: {} turns and {} spikes lost; the recording cannot be replayed\n", f.lost_frames,
                        f.lost_spikes);
  }
  return text;
}

std::string live_figures_json(const LiveRun& run) {
  const LiveFigures& f = run.figures;
  Json json;
  Json& latency = json["latency_ms"];
  latency["frames_to_command"] = latency_json(f.frame_to_command);
  latency["frames_to_last_byte"] = latency_json(f.frame_to_last_byte);
  latency["exposure_to_turn"] = latency_json(f.exposure_to_turn);
  latency["behind_schedule"] = latency_json(f.lateness);
  latency["eye_skew"] = latency_json(f.eye_skew);
  constexpr std::array<const char*, 5> kStages = {"read", "encode", "step", "decode", "write"};
  for (std::size_t stage = 0; stage < kStages.size(); ++stage) {
    latency["stages"][kStages[stage]] = latency_json(f.stages[stage]);
  }
  json["deadlines"] = {{"periods", f.loop.turns + f.loop.skipped_periods},
                       {"missed", f.missed_deadlines},
                       {"late_commands", f.missed_deadlines - f.loop.skipped_periods},
                       {"skipped_periods", f.loop.skipped_periods}};
  json["stolen_share"] = f.stolen_share;
  json["bus"] = {{"commands", f.head.commands},
                 {"commands_not_taken", f.loop.failed_writes},
                 {"questions", f.head.wire.requests},
                 {"retries", f.head.wire.retries},
                 {"given_way", f.head.wire.given_way},
                 {"failures", f.head.wire.failures},
                 {"time_outs", f.head.wire.time_outs},
                 {"broken_off", f.head.wire.broken_off},
                 {"bad_checksums", f.head.wire.bad_checksums},
                 {"positions", f.head.positions},
                 {"not_confirmed", f.head.unconfirmed},
                 {"reconnections", f.head.reconnections}};
  json["frames"] = {{"left", f.loop.frames[0]},
                    {"right", f.loop.frames[1]},
                    {"refused", f.loop.refused_frames[0] + f.loop.refused_frames[1]}};
  json["guard"] = {{"limited", f.guard.limited},         {"slewed", f.guard.slewed}, {"not_finite", f.guard.not_finite},
                   {"clock_jumps", f.guard.clock_jumps}, {"holds", f.guard.holds},   {"servos_lost", f.guard.losses}};
  json["recorder"] = {{"lost_turns", f.lost_frames}, {"lost_spikes", f.lost_spikes}};
  return json.dump();
}

}  // namespace tectum
