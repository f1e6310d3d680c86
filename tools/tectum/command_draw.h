#pragma once

#include "tools/tectum/command.h"

namespace tectum {

void add_draw_command(CLI::App& app, CommandContext& context);

}  // namespace tectum
