#include "tools/circuit_tests/run_tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"
#include "compiler/expression/expression.h"
#include "runtime/record/recording_file.h"
#include "tools/circuit_tests/golden_raster.h"
#include "tools/circuit_tests/judge.h"
#include "tools/evaluate/parallel_jobs.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

/// A circuit as a test changes it. Compiled once, whatever the number of tests.
struct CircuitKey {
  std::string path;
  std::vector<std::string> lesions, parameters;
  friend bool operator<(const CircuitKey& a, const CircuitKey& b) {
    return std::tie(a.path, a.lesions, a.parameters) < std::tie(b.path, b.lesions, b.parameters);
  }
};

struct CompiledCircuit {
  std::optional<SpikeImage> image;
  std::vector<std::string> names;  // of its populations
  bool is_missing = false;         // the file
  std::string problem;             // as printed, or one line when missing
};

CompiledCircuit compiled(const CircuitKey& key) {
  CompiledCircuit result;
  ReadSource source = read_source(key.path);
  if (!source.ok) {
    result.is_missing = true;
    result.problem = source.error;
    return result;
  }
  CompileOptions options;
  options.lesions = key.lesions;
  options.parameters = key.parameters;
  Diagnostics diagnostics;
  const CompileResult compilation = compile_circuit(std::move(source.file), options, diagnostics);
  if (!compilation.image) {
    result.problem = render_text(diagnostics, compilation.sources);
    return result;
  }
  LoadedImage loaded = load_image(write_image(*compilation.image));
  result.problem = loaded.error;
  result.image = std::move(loaded.image);
  if (result.image) {
    for (const RecordedPopulation& population : describe_run(*result.image).populations) {
      result.names.push_back(population.name);
    }
  }
  return result;
}

CircuitKey key_of(const CircuitTest& test) { return {test.circuit, test.lesions, test.parameters}; }

/// The other circuit of `same_as` is as it is written.
CircuitKey key_of(const Expectation& expectation) { return {expectation.path, {}, {}}; }

class TestRun {
 public:
  TestRun(const std::vector<TestFile>& files, const TestRunOptions& options) : options_(options) {
    for (const TestFile& file : files) {
      results_.push_back(select(file));
    }
  }

  std::vector<FileResult> run() {
    compile_all();
    for (FileResult& file : results_) {
      for (TestResult& test : file.tests) {
        test.problem = problem_of(*file.file, *test.test);
        test.status = test.problem.empty() ? TestStatus::Passed : TestStatus::Broken;
      }
    }
    run_all();
    for (FileResult& file : results_) {
      for (std::size_t t = 0; t < file.tests.size(); ++t) {
        conclude_test(file, file.tests[t]);
      }
    }
    return std::move(results_);
  }

 private:
  struct SeedRun {
    std::vector<SeedOutcome> outcomes;  // one an expectation
    std::vector<std::string> goldens;   // one an expectation; empty where there is none
    double seconds = 0;
  };

  FileResult select(const TestFile& file) const {
    FileResult result;
    result.file = &file;
    if (!file.error.empty()) {
      result.problem = fmt::format("tectum: {}\n", file.error);
      result.is_unreadable = true;
    }
    result.problem += render_text(file.diagnostics, file.sources);
    if (file.diagnostics.has_errors()) {
      return result;
    }
    for (const CircuitTest& test : file.tests) {
      const std::string name = fmt::format("{}: {}", file.path, test.name);
      if (options_.filter.empty() || name.find(options_.filter) != std::string::npos) {
        result.tests.push_back({.test = &test, .problem = {}, .expectations = {}});
      }
    }
    return result;
  }

  template <typename Visit>
  void each_test(const Visit& visit) {
    for (FileResult& file : results_) {
      for (TestResult& test : file.tests) {
        visit(file, test);
      }
    }
  }

  void compile_all() {
    each_test([&](FileResult&, TestResult& test) {
      circuits_[key_of(*test.test)];
      for (const Expectation& expectation : test.test->expectations) {
        if (expectation.kind == ExpectationKind::SameAs) {
          circuits_[key_of(expectation)];
        }
      }
    });
    std::vector<Job> jobs;
    for (auto& entry : circuits_) {
      jobs.emplace_back([&entry](const std::function<void(double)>&) { entry.second = compiled(entry.first); });
    }
    run_jobs(jobs, options_.threads, {});
  }

