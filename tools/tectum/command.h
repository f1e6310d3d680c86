// One file per command: each parses its options, calls a library and chooses streams.
#pragma once

#include <CLI/CLI.hpp>
#include <ostream>

namespace tectum {

struct CommandContext {
  std::ostream& out;
  std::ostream& err;
  int exit_status = 0;  // what the chosen command's callback sets
};

void add_bench_command(CLI::App& app, CommandContext& context);
void add_calibrate_command(CLI::App& app, CommandContext& context);
void add_check_command(CLI::App& app, CommandContext& context);
void add_compile_command(CLI::App& app, CommandContext& context);
void add_dump_command(CLI::App& app, CommandContext& context);
void add_eval_command(CLI::App& app, CommandContext& context);
void add_explain_command(CLI::App& app, CommandContext& context);
void add_fmt_command(CLI::App& app, CommandContext& context);
void add_record_command(CLI::App& app, CommandContext& context);
void add_replay_command(CLI::App& app, CommandContext& context);
void add_run_command(CLI::App& app, CommandContext& context);
void add_servo_command(CLI::App& app, CommandContext& context);

}  // namespace tectum
