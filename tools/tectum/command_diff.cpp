// tectum diff: what differs between two circuits, and what that does.
#include "tools/tectum/command_diff.h"

#include <fmt/format.h>

#include <future>
#include <memory>

#include "tools/diff/diff_json.h"
#include "tools/diff/subject.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct DiffArguments {
  std::string a, b;
  std::string format = "text";
  std::uint64_t seeds = 3;
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
  if (!arguments.behaviour_only && has_structure) {
    text += structure.is_same() ? "the same circuit\n" : structure_text(structure);
  }
  if (behaviour != nullptr) {
    text += (text.empty() ? "" : "\n") + behaviour_text(*behaviour);
  }
  return text;
}

void diff(const DiffArguments& arguments, CommandContext& context) {
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
    behaviour = compare_subjects(a, b, structure,
                                 {.seeds = arguments.seeds, .progress = [&](double done) { progress.update(done); }});
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
  CLI::Option* structure_only =
      command->add_flag("--structure-only", arguments->structure_only, "compare what is written, run nothing");
  command->add_flag("--behaviour-only", arguments->behaviour_only, "compare what the circuits do, whatever is written")
      ->excludes(structure_only);
  command->footer(
      "Two circuits are put through fixation, steps in eight directions and a pursuit ramp on the simulated head. A\n"
      "recording drives a circuit with the input that it holds. Two recordings are compared as they are.\n"
      "Spread is the larger standard deviation over the seeds; * and `beyond the spread`: every seed changes the same\n"
      "way, and the mean change is larger.\n\n"
      "Exit status: 0 when they are the same, 1 when they differ, 2 when one of them cannot be read or compiled.\n\n"
      "Examples:\n"
      "  tectum diff circuits/oculomotor.json mine.json\n"
      "  tectum diff circuits/oculomotor.json mine.json --seeds 20 --format json\n"
      "  tectum diff old.image new.image --structure-only   images know pathways, not which projection made a synapse\n"
      "  tectum diff out/run.trec mine.json                 would mine have done the same?\n");
  command->callback([arguments, &context] { diff(*arguments, context); });
}

}  // namespace tectum