  /// Why the test cannot run, or nothing.
  std::string problem_of(const TestFile& file, const CircuitTest& test) {
    Diagnostics diagnostics;
    std::string problem;
    const auto check_circuit = [&](const CircuitKey& key, Span span) {
      const CompiledCircuit& circuit = circuits_[key];
      if (circuit.is_missing) {
        diagnostics.add(Code::UnreadableFile, span, {circuit.problem});
      } else if (!circuit.image) {
        problem += circuit.problem;
      }
      return circuit.image.has_value();
    };
    if (check_circuit(key_of(test), test.circuit_span)) {
      check_populations(test, circuits_[key_of(test)].names, diagnostics);
    }
    for (const Expectation& expectation : test.expectations) {
      if (expectation.kind == ExpectationKind::SameAs) {
        (void)check_circuit(key_of(expectation), expectation.span);
      }
    }
    return render_text(diagnostics, file.sources) + problem;
  }

  static void check_populations(const CircuitTest& test, const std::vector<std::string>& names,
                                Diagnostics& diagnostics) {
    std::vector<std::string> known = names;
    for (const std::string& name : names) {
      known.push_back(name.substr(0, name.find('.')));
    }
    for (const Expectation& expectation : test.expectations) {
      std::vector<std::string> wanted = expectation.populations;
      if (!expectation.population.empty()) {
        wanted.push_back(expectation.population);
      }
      for (const std::string& name : wanted) {
        if (populations_named(names, name).empty()) {
          diagnostics.add(Code::UnknownPopulation, expectation.name_span, {name})
              .help_if(nearest_name(name, known), "did you mean `{}`?");
        }
      }
    }
  }

  void run_all() {
    std::vector<Job> jobs;
    each_test([&](FileResult&, TestResult& test) {
      if (test.status == TestStatus::Broken) {
        return;
      }
      std::vector<SeedRun>& runs = runs_[test.test];
      runs.resize(test.test->seeds.values.size());
      for (std::size_t k = 0; k < runs.size(); ++k) {
        jobs.emplace_back([this, &test, &run = runs[k], k](const std::function<void(double)>& progress) {
          run_seed(*test.test, k, run, progress);
        });
      }
    });
    run_jobs(jobs, options_.threads, options_.progress);
  }

  Recording recorded(const SpikeImage& image, const CircuitTest& test, const SimulatedWorld& world,
                     const std::function<void(double)>& progress) const {
    SimulatedRunOptions options = world_options(image, world);
    options.engine.threads = 1;  // seeds run side by side instead
    const bool has_saccades =
        std::any_of(test.expectations.begin(), test.expectations.end(), [](const Expectation& expectation) {
          return expectation.kind == ExpectationKind::Measure &&
                 std::string_view(measures()[expectation.measure].section) == "saccade";
        });
    options.sample_rate_hz = has_saccades ? kMeasureSampleRateHz : 0;
    RunObserver observer;
    observer.progress = progress;
    return run_simulated_head(image, options, observer);
  }

