// tectum diff: what differs between two circuits, and what that does.
#include "tools/tectum/command_diff.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <future>
#include <memory>

#include "tools/diff/diff_json.h"
#include "tools/diff/diff_report.h"
#include "tools/diff/subject.h"
#include "tools/evaluate/protocol.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

constexpr double kScenarioS = 10;

struct DiffArguments {
  std::string a, b;
  std::string format = "text";
  std::string scenario, battery_path, report_path;
  double duration_s = 0;
  std::uint64_t seeds = 4;
  bool structure_only = false;
  bool behaviour_only = false;
};

bool is_loaded(const DiffSubject& subject, CommandContext& context) {
  context.err << subject.notice << subject.error;
  if (!subject.error.empty()) {
    context.exit_status = kExitTrouble;  // 1 says that the two differ, which nobody knows yet
  }
  return subject.error.empty();
}

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

std::optional<BatteryPlan> plan_of(const DiffArguments& arguments, CommandContext& context) {
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

/// That makes the same page again.
std::string command_line(const DiffArguments& arguments) {
  std::string line = fmt::format("tectum diff {} {}", arguments.a, arguments.b);
  line += arguments.battery_path.empty() ? "" : " --battery " + arguments.battery_path;
  line += arguments.scenario.empty() ? "" : " --scenario " + arguments.scenario;
  line += arguments.duration_s > 0 ? fmt::format(" --duration {}", arguments.duration_s) : "";
  return line + fmt::format(" --seeds {} --report {}", arguments.seeds, arguments.report_path);
}

void diff(const DiffArguments& arguments, CommandContext& context) {
  const std::optional<BatteryPlan> plan = plan_of(arguments, context);
  if (!plan) {
    return;
  }
  auto first = std::async(std::launch::async, [&] { return load_subject(arguments.a); });
  DiffSubject b = load_subject(arguments.b);
  DiffSubject a = first.get();
  const bool has_a = is_loaded(a, context);
  if (!is_loaded(b, context) || !has_a) {
    return;
  }
  const StructureDiff structure = compare_structure(a, b);
  std::optional<Behaviour> behaviour;
  // Two circuits that are the same do the same: runs are deterministic.
  const bool is_recorded = a.recording || b.recording;
  if (!arguments.structure_only && (is_recorded || !structure.is_same())) {
    Progress progress(context.err, "running both circuits");
    behaviour = compare_subjects(
        a, b, structure,
        {.plan = *plan, .seeds = arguments.seeds, .progress = [&](double done) { progress.update(done); }});
  }
  if (!arguments.report_path.empty()) {
    const std::string page =
        diff_report_html(a, b, structure, behaviour ? &*behaviour : nullptr, {.command_line = command_line(arguments)});
    std::ofstream file(arguments.report_path, std::ios::binary);
    file << page << std::flush;
    if (!file) {
      context.err << fmt::format("tectum: {}: cannot be written\n", arguments.report_path);
      context.exit_status = kExitTrouble;
      return;
    }
    context.err << fmt::format("report: {}\n", arguments.report_path);
  }
  const bool is_same_structure = structure.is_same() || arguments.behaviour_only;
  const bool is_same = is_same_structure && (!behaviour || behaviour->is_same);
  context.exit_status = is_same ? kExitOk : kExitFailed;
  const Behaviour* found = behaviour ? &*behaviour : nullptr;
  if (arguments.format == "json") {
    context.out << diff_json(a.view, b.view, structure, found) << '\n';
  } else {
    context.out << text_of(arguments, structure, a.has_circuit && b.has_circuit, found);
  }
}

}  // namespace

void add_diff_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("diff", "how two circuits differ, and what that does");
  auto arguments = std::make_shared<DiffArguments>();
  command->add_option("first", arguments->a, "circuit file, image or recording")->required()->type_name("A");
  command->add_option("second", arguments->b, "circuit file, image or recording")->required()->type_name("B");
  command->add_option("--format", arguments->format, "what to print: text for people, json for programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->add_option("--seeds", arguments->seeds, "repetitions of the battery, each with its own noise for both")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  CLI::Option* battery =
      command->add_option("--battery", arguments->battery_path, "run a protocol (circuits/protocols) instead")
          ->type_name("FILE");

  command->add_option("--scenario", arguments->scenario, "run a target instead: hold, step, circle, chirp or random")
      ->check(CLI::IsMember(std::vector<std::string>(kScenarioNames.begin(), kScenarioNames.end())))
      ->excludes(battery)
      ->type_name("NAME");
  command->add_option("--duration", arguments->duration_s, "seconds of --scenario [10] or --battery [its own]")
      ->check(CLI::Range(0.1, 1e5))
      ->type_name("S");
  command->add_option("--report", arguments->report_path, "write a self-contained HTML page as well")
      ->type_name("FILE");
  CLI::Option* structure_only =
      command->add_flag("--structure-only", arguments->structure_only, "compare what is written, run nothing");
  command->add_flag("--behaviour-only", arguments->behaviour_only, "compare what the circuits do, whatever is written")
      ->excludes(structure_only);
  command->footer(
      "Two circuits are put through fixation, steps in eight directions and a pursuit ramp on the simulated head, "
      "both\n"
      "with the same targets and the same noise, seed by seed. A recording drives a circuit with the input that it\n"
      "holds. Two recordings are compared as they are.\n"
      "Spread is the standard deviation of the change over the seeds; * and `beyond the spread`: every seed changes "
      "the\n"
      "same way, and the mean change is larger than that. `later ms` is how much later a population answers a step.\n"
      "Distances are means over neurons of the first seed: van Rossum (10 ms), Victor-Purpura (0.1 a ms), SPIKE.\n\n"
      "Exit status, as of diff: 0 when they are the same, 1 when they differ, 2 when one of them cannot be read or\n"
      "compiled. A population that was only renamed is a difference (1), and with --behaviour-only none (0).\n\n"
      "Examples:\n"
      "  tectum diff circuits/oculomotor.json mine.json\n"
      "  tectum diff circuits/oculomotor.json mine.json --seeds 20 --format json\n"
      "  tectum diff circuits/oculomotor.json mine.json --scenario random --duration 60\n"
      "  tectum diff circuits/oculomotor.json mine.json --battery circuits/protocols/circle.json\n"
      "  tectum diff circuits/oculomotor.json mine.json --report diff.html\n"
      "  tectum diff old.image new.image --structure-only   images know pathways, not which projection made a synapse\n"
      "  tectum diff out/run.trec mine.json                 would mine have done the same?\n");
  command->callback([arguments, &context] { diff(*arguments, context); });
}

}  // namespace tectum
