// tectum bench: how fast the engine runs a circuit, beside a hand-written loop over the same arrays.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/benchmark/export_network.h"
#include "tools/benchmark/measure.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct BenchArguments {
  std::vector<std::string> paths;
  double duration_s = 10;
  unsigned repetitions = 5;
  unsigned threads = 1;
  double read_out_ms = 0;
  std::string export_folder;
  std::string format = "text";
};

constexpr const char* kShipped[] = {"circuits/bench/cuba_4k.json", "circuits/bench/cuba_40k.json",
                                    "circuits/bench/silent_100k.json", "circuits/bench/loop_2k.json",
                                    "circuits/oculomotor.json"};
constexpr double kLoopReadOutMs = 1;  // of loop_2k, which is a loop with the world
constexpr int kRetinaResolutionPx = 720;

/// Everything about one circuit; the repetitions of the kinds of run take turns.
struct BenchResult {
  std::string name;
  std::uint64_t neurons = 0, synapses = 0;
  double duration_s = 0;
  double load_s = 0;
  double image_bytes_a_synapse = 0, resident_bytes_a_synapse = 0;
  bool has_steps = false;
  std::vector<Timing> engine, threaded, dense, silent;
  double retinas_s_a_frame = 0;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

std::vector<double> seconds_of(const std::vector<Timing>& runs) {
  std::vector<double> seconds;
  for (const Timing& run : runs) {
    seconds.push_back(run.seconds);
  }
  return seconds;
}

double best(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::min_element(values.begin(), values.end());
}

// Repetition by repetition, so that what slows the machine down slows both sides.
std::vector<double> ratios(const std::vector<Timing>& others, const std::vector<Timing>& runs,
                           double Timing::*measure) {
  std::vector<double> result;
  for (std::size_t r = 0; r < std::min(others.size(), runs.size()); ++r) {
    result.push_back(others[r].*measure / runs[r].*measure);
  }
  return result;
}

// Loads the circuit as from a file, to time the loading.
std::optional<SpikeImage> load(const std::string& path, CommandContext& context, BenchResult& result) {
  CircuitArguments circuit;
  circuit.path = path;
  const std::optional<Compilation> compilation = compile_file(circuit, compile_options(circuit), context);
  if (!compilation) {
    return std::nullopt;
  }
  if (!compilation->result.image) {
    print_diagnostics(*compilation, context);
    return std::nullopt;
  }
  const std::string file =
      (std::filesystem::temp_directory_path() / fmt::format("tectum-bench-{}.image", ::getpid())).string();
  {
    const std::vector<std::byte> bytes = write_image(*compilation->result.image);
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  const double before = wall_seconds();
  LoadedImage loaded = load_image_file(file);
  result.load_s = wall_seconds() - before;
  std::filesystem::remove(file);
  if (!loaded.image) {
    context.err << fmt::format("tectum: {}: {}\n", path, loaded.error);
    context.exit_status = kExitTrouble;
  }
  return std::move(loaded.image);
}

void describe(const SpikeImage& image, BenchResult& result) {
  result.name = image.name(image.header.circuit_name);
  result.neurons = image.header.neuron_count;
  result.synapses = image.targets.size();
  const auto synapses = static_cast<double>(std::max<std::uint64_t>(result.synapses, 1));
  result.image_bytes_a_synapse = static_cast<double>(image.header.file_bytes) / synapses;
}

void measure_network(const SpikeImage& image, const BenchArguments& arguments, BenchResult& result,
                     Progress& progress) {
  RunPlan plan;
  const double tick_s = static_cast<double>(image.header.tick_ns) * 1e-9;
  plan.ticks = static_cast<std::uint64_t>(std::llround(arguments.duration_s / tick_s));
  const double read_out_ms =
      arguments.read_out_ms > 0 ? arguments.read_out_ms : (result.name == "loop_2k" ? kLoopReadOutMs : 0);
  plan.ticks_a_step = static_cast<std::uint32_t>(std::llround(read_out_ms * 1e-3 / tick_s));
  result.has_steps = plan.ticks_a_step > 0;
  result.duration_s = static_cast<double>(plan.ticks) * tick_s;
  std::optional<Floor> floor = Floor::make(image);
  const Stimulus stimulus = floor ? record_stimulus(image, plan.ticks) : Stimulus{};
  const bool sleeps = std::any_of(image.groups.begin(), image.groups.end(),
                                  [](const GroupRecord& group) { return (group.flags & kGroupMaySleep) != 0; });
  for (unsigned r = 0; r < arguments.repetitions; ++r) {
    progress.update(static_cast<double>(r) / arguments.repetitions);
    result.engine.push_back(time_engine(image, {}, plan));
    if (floor) {
      result.dense.push_back(time_floor(*floor, FloorKind::Dense, stimulus, plan));
    }
    if (floor && sleeps) {
      result.silent.push_back(time_floor(*floor, FloorKind::Silent, stimulus, plan));
    }
    if (arguments.threads > 1) {
      result.threaded.push_back(time_engine(image, {.threads = arguments.threads}, plan));
    }
  }
}

// A circuit with eyes runs on what it saw in the simulated head.
void measure_seeing(const SpikeImage& image, const BenchArguments& arguments, BenchResult& result, Progress& progress) {
  progress.update(0, "in the simulated head");
  const SeenRun seen = see_moving_target(image, arguments.duration_s);
  result.duration_s = arguments.duration_s;
  for (unsigned r = 0; r < arguments.repetitions; ++r) {
    result.engine.push_back(time_seen(image, {}, seen));
    if (arguments.threads > 1) {
      result.threaded.push_back(time_seen(image, {.threads = arguments.threads}, seen));
    }
  }
  result.retinas_s_a_frame = time_retinas(image, kRetinaResolutionPx);
}

std::optional<BenchResult> measure(const std::string& path, const BenchArguments& arguments, CommandContext& context) {
  Progress progress(context.err, "benchmarking " + path);
  BenchResult result;
  const std::optional<SpikeImage> image = load(path, context, result);
  if (!image) {
    return std::nullopt;
  }
  describe(*image, result);
  if (!arguments.export_folder.empty()) {
    const auto ticks = static_cast<std::uint64_t>(
        std::llround(arguments.duration_s * 1e9 / static_cast<double>(image->header.tick_ns)));
    const std::string folder = (std::filesystem::path(arguments.export_folder) / result.name).string();
    const std::string error =
        export_network(*image, record_stimulus(*image, ticks), record_raster(*image, ticks), folder);
    if (!error.empty()) {
      context.err << fmt::format("tectum: {}\n", error);
      context.exit_status = kExitTrouble;
      return std::nullopt;
    }
  }
  const std::uint64_t before = resident_bytes();
  const SpikeEngine engine(*image);
  result.resident_bytes_a_synapse = static_cast<double>(resident_bytes() - before + image->header.file_bytes) /
                                    static_cast<double>(std::max<std::uint64_t>(result.synapses, 1));
  if (image->retinas.empty()) {
    measure_network(*image, arguments, result, progress);
  } else {
    measure_seeing(*image, arguments, result, progress);
  }
  return result;
}

std::string ratio_text(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", median(values), values.front(), values.back());
}

void print_text(const BenchResult& result, std::ostream& out) {
  const std::vector<double> seconds = seconds_of(result.engine);
  const Timing& run = result.engine.front();
  const double rate_hz = static_cast<double>(run.spikes) / static_cast<double>(result.neurons) / result.duration_s;
  out << fmt::format("{}: {} neurons, {} synapses, {:g} s, {:.3f} Hz\n", result.name, result.neurons, result.synapses,
                     result.duration_s, rate_hz);
  out << fmt::format("  engine          {:.2f} times real time (best {:.2f}), {:.3g} synaptic events/s\n",
                     result.duration_s / median(seconds), result.duration_s / best(seconds),
                     static_cast<double>(run.synaptic_events) / median(seconds));
  const auto floor_line = [&](const char* name, const std::vector<Timing>& floor) {
    if (!floor.empty()) {
      out << fmt::format("  {:<15} {:.2f} times real time (best {:.2f}); engine is {} times as fast\n", name,
                         result.duration_s / median(seconds_of(floor)), result.duration_s / best(seconds_of(floor)),
                         ratio_text(ratios(floor, result.engine, &Timing::seconds)));
    }
  };
  floor_line("floor, dense", result.dense);
  floor_line("floor, silent", result.silent);
  if (result.has_steps) {
    const auto step_line = [&](const char* name, const std::vector<Timing>& runs) {
      std::vector<double> medians, tails;
      for (const Timing& timing : runs) {
        medians.push_back(timing.step_median_us);
        tails.push_back(timing.step_99th_us);
      }
      out << fmt::format("  {:<15} {:.2f} us a step in the median, {:.2f} us in the 99th percentile (best of {})\n",
                         name, best(medians), best(tails), runs.size());
    };
    step_line("engine, step", result.engine);
    if (!result.dense.empty()) {
      step_line("floor, step", result.dense);
    }
  }
  if (!result.threaded.empty()) {
    out << fmt::format("  threads         {} times as fast as one, by the clock on the wall\n",
                       ratio_text(ratios(result.engine, result.threaded, &Timing::wall_seconds)));
  }
  if (result.retinas_s_a_frame > 0) {
    out << fmt::format("  both retinas    {:.3f} ms a camera frame of {} x {} pixels\n", result.retinas_s_a_frame * 1e3,
                       kRetinaResolutionPx, kRetinaResolutionPx);
  }
  out << fmt::format("  memory          {:.2f} bytes a synapse in the image, {:.2f} with the engine's state\n",
                     result.image_bytes_a_synapse, result.resident_bytes_a_synapse);
  out << fmt::format("  load            {:.1f} ms, verified\n\n", result.load_s * 1e3);
}

nlohmann::json json_of(const BenchResult& result) {
  const auto runs = [](const std::vector<Timing>& timings) {
    nlohmann::json list = nlohmann::json::array();
    for (const Timing& timing : timings) {
      list.push_back({{"seconds", timing.seconds},
                      {"wall_seconds", timing.wall_seconds},
                      {"spikes", timing.spikes},
                      {"synaptic_events", timing.synaptic_events},
                      {"step_median_us", timing.step_median_us},
                      {"step_99th_us", timing.step_99th_us}});
    }
    return list;
  };
  return {{"name", result.name},
          {"neurons", result.neurons},
          {"synapses", result.synapses},
          {"duration_s", result.duration_s},
          {"load_s", result.load_s},
          {"image_bytes_a_synapse", result.image_bytes_a_synapse},
          {"resident_bytes_a_synapse", result.resident_bytes_a_synapse},
          {"retinas_s_a_frame", result.retinas_s_a_frame},
          {"engine", runs(result.engine)},
          {"threaded", runs(result.threaded)},
          {"floor_dense", runs(result.dense)},
          {"floor_silent", runs(result.silent)}};
}

void bench(const BenchArguments& arguments, CommandContext& context) {
  std::vector<std::string> paths = arguments.paths;
  if (paths.empty()) {
    paths.assign(std::begin(kShipped), std::end(kShipped));
  }
  nlohmann::json all = nlohmann::json::array();
  for (const std::string& path : paths) {
    const std::optional<BenchResult> result = measure(path, arguments, context);
    if (!result) {
      return;
    }
    if (arguments.format == "json") {
      all.push_back(json_of(*result));
    } else {
      print_text(*result, context.out);
    }
  }
  if (arguments.format == "json") {
    context.out << all.dump(2) << '\n';
  }
}

}  // namespace

void add_bench_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("bench", "time the engine beside a hand-written loop over the same arrays");
  auto arguments = std::make_shared<BenchArguments>();
  command->add_option("CIRCUIT", arguments->paths, "circuit files [those under circuits/bench and the oculomotor one]")
      ->type_name("FILE");
  command->add_option("--duration", arguments->duration_s, "seconds of neural time of one run")
      ->check(CLI::Range(0.1, 1e4))
      ->capture_default_str()
      ->type_name("S");
  command->add_option("--repetitions", arguments->repetitions, "of each kind of run, taking turns")
      ->check(CLI::Range(1U, 1000U))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--threads", arguments->threads, "also time so many threads against one")
      ->check(CLI::Range(1U, 64U))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--read-out", arguments->read_out_ms, "read the spikes out after so many ms and time each step")
      ->check(CLI::Range(0.001, 1e4))
      ->type_name("MS");
  command
      ->add_option("--export", arguments->export_folder, "write edges, stimulus and spikes here, for another simulator")
      ->type_name("DIR");
  command->add_option("--format", arguments->format, "text or json")->check(CLI::IsMember({"text", "json"}));
  command->footer(
      "Times are of the processor, but for threads and steps. Ratios compare runs that took turns: their median, least "
      "and most.\n\n"
      "Examples:\n"
      "  tectum bench\n"
      "  tectum bench circuits/bench/cuba_40k.json --threads 2 --repetitions 9\n"
      "  tectum bench circuits/bench/loop_2k.json --format json\n");
  command->callback([arguments, &context] { bench(*arguments, context); });
}

}  // namespace tectum
