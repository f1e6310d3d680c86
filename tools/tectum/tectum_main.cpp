#include "tools/tectum/tectum_main.h"

#include <algorithm>

#include "tools/tectum/command.h"
#include "tools/tectum/command_diff.h"
#include "tools/tectum/command_draw.h"
#include "tools/tectum/command_export.h"
#include "tools/tectum/command_import.h"
#include "tools/tectum/command_sweep.h"
#include "tools/tectum/command_test.h"
#include "tools/tectum/command_why.h"
#include "tools/tectum/usage_error.h"

namespace tectum {

int tectum_main(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
  CLI::App app{"Tectum compiles a connectome written as a circuit file and runs it on a robotic head.", "tectum"};
  app.footer(
      "Examples:\n"
      "  tectum check circuits/oculomotor.json\n"
      "  tectum run circuits/oculomotor.json --scenario random --duration 60 --report out/report.html\n"
      "  tectum COMMAND --help\n");
  app.require_subcommand(1);
  app.set_version_flag("--version", "tectum 0.1.0");

  CommandContext context{out, err};
  add_check_command(app, context);
  add_compile_command(app, context);
  add_diff_command(app, context);
  add_draw_command(app, context);
  add_dump_command(app, context);
  add_explain_command(app, context);
  add_fmt_command(app, context);
  add_export_command(app, context);
  add_import_command(app, context);
  add_bench_command(app, context);
  add_run_command(app, context);
  add_eval_command(app, context);
  add_test_command(app, context);
  add_sweep_command(app, context);
  add_replay_command(app, context);
  add_why_command(app, context);
  add_record_command(app, context);
  add_calibrate_command(app, context);
  add_servo_command(app, context);

  std::vector<std::string> reversed(args.rbegin(), args.rend());
  if (reversed.empty()) {
    reversed.emplace_back("--help");
  }
  if (const auto unknown = unknown_command(app, args)) {
    err << *unknown;
    return kExitUsage;
  }
  try {
    app.parse(reversed);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      err << usage_error(app, error);
      return kExitUsage;
    }
    return app.exit(error, out, err);  // --help and --version
  }
  return context.exit_status;
}

}  // namespace tectum
