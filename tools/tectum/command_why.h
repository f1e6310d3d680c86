#pragma once

#include "tools/tectum/command.h"

namespace tectum {

void add_why_command(CLI::App& app, CommandContext& context);

}  // namespace tectum
