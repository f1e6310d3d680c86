#pragma once

#include "tools/tectum/command.h"

namespace tectum {

void add_sweep_command(CLI::App& app, CommandContext& context);

}  // namespace tectum
