// Two circuits, images or recordings compared, and the comparison printed.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "tools/diff/battery.h"
#include "tools/tectum/command.h"

namespace tectum {

struct DiffArguments {
  std::string a, b;  // as the command line has them; with `revisions`, `a` alone, and perhaps empty
  std::string revisions;
  std::string format = "text";
  std::string scenario, battery_path, report_path;
  double duration_s = 0;
  std::uint64_t seeds = 4;
  bool structure_only = false;
  bool behaviour_only = false;
  bool tolerates_spread = false;
};

struct PairDiff {
  int exit_status = 0;  // as of diff: 0 the same, 1 different, 2 one of the two cannot be read
  std::string text;     // to be printed: text or JSON, with a newline at its end; empty for 2
};

/// What the comparison runs; nothing when a protocol cannot be read, which it has said.
[[nodiscard]] std::optional<BatteryPlan> diff_plan(const DiffArguments& arguments, CommandContext& context);

/// Compares two files and writes the report, if one is wanted. `named` rewrites the names of files in all that people
/// see. Progress and problems go to context.err; its exit status stays as it is.
[[nodiscard]] PairDiff diff_pair(const DiffArguments& arguments, const BatteryPlan& plan, const std::string& a_path,
                                 const std::string& b_path, const std::function<std::string(std::string)>& named,
                                 CommandContext& context);

}  // namespace tectum
