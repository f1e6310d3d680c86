// tectum draw: a circuit as a wiring diagram.
#include "tools/tectum/command_draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <set>

#include "compiler/expression/expression.h"
#include "tools/diff/connectome.h"
#include "tools/diff/subject.h"
#include "tools/report/connectome_picture.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct DrawArguments {
  CircuitArguments circuit;
  std::string out_path;  // empty: to standard output
  std::vector<std::string> set_off;
  double width_px = 1000;
};

std::vector<std::string> names_in(const CircuitView& view) {
  std::set<std::string> names;
  for (const PopulationView& population : view.populations) {
    names.insert(population.name);
    names.insert(sided_name(population.name).base);
  }
  for (const PathwayView& pathway : view.pathways) {
    if (!pathway.projection.empty()) {
      names.insert(pathway.projection);
    }
  }
  return {names.begin(), names.end()};
}

/// False, and said, when the circuit has no such part.
bool has_all(const CircuitView& view, const std::vector<std::string>& wanted, CommandContext& context) {
  const std::vector<std::string> names = names_in(view);
  for (const std::string& name : wanted) {
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      continue;
    }
    context.err << fmt::format("tectum draw: no population or projection `{}`\n", name);
    if (const auto nearest = nearest_name(name, names)) {
      context.err << fmt::format("    = help: did you mean `{}`?\n", *nearest);
    }
    context.exit_status = kExitUsage;
    return false;
  }
  return true;
}

std::optional<CircuitView> view_of(const DrawArguments& arguments, CommandContext& context) {
  const CircuitArguments& circuit = arguments.circuit;
  const bool is_changed = !circuit.lesions.empty() || !circuit.parameters.empty() || circuit.circuit_seed.has_value();
  if (!is_changed) {
    DiffSubject subject = load_subject(circuit.path);
    context.err << subject.notice << subject.error;
    if (!subject.error.empty()) {
      context.exit_status = kExitTrouble;
      return std::nullopt;
    }
    if (!subject.has_circuit) {
      context.err << fmt::format("tectum draw: {} does not hold its circuit\n", circuit.path);
      context.exit_status = kExitTrouble;
      return std::nullopt;
    }
    return std::move(subject.view);
  }
  CompileOptions options = compile_options(circuit);
  options.level = OptimisationLevel::O0;  // so that every synapse keeps its projection
  const std::optional<Compilation> compilation = compile_file(circuit, options, context);
  if (!compilation) {
    return std::nullopt;
  }
  if (compilation->diagnostics.has_errors()) {
    print_diagnostics(*compilation, context);
    return std::nullopt;
  }
  const LoadedImage image = load_image(write_image(*compilation->result.image));
  if (!image.image) {
    context.err << fmt::format("tectum: {}: {}\n", circuit.path, image.error);
    context.exit_status = kExitTrouble;
    return std::nullopt;
  }
  return view_of_compilation(circuit.path, *image.image, compilation->result);
}

void draw(const DrawArguments& arguments, CommandContext& context) {
  const std::optional<CircuitView> view = view_of(arguments, context);
  if (!view || !has_all(*view, arguments.set_off, context)) {
    return;
  }
  const std::string svg =
      connectome_svg(connectome_of(*view, std::set<std::string>(arguments.set_off.begin(), arguments.set_off.end())),
                     arguments.width_px);
  if (arguments.out_path.empty()) {
    context.out << svg;
    return;
  }
  std::ofstream file(arguments.out_path, std::ios::binary);
  file << svg;
  file.close();
  if (!file) {
    context.err << fmt::format("tectum: cannot write {}\n", arguments.out_path);
    context.exit_status = kExitTrouble;
    return;
  }
  context.err << fmt::format("wiring: {}\n", arguments.out_path);
}

}  // namespace

void add_draw_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("draw", "a circuit's wiring diagram, as SVG");
  auto arguments = std::make_shared<DrawArguments>();
  add_circuit_arguments(*command, arguments->circuit, CircuitKinds::FileOrImage);
  command->remove_option(command->get_option("--format"));
  command->remove_option(command->get_option("-O"));
  command->add_option("-o,--out", arguments->out_path, "where to [standard output]")->type_name("FILE.svg");
  command->add_option("--set-off", arguments->set_off, "draw a population or projection in another colour; repeatable")
      ->type_name("NAME");
  command->add_option("--width", arguments->width_px, "of the picture; the height follows")
      ->check(CLI::Range(320.0, 10000.0))
      ->type_name("PX")
      ->capture_default_str();
  command->footer(
      "A panel for each pair of sides, mirrored about its midline; a band for each nucleus; rows go by the fewest\n"
      "synapses from an input; joints below. Dashed boxes stand in another panel and are drawn for what they send.\n"
      "A line under the pointer says which projection it is, with weight, delay and receptor.\n\n"
      "Examples:\n"
      "  tectum draw circuits/oculomotor.json -o wiring.svg\n"
      "  tectum draw circuits/oculomotor.json --lesion OPN --set-off EBN -o lesion.svg\n"
      "  tectum draw out/run.trec -o wiring.svg          the circuit in a recording\n");
  command->callback([arguments, &context] { draw(*arguments, context); });
}

}  // namespace tectum
