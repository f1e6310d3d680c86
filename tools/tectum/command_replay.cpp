// tectum replay: a recording's input through its circuit once more.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "runtime/loop/replay.h"
#include "runtime/record/recording_file.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct ReplayArguments {
  std::string path;
  std::string format = "text";
  CircuitArguments circuit;  // path empty: the image in the recording
};

std::optional<SpikeImage> image_of(const ReplayArguments& arguments, const Recording& recording,
                                   CommandContext& context) {
  if (!arguments.circuit.path.empty()) {
    return load_circuit(arguments.circuit, context, WarningPolicy::Quiet);
  }
  if (recording.image.empty()) {
    context.err << fmt::format("tectum: {} does not hold its circuit; name it with --circuit\n", arguments.path);
    context.exit_status = kExitUsage;
    return std::nullopt;
  }
  LoadedImage loaded = load_image(recording.image);
  if (!loaded.image) {
    context.err << fmt::format("tectum: {}: the circuit in it: {}\n", arguments.path, loaded.error);
    context.exit_status = kExitFailed;
  }
  return std::move(loaded.image);
}

void replay_file(const ReplayArguments& arguments, CommandContext& context) {
  const ReadRecording read = read_recording(arguments.path);
  if (!read.error.empty()) {
    context.err << fmt::format("tectum: {}\n", read.error);
    context.exit_status = kExitTrouble;
    return;
  }
  if (read.is_truncated) {
    context.err << fmt::format("{}: {}\n", arguments.path, read.ending);
  }
  const std::optional<SpikeImage> image = image_of(arguments, read.recording, context);
  if (!image) {
    return;
  }
  ReplayOptions options;
  options.takes_other_circuit = !arguments.circuit.path.empty();
  std::optional<Progress> progress(std::in_place, context.err, "replaying " + read.recording.circuit_name);
  options.progress = [&](double done) { progress->update(done); };
  const ReplayResult result = replay(*image, read.recording, options);
  progress.reset();
  if (!result.error.empty()) {
    context.err << fmt::format("tectum: {}: {}\n", arguments.path, result.error);
    if (result.is_other_circuit) {
      context.err << "    = help: `tectum diff RECORDING CIRCUIT` compares circuits by name\n";
    }
    context.exit_status = kExitTrouble;
    return;
  }
  context.exit_status = result.is_same ? kExitOk : kExitFailed;
  if (arguments.format == "json") {
    nlohmann::ordered_json json = {{"same", result.is_same},
                                   {"circuit_of_the_recording", !result.is_other_circuit},
                                   {"turns", result.frames},
                                   {"spikes", result.spikes},
                                   {"commands", result.commands}};
    if (read.recording.learns) {
      json["weights_learned"] = result.learned;
    }
    if (!result.is_same) {
      json["first_difference"] = result.difference;
    }
    context.out << json.dump(2) << '\n';
    return;
  }
  if (result.is_other_circuit) {
    context.out << "the circuit, its seed or the compiler is another than the recording's\n";
  }
  const std::string learned =
      read.recording.learns ? fmt::format(", {} weights learned", result.learned) : std::string();
  context.out << (result.is_same ? fmt::format("the same, bit for bit: {} turns, {} spikes, {} commands{}\n",
                                               result.frames, result.spikes, result.commands, learned)
                                 : fmt::format("not the same from {}\n", result.difference));
}

}  // namespace

void add_replay_command(CLI::App& app, CommandContext& context) {
  CLI::App* command =
      app.add_subcommand("replay", "run a recording's input again: is every spike and command the same?");
  auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("recording", arguments->path, "run.trec of `tectum run --record`")->required()->type_name("REC");
  command->add_option("--circuit", arguments->circuit.path, "circuit file or image [the one in the recording]")
      ->type_name("CIRCUIT");
  command->add_option("--format", arguments->format, "text or json")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->footer(
      "Exit status 0 when every spike, decoded angle and command is the same bit for bit, else 1 with the first that "
      "is\n"
      "not. A recording that a killed process left is replayed up to its last whole block.\n\n"
      "Examples:\n"
      "  tectum run circuits/oculomotor.json --head circuits/heads/emulated.json --record out/live\n"
      "  tectum replay out/live/run.trec\n"
      "  tectum replay out/live/run.trec --circuit circuits/oculomotor.json      has the circuit changed since?\n");
  command->callback([arguments, &context] { replay_file(*arguments, context); });
}

}  // namespace tectum
