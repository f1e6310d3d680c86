// tectum fmt: circuit files laid out one way, with their comments.
#include <fmt/format.h>

#include <fstream>
#include <memory>

#include "compiler/format/format_circuit.h"
#include "compiler/source/source_file.h"
#include "tools/tectum/command.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct FmtArguments {
  std::vector<std::string> paths;
  bool only_checks = false;
  bool to_stdout = false;
};

void fmt_file(const FmtArguments& arguments, const std::string& path, CommandContext& context) {
  const ReadSource source = read_source(path);
  if (!source.ok) {
    context.err << fmt::format("tectum fmt: {}\n", source.error);
    context.exit_status = kExitTrouble;
    return;
  }
  const FormattedCircuit formatted = format_circuit(source.file.bytes);
  if (!formatted.text) {
    const Position at = position_of(source.file.bytes, formatted.error_offset);
    context.err << fmt::format("{}:{}:{}: {}\n", path, at.line, at.column, formatted.error);
    context.exit_status = std::max(context.exit_status, kExitFailed);
    return;
  }
  const bool is_formatted = *formatted.text == source.file.bytes;
  if (arguments.to_stdout) {
    context.out << *formatted.text;
  } else if (arguments.only_checks && !is_formatted) {
    context.out << fmt::format("{}: not formatted\n", path);
    context.exit_status = std::max(context.exit_status, kExitFailed);
  } else if (!arguments.only_checks && !is_formatted) {
    std::ofstream file(path, std::ios::binary);
    file << *formatted.text;
    file.close();
    if (!file) {
      context.err << fmt::format("tectum fmt: cannot write {}\n", path);
      context.exit_status = kExitTrouble;
      return;
    }
    context.out << fmt::format("{}: formatted\n", path);
  }
}

}  // namespace

void add_fmt_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("fmt", "lay circuit files out one way; keeps comments, changes no meaning");
  auto arguments = std::make_shared<FmtArguments>();
  command->add_option("files", arguments->paths, "circuit files, rewritten in place")->required()->type_name("FILE...");
  CLI::Option* check =
      command->add_flag("--check", arguments->only_checks, "write nothing; name the files that differ");
  command->add_flag("--stdout", arguments->to_stdout, "print the result and leave the file alone")->excludes(check);
  command->footer(
      "Formatting twice changes nothing more. Exit status: 0 when all is well, 1 when --check finds a file that "
      "differs\n"
      "or a file is no JSON, 2 when a file cannot be read or written.\n\n"
      "Examples:\n"
      "  tectum fmt circuits/*.json\n"
      "  tectum fmt --check circuits/*.json           for CI\n"
      "  tectum fmt --stdout my_circuit.json | diff my_circuit.json -\n");
  command->callback([arguments, &context] {
    for (const std::string& path : arguments->paths) {
      fmt_file(*arguments, path, context);
    }
  });
}

}  // namespace tectum
