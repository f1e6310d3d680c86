// tectum record: what is in a recording, and into other programs' formats.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "runtime/record/recording_file.h"
#include "tools/analysis/npz.h"
#include "tools/tectum/command.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct ExportArguments {
  std::string path;
  std::string to;
};

std::optional<Recording> read(const std::string& path, CommandContext& context) {
  ReadRecording read = read_recording(path);
  if (!read.error.empty()) {
    context.err << fmt::format("tectum: {}\n", read.error);
    context.exit_status = kExitTrouble;
    return std::nullopt;
  }
  if (read.is_truncated) {
    context.err << fmt::format("{}: {}\n", path, read.ending);
  }
  return std::move(read.recording);
}

std::string count(std::size_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

void show_json(const Recording& recording, CommandContext& context) {
  nlohmann::ordered_json json = {{"circuit", recording.circuit_name},
                                 {"scenario", recording.scenario},
                                 {"seed", recording.seed},
                                 {"duration_s", recording.duration_s},
                                 {"turns", recording.frames.size()},
                                 {"frame_period_ns", recording.frame_period_ns},
                                 {"spikes", recording.spikes.size()},
                                 {"tick_ns", recording.tick_ns},
                                 {"positions", recording.positions.size()},
                                 {"image_checksum", fmt::format("{:016x}", recording.image_checksum)},
                                 {"image_bytes", recording.image.size()}};
  for (const RecordedPopulation& population : recording.populations) {
    json["populations"].push_back({{"name", population.name},
                                   {"nucleus", population.nucleus},
                                   {"first_neuron", population.first_neuron},
                                   {"size", population.size}});
  }
  for (const RecordedRetina& retina : recording.retinas) {
    json["retinas"].push_back({{"name", retina.name}, {"field_of_view_deg", retina.field_of_view_deg}});
  }
  context.out << json.dump(2) << '\n';
}

void show(const std::string& path, const std::string& format, CommandContext& context) {
  const std::optional<Recording> recording = read(path, context);
  if (!recording) {
    return;
  }
  if (format == "json") {
    show_json(*recording, context);
    return;
  }
  const auto ms = [](std::uint64_t time_ns) { return static_cast<double>(time_ns) / 1e6; };
  context.out << fmt::format("{}: {} ({}), seed {}\n", path, recording->circuit_name, recording->scenario,
                             recording->seed);
  context.out << fmt::format(
      "{:.2f} s: {} turns of {:.3f} ms, {} spikes in ticks of {} ms, {} positions between turns\n",
      recording->duration_s, recording->frames.size(), ms(static_cast<std::uint64_t>(recording->frame_period_ns)),
      recording->spikes.size(), ms(recording->tick_ns), recording->positions.size());
  context.out << fmt::format(
      "circuit: {}, {}, image {:016x}{}\n", count(recording->populations.size(), "population"),
      count(recording->retinas.size(), "retina"), recording->image_checksum,
      recording->image.empty() ? "" : fmt::format(" of {} bytes inside", recording->image.size()));
}

void export_recording(const ExportArguments& arguments, CommandContext& context) {
  const std::optional<Recording> recording = read(arguments.path, context);
  if (!recording) {
    return;
  }
  const bool is_npz = std::filesystem::path(arguments.to).extension() == ".npz";
  const std::string problem =
      is_npz ? write_recording_npz(*recording, arguments.to) : write_recording_csv(*recording, arguments.to);
  if (!problem.empty()) {
    context.err << fmt::format("tectum: {}\n", problem);
    context.exit_status = kExitTrouble;
    return;
  }
  context.out << fmt::format("{}: {} turns, {} spikes\n", arguments.to, recording->frames.size(),
                             recording->spikes.size());
}

}  // namespace

void add_record_command(CLI::App& app, CommandContext& context) {
  CLI::App* record = app.add_subcommand("record", "look into a recording, or export it");
  record->require_subcommand(1);
  record->footer(
      "Examples:\n"
      "  tectum record show out/live/run.trec\n"
      "  tectum record export out/live/run.trec out/live.npz       for NumPy\n"
      "  tectum record export out/live/run.trec out/csv            frames.csv, commands.csv, spikes.csv\n");
  {
    CLI::App* command = record->add_subcommand("show", "what was run, and how much of it is there");
    auto path = std::make_shared<std::string>();
    command->add_option("recording", *path, "run.trec of `tectum run --record`")->required()->type_name("REC");
    command->footer("Example:\n  tectum record show out/live/run.trec\n");
    auto format = std::make_shared<std::string>("text");
    command->add_option("--format", *format, "text or json")
        ->check(CLI::IsMember({"text", "json"}))
        ->capture_default_str();
    command->callback([path, format, &context] { show(*path, *format, context); });
  }
  CLI::App* command = record->add_subcommand("export", "as CSV files, or as NumPy arrays");
  auto arguments = std::make_shared<ExportArguments>();
  command->add_option("recording", arguments->path, "run.trec of `tectum run --record`")->required()->type_name("REC");
  command->add_option("to", arguments->to, "a name ending in .npz, or a folder for CSV files")
      ->required()
      ->type_name("OUT");
  command->footer(
      "Examples:\n"
      "  tectum record export out/live/run.trec out/live.npz\n"
      "  python3 -c \"import numpy; r = numpy.load('out/live.npz'); print(r['goal_deg'].shape, r['spike_tick'][:5])\"\n"
      "  tectum record export out/live/run.trec out/csv\n");
  command->callback([arguments, &context] { export_recording(*arguments, context); });
}

}  // namespace tectum
