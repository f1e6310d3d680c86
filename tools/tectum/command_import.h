// `tectum import`: one file a source of wiring, each with a subcommand of its own.
#pragma once

#include "tools/tectum/command.h"

namespace tectum {

void add_import_edges_command(CLI::App& import, CommandContext& context);
void add_import_matrix_command(CLI::App& import, CommandContext& context);
void add_import_sonata_command(CLI::App& import, CommandContext& context);

void add_import_command(CLI::App& app, CommandContext& context);

}  // namespace tectum
