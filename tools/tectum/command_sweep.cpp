// tectum sweep: a protocol for every combination of parameters and seeds.
#include "tools/tectum/command_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "tools/sweep/sweep_output.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/load_protocol.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

struct SweepArguments {
  std::string path;
  std::vector<std::string> axes;
  std::vector<std::string> lesions;
  std::optional<std::uint64_t> circuit_seed;
  std::string protocol = "step";
  double duration_s = 0;
  std::string folder;
  std::string emit;
  std::string format = "text";
  unsigned threads = 0;
  bool makes_rows_only = false;
};

void refuse(const std::string& what, CommandContext& context) {
  context.err << fmt::format("tectum: {}\n", what);
  context.exit_status = kExitUsage;
}

std::optional<SweepPlan> plan_of(const SweepArguments& arguments, CommandContext& context) {
  SweepPlan plan;
  for (const std::string& text : arguments.axes) {
    ReadAxis read = read_axis(text);
    if (!read.axis) {
      refuse(read.error, context);
      return std::nullopt;
    }
    plan.axes.push_back(std::move(*read.axis));
  }
  const std::string problem = axes_problem(plan.axes);
  if (!problem.empty()) {
    refuse(problem, context);
    return std::nullopt;
  }
  if (is_image_file(arguments.path)) {
    refuse(fmt::format("{} is an image, whose parameters are fixed; a sweep needs the circuit file", arguments.path),
           context);
    return std::nullopt;
  }
  std::optional<Protocol> protocol = load_protocol(arguments.protocol, arguments.path, context);
  if (!protocol) {
    return std::nullopt;
  }
  if (protocol->kind != ProtocolKind::Tracking) {
    refuse(fmt::format("protocol `{}` is not about tracking a target; a sweep needs one that is, such as step",
                       protocol->name),
           context);
    return std::nullopt;
  }
  if (arguments.duration_s > 0) {
    protocol->duration_s = arguments.duration_s;
  }
  plan.protocol = std::move(*protocol);
  plan.circuit_path = arguments.path;
  plan.compile.lesions = arguments.lesions;
  plan.compile.seed = arguments.circuit_seed;
  plan.threads = arguments.threads;
  plan.folder = arguments.folder.empty()
                    ? fmt::format("out/sweep_{}_{}", fs::path(arguments.path).stem().string(), plan.protocol.name)
                    : arguments.folder;
  return plan;
}

/// This program, as another shell finds it.
std::string program() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  return !error && self.filename() == "tectum" ? self.string() : "tectum";
}

/// The words that the whole sweep and each of its tasks share.
std::string shared_words(const SweepArguments& arguments, const SweepPlan& plan, const std::string& program_path) {
  std::string text = fmt::format("{} sweep {}", shell_word(program_path), shell_word(arguments.path));
  for (const std::string& lesion : arguments.lesions) {
    text += " --lesion " + shell_word(lesion);
  }
  text += arguments.circuit_seed ? fmt::format(" --circuit-seed {}", *arguments.circuit_seed) : "";
  text += " --protocol " + shell_word(arguments.protocol);
  text += arguments.duration_s > 0 ? fmt::format(" --duration {}", arguments.duration_s) : "";
  return text + " --out " + shell_word(plan.folder);
}

std::string whole_command(const SweepArguments& arguments, const SweepPlan& plan, const std::string& program_path) {
  std::string text = shared_words(arguments, plan, program_path);
  for (const std::string& axis : arguments.axes) {
    text += " -p " + shell_word(axis);
  }
  return text;
}

/// Prints what went wrong. False when something did.
bool went_well(const SweepResult& result, CommandContext& context) {
  if (!result.circuit_problems.empty()) {
    context.err << result.circuit_problems;
    context.exit_status = kExitFailed;
    return false;
  }
  if (!result.error.empty()) {
    context.err << fmt::format("tectum: {}\n", result.error);
    context.exit_status = kExitTrouble;
    return false;
  }
  return true;
}

void emit(const SweepArguments& arguments, const SweepPlan& plan, CommandContext& context) {
  if (!went_well(check_sweep(plan), context)) {
    return;  // rather than a hundred jobs that fail on a cluster
  }
  const std::vector<std::string> tasks = task_commands(plan, shared_words(arguments, plan, program()));
  if (arguments.emit == "slurm") {
    context.out << slurm_script(tasks);
  } else {
    for (const std::string& task : tasks) {
      context.out << task << '\n';
    }
  }
  context.err << fmt::format("{} tasks; when all have run, the table: {}\n", tasks.size(),
                             whole_command(arguments, plan, program()));
}

bool write_file(const fs::path& path, const std::string& text, CommandContext& context) {
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file) {
    context.err << fmt::format("tectum: {}: cannot be written\n", path.string());
    context.exit_status = kExitTrouble;
  }
  return !!file;
}

