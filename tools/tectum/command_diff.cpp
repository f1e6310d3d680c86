// tectum diff: what differs between two circuits, and what that does.
#include "tools/tectum/command_diff.h"

#include <fmt/format.h>

#include <memory>

#include "tools/tectum/diff_git.h"
#include "tools/tectum/diff_pair.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

void diff(const DiffArguments& arguments, const std::vector<std::string>& from_git, CommandContext& context) {
  if (!from_git.empty()) {
    context.exit_status = diff_for_git(arguments, from_git, context);
    return;
  }
  const bool is_pair = !arguments.a.empty() && !arguments.b.empty();
  if (arguments.revisions.empty() ? !is_pair : is_pair) {
    context.err << (arguments.revisions.empty()
                        ? "tectum: diff compares two: tectum diff A B, or with git: tectum diff --git REV [FILE]\n"
                        : "tectum: --git compares one file with its own past: tectum diff --git REV [FILE]\n");
    context.exit_status = kExitUsage;
    return;
  }
  const std::optional<BatteryPlan> plan = diff_plan(arguments, context);
  if (!plan) {
    return;
  }
  if (!arguments.revisions.empty()) {
    context.exit_status = diff_revisions(arguments, *plan, context);
    return;
  }
  const PairDiff pair = diff_pair(
      arguments, *plan, arguments.a, arguments.b, [](std::string text) { return text; }, context);
  context.out << pair.text;
  context.exit_status = pair.exit_status;
}

}  // namespace

void add_diff_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("diff", "how two circuits differ, and what that does");
  auto arguments = std::make_shared<DiffArguments>();
  command->add_option("first", arguments->a, "circuit file, image or recording")->type_name("A");
  command->add_option("second", arguments->b, "circuit file, image or recording")->type_name("B");
  command
      ->add_option(
          "--git", arguments->revisions,
          "compare A, or every circuit file here that has changed, with what it was at a revision; A..B, A...B")
      ->type_name("REV");
  auto from_git = std::make_shared<std::vector<std::string>>();
  command
      ->add_option("--git-driver", *from_git,
                   "what git hands to a diff driver: the command to set as diff.tectum.command")
      ->type_name("PATH OLD HEX MODE NEW HEX MODE")
      ->expected(1, 9);
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
  command
      ->add_flag("--tolerate-spread", arguments->tolerates_spread,
                 "exit with 1 only when a measure of the eyes changes beyond its spread over the seeds")
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
      "  tectum diff out/run.trec mine.json                 would mine have done the same?\n"
      "  tectum diff --git HEAD                             what have my edits done to the circuits here?\n"
      "  tectum diff --git v1.0..main circuits/oculomotor.json\n"
      "  tectum diff --git origin/main...HEAD --tolerate-spread --report out/diff.html    for CI\n");
  command->callback([arguments, from_git, &context] { diff(*arguments, *from_git, context); });
}

}  // namespace tectum
