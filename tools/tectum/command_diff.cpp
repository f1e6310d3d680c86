// tectum diff: what differs between two circuits, and what that does.
#include "tools/tectum/command_diff.h"

#include <fmt/format.h>

#include <future>
#include <memory>

#include "tools/diff/diff_json.h"
#include "tools/diff/load_view.h"
#include "tools/diff/structure_diff.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct DiffArguments {
  std::string a, b;
  std::string format = "text";
};

bool is_loaded(const LoadedView& loaded, CommandContext& context) {
  if (!loaded.error.empty()) {
    context.err << loaded.error;
    context.exit_status = kExitTrouble;  // 1 says that the two differ, which nobody knows yet
  }
  return loaded.error.empty();
}

void diff(const DiffArguments& arguments, CommandContext& context) {
  auto first = std::async(std::launch::async, [&] { return load_view(arguments.a); });
  LoadedView b = load_view(arguments.b);
  LoadedView a = first.get();
  const bool has_a = is_loaded(a, context);
  if (!is_loaded(b, context) || !has_a) {
    return;
  }
  if (a.view.has_projections != b.view.has_projections) {
    forget_projections(a.view);
    forget_projections(b.view);
  }
  const StructureDiff structure = diff_structure(a.view, b.view);
  context.exit_status = structure.is_same() ? kExitOk : kExitFailed;
  if (arguments.format == "json") {
    context.out << diff_json(a.view, b.view, structure) << '\n';
    return;
  }
  context.out << (structure.is_same() ? "the same circuit\n" : structure_text(structure));
}

}  // namespace

void add_diff_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("diff", "how two circuits differ");
  auto arguments = std::make_shared<DiffArguments>();
  command->add_option("first", arguments->a, "circuit file or image")->required()->type_name("A");
  command->add_option("second", arguments->b, "circuit file or image")->required()->type_name("B");
  command->add_option("--format", arguments->format, "what to print: text for people, json for programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->footer(
      "Exit status: 0 when they are the same, 1 when they differ, 2 when one of them cannot be read or compiled.\n\n"
      "Examples:\n"
      "  tectum diff circuits/oculomotor.json mine.json\n"
      "  tectum diff old.spk new.spk --format json       images know pathways, not which projection made a synapse\n");
  command->callback([arguments, &context] { diff(*arguments, context); });
}

}  // namespace tectum
