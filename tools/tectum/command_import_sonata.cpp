// tectum import sonata: a SONATA network as a circuit file with edge lists.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/exchange/import_sonata.h"
#include "tools/tectum/command_import.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct SonataArguments {
  std::vector<std::string> files;
  std::string output;
  std::optional<double> tick_ms;
  std::string format = "text";
};

std::optional<SonataConfig> find_network(const SonataArguments& arguments, std::string& error) {
  const bool is_config = std::filesystem::path(arguments.files.front()).extension() == ".json";
  if (is_config && arguments.files.size() > 1) {
    error = "one configuration names all files of a network; it needs no others beside it";
    return std::nullopt;
  }
  return is_config ? read_sonata_config(arguments.files.front(), error)
                   : sonata_config_of_files(arguments.files, error);
}

void print(const SonataArguments& arguments, const ForeignCircuit& circuit, CommandContext& context) {
  std::size_t neurons = 0;
  for (const ForeignPopulation& population : circuit.populations) {
    neurons += std::size_t{population.size} * population.sides.size();
  }
  if (arguments.format == "json") {
    const nlohmann::ordered_json json = {{"path", arguments.output},
                                         {"neurons", neurons},
                                         {"synapses", circuit.synapse_count()},
                                         {"populations", circuit.populations.size()},
                                         {"projections", circuit.projections.size()},
                                         {"not_said", circuit.warnings}};
    context.out << json.dump(2) << '\n';
    return;
  }
  for (const std::string& warning : circuit.warnings) {
    context.err << "warning: " << warning << '\n';
  }
  context.out << fmt::format("{}: {} populations, {} neurons, {} projections, {} synapses\n", arguments.output,
                             circuit.populations.size(), neurons, circuit.projections.size(), circuit.synapse_count());
}

void import_network(const SonataArguments& arguments, CommandContext& context) {
  std::string error;
  std::optional<ForeignCircuit> circuit;
  {
    Progress progress(context.err, "reading " + arguments.files.front());
    const auto config = find_network(arguments, error);
    if (config) {
      circuit = import_sonata(*config, {arguments.tick_ms}, error, [&](double done) { progress.update(done); });
    }
  }
  if (circuit) {
    Progress progress(context.err, "writing " + arguments.output);
    circuit->about = "Imported from " + arguments.files.front();
    if (!circuit->rest.contains("name") && circuit->name.empty()) {
      circuit->name = circuit_name_of(std::filesystem::path(arguments.output).stem().string());
    }
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

void add_import_sonata_command(CLI::App& import, CommandContext& context) {
  CLI::App* command = import.add_subcommand("sonata", "a SONATA network, as NEST and BMTK use them");
  auto arguments = std::make_shared<SonataArguments>();
  command
      ->add_option(
          "file", arguments->files,
          "circuit_config.json or simulation_config.json; or nodes.h5 and edges.h5, with their tables of types "
          "beside them")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", arguments->output, "circuit file to write; edge lists go beside it")
      ->required()
      ->type_name("CIRCUIT");
  command->add_option("--tick", arguments->tick_ms, "time step in ms [dt of the simulation, else 0.1]")
      ->check(CLI::PositiveNumber)
      ->type_name("MS");
  command->add_option("--format", arguments->format, "what to print: text for people, json for programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->footer(
      "A network that `tectum export --to sonata` wrote comes back with the same spikes, its head included. Of "
      "another\n"
      "network each node type becomes a population. NEST's models iaf_psc_exp, iaf_psc_exp_multisynapse, "
      "iaf_psc_delta,\n"
      "izhikevich, poisson_generator, and aeif_psc_exp with Delta_T = 0 and a = 0 are known; others are refused by "
      "name.\n\n"
      "Exit status: 0 when the circuit is written, 2 when the network cannot be read.\n\n"
      "Examples:\n"
      "  tectum import sonata network/circuit_config.json -o mine.json      also mine_wiring/*.csv\n"
      "  tectum import sonata v1_nodes.h5 v1_v1_edges.h5 -o v1.json         v1_node_types.csv beside them\n"
      "  tectum check mine.json && tectum compile mine.json\n");
  command->callback([arguments, &context] { import_network(*arguments, context); });
}

}  // namespace tectum
