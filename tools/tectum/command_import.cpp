// tectum import: wiring that others measured or built, as a circuit file.
#include "tools/tectum/command_import.h"

namespace tectum {

void add_import_command(CLI::App& app, CommandContext& context) {
  CLI::App* import = app.add_subcommand("import", "make a circuit file from wiring in another format");
  import->require_subcommand(1);
  import->footer(
      "Examples:\n"
      "  tectum import edges edges.csv --cells cells.csv -o mine.json\n"
      "  tectum import sonata network/circuit_config.json -o mine.json\n"
      "  tectum import matrix wiring.npz -o mine.json --drive 5\n"
      "  tectum check mine.json\n");
  add_import_edges_command(*import, context);
  add_import_matrix_command(*import, context);
  add_import_sonata_command(*import, context);
}

}  // namespace tectum
