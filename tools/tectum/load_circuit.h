// What every command that takes a circuit shares: the file, and what the command line sets over it.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compiler/compile.h"
#include "runtime/image/load_image.h"
#include "tools/tectum/command.h"

namespace tectum {

struct CircuitArguments {
  std::string path;
  std::vector<std::string> lesions;
  std::vector<std::string> parameters;  // name=value
  std::optional<std::uint64_t> circuit_seed;
  int optimisation = 2;
  std::string format = "text";  // or json
};

enum class CircuitKinds { FileOnly, FileOrImage };

/// Adds CIRCUIT, --lesion, -p, -O, --circuit-seed and --format to a command.
void add_circuit_arguments(CLI::App& command, CircuitArguments& arguments, CircuitKinds kinds);

[[nodiscard]] CompileOptions compile_options(const CircuitArguments& arguments);

struct Compilation {
  CompileResult result;
  Diagnostics diagnostics;
};

/// Reads and compiles. Nothing when the file cannot be read, which is printed. Errors in the circuit set the exit
/// status and are left to the caller to print.
[[nodiscard]] std::optional<Compilation> compile_file(const CircuitArguments& arguments, const CompileOptions& options,
                                                      CommandContext& context);

/// Diagnostics as text, and how many there are, to the error stream.
void print_diagnostics(const Compilation& compilation, CommandContext& context);

/// Does the file begin as an image does?
[[nodiscard]] bool is_image_file(const std::string& path);

enum class WarningPolicy { Print, Quiet };

/// Compiles the circuit file, or loads the file when it is an image. Prints what is wrong and sets the exit status
/// when there is nothing to return.
[[nodiscard]] std::optional<SpikeImage> load_circuit(const CircuitArguments& arguments, CommandContext& context,
                                                     WarningPolicy policy);

}  // namespace tectum