  void run_seed(const CircuitTest& test, std::size_t k, SeedRun& run,
                const std::function<void(double)>& progress) const {
    const auto begin = std::chrono::steady_clock::now();
    const CompiledCircuit& circuit = circuits_.at(key_of(test));
    SimulatedWorld world = test.world;
    world.seed = test.seeds.values[k];
    const Recording recording = recorded(*circuit.image, test, world, progress);
    RunFacts facts(*circuit.image, recording, test.settle_s);
    std::map<std::string, Recording> others;
    std::string golden;
    JudgedRun judged{facts, circuit.names, {}, {}, world_arguments(world)};
    judged.other = [&](const std::string& path) -> const Recording& {
      if (others.count(path) == 0) {
        others[path] = recorded(*circuits_.at({path, {}, {}}).image, test, world, {});
      }
      return others[path];
    };
    judged.golden = [&](const std::string& now) { golden = now; };
    for (const Expectation& expectation : test.expectations) {
      golden.clear();
      // One golden is one run: that of the first seed.
      const bool is_other_seed = expectation.kind == ExpectationKind::Raster && k > 0;
      SeedOutcome outcome = is_other_seed ? SeedOutcome{world.seed, true, {}, {}} : judge(expectation, judged);
      outcome.seed = world.seed;
      run.outcomes.push_back(std::move(outcome));
      run.goldens.push_back(golden);
    }
    run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  void conclude_test(FileResult& file, TestResult& test) {
    if (test.status == TestStatus::Broken) {
      return;
    }
    std::vector<SeedRun>& runs = runs_[test.test];
    for (const SeedRun& run : runs) {
      test.seconds += run.seconds;
    }
    for (std::size_t e = 0; e < test.test->expectations.size(); ++e) {
      const Expectation& expectation = test.test->expectations[e];
      if (options_.updates && expectation.kind == ExpectationKind::Raster) {
        update_golden(file, expectation, runs.front().goldens[e], runs.front().outcomes[e]);
      }
      std::vector<SeedOutcome> seeds;
      for (const SeedRun& run : runs) {
        seeds.push_back(run.outcomes[e]);
      }
      test.expectations.push_back(conclude(expectation, test.test->seeds.quantifier, std::move(seeds)));
      if (!test.expectations.back().passes) {
        test.status = TestStatus::Failed;
      }
    }
  }

  static void update_golden(FileResult& file, const Expectation& expectation, const std::string& now,
                            SeedOutcome& outcome) {
    std::ifstream before(expectation.path, std::ios::binary);
    const bool is_new = !before;
    if (!is_new && outcome.passes) {
      return;
    }
    before.close();
    std::error_code ignored;
    fs::create_directories(fs::path(expectation.path).parent_path(), ignored);
    std::ofstream written(expectation.path, std::ios::binary);
    written << now;
    written.close();
    if (!written) {
      file.notes.push_back(fmt::format("cannot write {}", expectation.path));
      file.is_unreadable = true;
      return;
    }
    const auto lines = std::count(now.begin(), now.end(), '\n');
    file.notes.push_back(is_new ? fmt::format("{}: new, {} lines", expectation.path, lines)
                                : fmt::format("{}: {}", expectation.path, outcome.seen));
    outcome.passes = true;
    outcome.seen = "the same spikes";
  }

  TestRunOptions options_;
  std::vector<FileResult> results_;
  std::map<CircuitKey, CompiledCircuit> circuits_;
  std::map<const CircuitTest*, std::vector<SeedRun>> runs_;
};

/// As a shell takes it.
std::string quoted(const std::string& text) {
  const bool is_plain = std::all_of(text.begin(), text.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_./=-+,:").find(c) != std::string_view::npos;
  });
  std::string inside;
  for (const char c : text) {
    inside += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return is_plain && !text.empty() ? text : "'" + inside + "'";
}

}  // namespace

std::vector<FileResult> run_tests(const std::vector<TestFile>& files, const TestRunOptions& options) {
  return TestRun(files, options).run();
}

std::vector<std::string> find_test_files(const std::vector<std::string>& paths, std::string& error) {
  std::vector<std::string> found;
  for (const std::string& path : paths) {
    std::error_code failed;
    if (!fs::is_directory(path, failed)) {
      if (!fs::exists(path, failed)) {
        error = fmt::format("{}: No such file or directory", path);
        return {};
      }
      found.push_back(path);
      continue;
    }
    const fs::path folder = path == "." ? fs::path() : fs::path(path);
    std::vector<std::string> in_folder;
    for (fs::recursive_directory_iterator each(path, failed), end; each != end; each.increment(failed)) {
      const std::string name = each->path().filename().string();
      if (each->is_directory(failed) && name.starts_with('.')) {
        each.disable_recursion_pending();
      } else if (name.ends_with(".test.json")) {
        in_folder.push_back((folder / fs::relative(each->path(), path, failed)).string());
      }
    }
    std::sort(in_folder.begin(), in_folder.end());
    found.insert(found.end(), in_folder.begin(), in_folder.end());
  }
  return found;
}

std::string look_command(const CircuitTest& test, std::uint64_t seed) {
  std::string text = fmt::format("tectum run {}", quoted(test.circuit));
  for (const std::string& parameter : test.parameters) {
    text += fmt::format(" -p {}", quoted(parameter));
  }
  for (const std::string& lesion : test.lesions) {
    text += fmt::format(" --lesion {}", quoted(lesion));
  }
  SimulatedWorld world = test.world;
  world.seed = seed;
  return text + world_arguments(world) + " --report out/look.html";
}

}  // namespace tectum
