// tectum import matrix: a connectivity matrix of NumPy, SciPy or MATLAB as a circuit file with edge lists.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/exchange/import_matrix.h"
#include "tools/tectum/command_import.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct MatrixArguments {
  MatrixImport import;
  std::string output;
  std::string format = "text";
};

void print(const MatrixArguments& arguments, const ForeignCircuit& circuit, CommandContext& context) {
  std::size_t neurons = 0;
  for (const ForeignPopulation& population : circuit.populations) {
    neurons += population.size;
  }
  if (arguments.format == "json") {
    const nlohmann::ordered_json json = {{"path", arguments.output},
                                         {"neurons", neurons},
                                         {"synapses", circuit.synapse_count()},
                                         {"populations", circuit.populations.size()}};
    context.out << json.dump(2) << '\n';
    return;
  }
  context.out << fmt::format("{}: {} neurons, {} synapses\n", arguments.output, neurons, circuit.synapse_count());
}

void import(const MatrixArguments& arguments, CommandContext& context) {
  std::string error;
  Progress progress(context.err, "importing " + arguments.import.path);
  progress.update(0);
  std::optional<ForeignCircuit> circuit = import_matrix(arguments.import, error);
  if (circuit) {
    circuit->name = circuit_name_of(std::filesystem::path(arguments.output).stem().string());
    circuit->about = "Imported from " + arguments.import.path;
    error = write_foreign_circuit(*circuit, arguments.output, [&](double done) { progress.update(done); });
  }
  if (!error.empty()) {
    context.err << fmt::format("tectum: {}\n", error);
    context.exit_status = kExitTrouble;
    return;
  }
  print(arguments, *circuit, context);
}

}  // namespace

void add_import_matrix_command(CLI::App& import_command, CommandContext& context) {
  CLI::App* command = import_command.add_subcommand("matrix", "a matrix of NumPy (.npz, .npy), SciPy or MATLAB (.mat)");
  auto arguments = std::make_shared<MatrixArguments>();
  MatrixImport& options = arguments->import;
  command->add_option("file", options.path, ".npz, .npy, or .mat of level 5 (-v6, -v7); dense or sparse")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", arguments->output, "circuit file to write; edge lists go beside it")
      ->required()
      ->type_name("CIRCUIT");
  command->add_option("--variable", options.variable, "which matrix, where the file holds several")->type_name("NAME");
  command->add_flag("--rows-are-targets", options.rows_are_targets,
                    "entry (i, j) is the synapse from j to i, not from i to j");
  command->add_flag("--divide-by-input", options.divides_by_input,
                    "divide each entry by the sum of all that its target gets");
  command->add_option("--leading-eigenvalue", options.leading_eigenvalue, "scale the matrix so that it has this one")
      ->check(CLI::PositiveNumber)
      ->type_name("X");
  command->add_option("--scale", options.weight_na, "nA of an entry of 1, after the other scalings")
      ->check(CLI::PositiveNumber)
      ->type_name("NA")
      ->capture_default_str();
  command->add_option("--delay", options.delay_ms, "of every synapse, in whole 0.1 ms")
      ->check(CLI::Range(0.1, 1000.0))
      ->type_name("MS")
      ->capture_default_str();
  command->add_option("--drive", options.drive_hz, "Poisson input that makes the cells fire at about this rate")
      ->check(CLI::Range(0.001, 1000.0))
      ->type_name("HZ");
  command->add_option("--format", arguments->format, "what to print: text for people, json for programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->footer(
      "A square matrix becomes one population of lif_exp neurons, another one sources and targets. Negative entries\n"
      "inhibit. What the cells are is for the circuit file to say: edit it, or lay an overlay over it.\n\n"
      "Exit status: 0 when the circuit is written, 2 when the matrix cannot be read or scaled.\n\n"
      "Examples:\n"
      "  tectum import matrix wiring.npz -o mine.json --drive 5\n"
      "  tectum import matrix paper.mat --variable W --rows-are-targets --divide-by-input --scale 20 -o mine.json\n"
      "  tectum import matrix wiring.npz --leading-eigenvalue 0.95 --scale 30 -o mine.json\n"
      "  tectum check mine.json\n");
  command->callback([arguments, &context] { import(*arguments, context); });
}

}  // namespace tectum
