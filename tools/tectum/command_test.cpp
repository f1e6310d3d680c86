// tectum test: circuits under test, like code.
#include "tools/tectum/command_test.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <fstream>
#include <memory>

#include "tools/circuit_tests/run_tests.h"
#include "tools/circuit_tests/test_report.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct TestArguments {
  std::vector<std::string> paths;
  TestRunOptions options;
  std::string junit_path;
  std::string format = "text";
};

void test(const TestArguments& arguments, CommandContext& context) {
  std::string error;
  const std::vector<std::string> paths = find_test_files(arguments.paths, error);
  if (error.empty() && paths.empty()) {
    error = fmt::format("{}: no *.test.json there", fmt::join(arguments.paths, ", "));
  }
  if (!error.empty()) {
    context.err << fmt::format("tectum: {}\n", error);
    context.exit_status = kExitTrouble;
    return;
  }
  std::vector<TestFile> files;
  for (const std::string& path : paths) {
    files.push_back(read_test_file(path));
  }
  const auto begin = std::chrono::steady_clock::now();
  std::vector<FileResult> results;
  {
    Progress progress(context.err, "testing");
    TestRunOptions options = arguments.options;
    options.progress = [&](double done) { progress.update(done); };
    results = run_tests(files, options);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const TestTotals totals = totals_of(results);
  if (totals.all() == 0 && !totals.is_trouble) {
    context.err << fmt::format("tectum test: no test has `{}` in `FILE: NAME`\n", arguments.options.filter);
    context.exit_status = kExitUsage;
    return;
  }
  context.out << (arguments.format == "json" ? test_json(results) + "\n" : test_text(results, seconds));
  if (!arguments.junit_path.empty()) {
    std::ofstream file(arguments.junit_path, std::ios::binary);
    file << junit_xml(results);
    file.close();
    if (!file) {
      context.err << fmt::format("tectum: cannot write {}\n", arguments.junit_path);
      context.exit_status = kExitTrouble;
      return;
    }
  }
  context.exit_status = totals.is_trouble || totals.broken > 0 ? kExitTrouble
                        : totals.failed > 0                    ? kExitFailed
                                                               : kExitOk;
}

}  // namespace

void add_test_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("test", "run the tests of circuits: NAME.test.json");
  auto arguments = std::make_shared<TestArguments>();
  command->add_option("paths", arguments->paths, "test files, or folders to look for *.test.json in")
      ->required()
      ->type_name("PATH");
  command->add_option("-k,--filter", arguments->options.filter, "only tests with this in `FILE: NAME`")
      ->type_name("TEXT");
  command->add_flag("--update", arguments->options.updates,
                    "write golden rasters as they are now, and say what changed");
  command->add_option("--junit", arguments->junit_path, "also write JUnit XML, for CI")->type_name("FILE.xml");
  command
      ->add_option("--threads", arguments->options.threads,
                   "runs side by side; never changes a result [one for each core]")
      ->check(CLI::Range(1U, 1024U))
      ->type_name("N");
  command->add_option("--format", arguments->format, "what to print: text for people, json for programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->footer(
      "A test names a circuit, what happens to it, and what is expected of it:\n"
      "  \"a 10 deg step is one saccade\": {\n"
      "    \"scenario\": { \"kind\": \"jump\", \"to\": [\"10 deg\", \"0 deg\"], \"duration\": \"4 s\" },\n"
      "    \"seeds\": { \"every\": \"1..5\" },\n"
      "    \"expect\": { \"saccade\": { \"latency\": \"< 80 ms\", \"amplitude\": \"10 deg \xC2\xB1 1\" } }\n"
      "  }\n"
      "circuits/README.md lists what can be expected.\n\n"
      "Exit status: 0 when all pass, 1 when one fails, 2 when one cannot run.\n\n"
      "Examples:\n"
      "  tectum test circuits\n"
      "  tectum test circuits/oculomotor.test.json -k saccade\n"
      "  tectum test . --junit out/tests.xml\n"
      "  tectum test circuits --update          after a change of behaviour that is meant\n");
  command->callback([arguments, &context] { test(*arguments, context); });
}

}  // namespace tectum
