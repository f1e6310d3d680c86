#include "tools/tectum/diff_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <future>

#include "tools/diff/diff_json.h"
#include "tools/diff/diff_report.h"
#include "tools/diff/subject.h"
#include "tools/evaluate/protocol.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

constexpr double kScenarioS = 10;

std::string text_of(const DiffArguments& arguments, const StructureDiff& structure, bool has_structure,
                    const Behaviour* behaviour) {
  std::string text;
  if (behaviour != nullptr) {
    text += verdict_text(structure, *behaviour) + "\n";
  }
  if (!arguments.behaviour_only && has_structure) {
    text += structure.is_same() ? "the same circuit\n" : structure_text(structure);
  }
  if (behaviour != nullptr) {
    text += (arguments.behaviour_only || !has_structure ? "" : "\n") + behaviour_text(*behaviour);
  }
  return text;
}

/// The protocol's first setting; nothing when it cannot be read, which it says.
std::optional<BatteryPlan> plan_of_protocol(const std::string& path, CommandContext& context) {
  const ReadProtocol read = read_protocol_file(path);
  context.err << read.problems << (read.error.empty() ? "" : "tectum: " + read.error + "\n");
  if (!read.protocol) {
    context.exit_status = kExitTrouble;
    return std::nullopt;
  }
  const Protocol& protocol = *read.protocol;
  const Setting setting = settings_of(protocol).front();
  BatteryPlan plan{"protocol " + protocol.name, false, {}, protocol.duration_s, protocol.first_seed};
  plan.head.scenario = protocol.scenario;
  if (setting.hold_s > 0) {
    plan.head.scenario.random_hold_s = setting.hold_s;
  }
  plan.head.camera_latency_frames = setting.camera_latency_frames;
  plan.head.geometry.wall_distance_m = protocol.wall_distance_m;
  plan.head.servo.moving_speed_deg_s = protocol.servo_speed_deg_s;
  plan.head.frame_period_ns = static_cast<TimeNs>(std::llround(1e9 / protocol.frame_rate_hz));
  return plan;
}

/// That makes the same page again.
std::string command_line(const DiffArguments& arguments) {
  std::string line = arguments.revisions.empty()
                         ? fmt::format("tectum diff {} {}", arguments.a, arguments.b)
                         : fmt::format("tectum diff --git {} {}", arguments.revisions, arguments.a);
  line += arguments.battery_path.empty() ? "" : " --battery " + arguments.battery_path;
  line += arguments.scenario.empty() ? "" : " --scenario " + arguments.scenario;
  line += arguments.duration_s > 0 ? fmt::format(" --duration {}", arguments.duration_s) : "";
  return line + fmt::format(" --seeds {} --report {}", arguments.seeds, arguments.report_path);
}

/// With one seed there is no spread, and every change counts.
bool is_within_spread(const Behaviour& behaviour) {
  return std::none_of(behaviour.kinematics.begin(), behaviour.kinematics.end(), [](const PairedFigure& figure) {
    return figure.exceeds_spread().value_or(figure.difference() != 0);
  });
}

bool is_same(const DiffArguments& arguments, const StructureDiff& structure, const Behaviour* behaviour) {
  if (arguments.tolerates_spread && behaviour != nullptr) {
    return behaviour->is_same || (behaviour->is_closed_loop && is_within_spread(*behaviour));
  }
  return (structure.is_same() || arguments.behaviour_only) && (behaviour == nullptr || behaviour->is_same);
}

bool write_page(const std::string& path, const std::string& page, CommandContext& context) {
  std::ofstream file(path, std::ios::binary);
  file << page << std::flush;
  context.err << (file ? fmt::format("report: {}\n", path) : fmt::format("tectum: {}: cannot be written\n", path));
  return static_cast<bool>(file);
}

}  // namespace

std::optional<BatteryPlan> diff_plan(const DiffArguments& arguments, CommandContext& context) {
  std::optional<BatteryPlan> plan = BatteryPlan{};
  if (!arguments.battery_path.empty()) {
    plan = plan_of_protocol(arguments.battery_path, context);
  } else if (!arguments.scenario.empty()) {
    plan = BatteryPlan{"scenario " + arguments.scenario, false, {}, kScenarioS, 1};
    plan->head.scenario.kind = scenario_from_name(arguments.scenario).value_or(ScenarioKind::Random);
  }
  if (plan && arguments.duration_s > 0) {
    plan->duration_s = arguments.duration_s;
  }
  return plan;
}

PairDiff diff_pair(const DiffArguments& arguments, const BatteryPlan& plan, const std::string& a_path,
                   const std::string& b_path, const std::function<std::string(std::string)>& named,
                   CommandContext& context) {
  const PairDiff trouble = {kExitTrouble, ""};  // 1 says that the two differ, which nobody knows yet
  auto first = std::async(std::launch::async, [&] { return load_subject(a_path); });
  DiffSubject b = load_subject(b_path);
  DiffSubject a = first.get();
  context.err << named(a.notice + a.error) << named(b.notice + b.error);
  if (!a.error.empty() || !b.error.empty()) {
    return trouble;
  }
  const StructureDiff structure = compare_structure(a, b);
  std::optional<Behaviour> behaviour;
  // Two circuits that are the same do the same: runs are deterministic.
  const bool is_recorded = a.recording || b.recording;
  if (!arguments.structure_only && (is_recorded || !structure.is_same())) {
    Progress progress(context.err, "running both circuits");
    behaviour = compare_subjects(
        a, b, structure,
        {.plan = plan, .seeds = arguments.seeds, .progress = [&](double done) { progress.update(done); }});
  }
  const Behaviour* found = behaviour ? &*behaviour : nullptr;
  if (!arguments.report_path.empty() &&
      !write_page(arguments.report_path,
                  named(diff_report_html(a, b, structure, found, {.command_line = command_line(arguments)})),
                  context)) {
    return trouble;
  }
  return {is_same(arguments, structure, found) ? kExitOk : kExitFailed,
          named(arguments.format == "json" ? diff_json(a.view, b.view, structure, found) + "\n"
                                           : text_of(arguments, structure, a.has_circuit && b.has_circuit, found))};
}

}  // namespace tectum