void print(const SweepArguments& arguments, const SweepPlan& plan, const SweepResult& result, double seconds,
           CommandContext& context) {
  if (arguments.format == "json") {
    context.out << sweep_json(plan, result) << '\n';
    return;
  }
  const std::size_t kept = result.distinct - result.runs;
  std::string text = fmt::format("{} run{}: ", result.points.size(), result.points.size() == 1 ? "" : "s");
  text += fmt::format("{} run now", result.runs);
  text += result.runs > 0 ? fmt::format(" in {:.0f} s", seconds) : "";
  text += kept > 0 ? fmt::format(", {} kept from before", kept) : "";
  const std::size_t shared = result.points.size() - result.distinct;
  text += shared > 0 ? fmt::format(", {} the same circuit and seed as another", shared) : "";
  context.out << text << "\n" << sweep_text(plan, result);
  const fs::path folder = plan.folder;
  context.out << fmt::format("table: {}\nheat maps: {}\n", (folder / "sweep.csv").string(),
                             (folder / "sweep.html").string());
}

void sweep(const SweepArguments& arguments, CommandContext& context) {
  const std::optional<SweepPlan> plan = plan_of(arguments, context);
  if (!plan) {
    return;
  }
  if (!arguments.emit.empty()) {
    emit(arguments, *plan, context);
    return;
  }
  const auto begin = std::chrono::steady_clock::now();
  SweepResult result;
  {
    Progress progress(context.err, "sweeping " + fs::path(plan->circuit_path).stem().string());
    result = run_sweep(*plan, [&](double done, std::size_t ready, std::size_t all) {
      progress.update(done, fmt::format("{} of {} runs", ready, all));
    });
  }
  if (!went_well(result, context)) {
    return;
  }
  if (arguments.makes_rows_only) {
    return;
  }
  const fs::path folder = plan->folder;
  if (write_file(folder / "sweep.csv", sweep_csv(*plan, result), context) &&
      write_file(folder / "sweep.html", sweep_page(*plan, result, whole_command(arguments, *plan, "tectum")),
                 context)) {
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    print(arguments, *plan, result, took.count(), context);
  }
}

void add_options(CLI::App& command, SweepArguments& arguments) {
  command.add_option("circuit", arguments.path, "circuit file (JSON)")->required()->type_name("CIRCUIT");
  command
      .add_option("-p,--parameter", arguments.axes,
                  "a parameter and its values: 1,2,5 or 0..9 or 0.5..1.5nA:11 (eleven, both ends in); seed is that of "
                  "the simulated world; repeatable, every combination is run")
      ->required()
      ->type_name("NAME=VALUES")
      ->expected(1)
      ->take_all();
  command.add_option("--protocol", arguments.protocol, "a name out of circuits/protocols, or a file (.json)")
      ->capture_default_str()
      ->type_name("NAME");
  command.add_option("--duration", arguments.duration_s, "seconds of each run, instead of the protocol's")
      ->check(CLI::Range(1.0, 1e5))
      ->type_name("S");
  command
      .add_option(
          "--lesion", arguments.lesions,
          "take out a population (OPN), one side (EBN.left), a projection or a pathway in every run; repeatable")
      ->type_name("NAME")
      ->expected(1)
      ->take_all();
  command.add_option("--circuit-seed", arguments.circuit_seed, "instead of the file's `seed`")->type_name("N");
  command.add_option("-o,--out", arguments.folder, "folder of the results [out/sweep_CIRCUIT_PROTOCOL]")
      ->type_name("FOLDER");
  command.add_option("--threads", arguments.threads, "runs side by side; never changes a result [one for each core]")
      ->check(CLI::Range(1U, 1024U))
      ->type_name("N");
  command.add_option("--emit", arguments.emit, "run nothing; print the runs as jobs for GNU parallel or Slurm")
      ->check(CLI::IsMember({"parallel", "slurm"}))
      ->type_name("KIND");
  command.add_flag("--rows-only", arguments.makes_rows_only, "run, but make no table: what the emitted jobs do");
  command.add_option("--format", arguments.format, "what to print: text for people, json for programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
}

}  // namespace

void add_sweep_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("sweep", "run a protocol for every combination of parameters and seeds");
  auto arguments = std::make_shared<SweepArguments>();
  add_options(*command, *arguments);
  command->footer(
      "FOLDER/sweep.csv has a row for each run, FOLDER/sweep.html heat maps. Each run's result is kept in FOLDER/rows\n"
      "under a digest of all that it depends on: give the same command again after a crash, or with more values, and\n"
      "only what is missing is run. Of a protocol with several holds and camera latencies the first are run.\n\n"
      "Examples:\n"
      "  tectum sweep circuits/oculomotor.json -p error_gain=0.3..0.5nA/deg:11 -p seed=0..9 --protocol step\n"
      "  tectum sweep circuits/oculomotor.json -p amplitude_gain=1.2..1.6:5 -p edge_growth=0.07,0.09,0.11 -p "
      "seed=0..4\n"
      "  tectum sweep mine.json -p gain=0.5..1.5:11 --emit parallel --out out/s | parallel\n"
      "  tectum sweep mine.json -p gain=0.5..1.5:11 --emit slurm --out out/s > jobs.sh && sbatch jobs.sh\n"
      "  tectum sweep mine.json -p gain=0.5..1.5:11 --out out/s     the table, when all jobs have run\n");
  command->callback([arguments, &context] { sweep(*arguments, context); });
}

}  // namespace tectum
