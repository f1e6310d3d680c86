// tectum eval: a circuit by a protocol, beside the physical limit and an engineer's servo.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "tools/evaluate/evaluation_report.h"
#include "tools/evaluate/evaluation_text.h"
#include "tools/evaluate/learning_evaluation.h"
#include "tools/evaluate/movements.h"
#include "tools/evaluate/physiology.h"
#include "tools/evaluate/recorded_head.h"
#include "tools/evaluate/tracking_evaluation.h"
#include "tools/tectum/eval_clinic.h"
#include "tools/tectum/eval_robustness.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/load_protocol.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

struct EvalArguments {
  CircuitArguments circuit;
  std::vector<std::string> others;  // circuits beside it
  std::string protocol = "paper";
  int trials = 0;
  double duration_s = 0;
  unsigned threads = 0;
  std::string report_path;
  std::string recorded_path;
  bool tunes_pid = false;
};

std::optional<Protocol> protocol_of(const EvalArguments& arguments, CommandContext& context) {
  std::optional<Protocol> protocol = load_protocol(arguments.protocol, arguments.circuit.path, context);
  if (!protocol) {
    return std::nullopt;
  }
  if (arguments.trials > 0) {
    protocol->trials = arguments.trials;
  }
  if (arguments.duration_s > 0) {
    protocol->duration_s = arguments.duration_s;
  }
  return protocol;
}

/// The circuit and those beside it, all by the same options; empty when one of them cannot be used.
std::vector<SpikeImage> load_circuits(const EvalArguments& arguments, CommandContext& context) {
  std::vector<SpikeImage> images;
  std::vector<std::string> paths = {arguments.circuit.path};
  paths.insert(paths.end(), arguments.others.begin(), arguments.others.end());
  for (const std::string& path : paths) {
    CircuitArguments circuit = arguments.circuit;
    circuit.path = path;
    std::optional<SpikeImage> image = load_circuit(circuit, context, WarningPolicy::Quiet);
    if (!image) {
      return {};
    }
    images.push_back(std::move(*image));
  }
  return images;
}

std::string name_of(const SpikeImage& image) { return std::string(image.name(image.header.circuit_name)); }

bool write_text(const std::string& path, const std::string& text, CommandContext& context) {
  std::error_code error;
  const fs::path parent = fs::path(path).parent_path();
  if (!parent.empty()) {
    fs::create_directories(parent, error);
  }
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) {
    context.err << fmt::format("tectum: cannot write {}\n", path);
    context.exit_status = kExitTrouble;
    return false;
  }
  return true;
}

/// The page of the only circuit, where one is asked for.
void report(const EvalArguments& arguments, const std::string& html, CommandContext& context) {
  if (write_text(arguments.report_path, html, context)) {
    context.err << fmt::format("report: {}\n", arguments.report_path);
  }
}

EvaluationTitle title_of(const EvalArguments& arguments, const SpikeImage& image) {
  const std::string recorded = arguments.recorded_path.empty() ? "" : " --recorded " + arguments.recorded_path;
  return {name_of(image),
          fmt::format("tectum eval {} --protocol {}{}", arguments.circuit.path, arguments.protocol, recorded)};
}

/// JSON of one circuit is an object, of several a list of such.
std::string json_of(const std::vector<std::string>& circuits) {
  return circuits.size() == 1 ? circuits.front() + '\n' : fmt::format("[\n{}\n]\n", fmt::join(circuits, ",\n"));
}

void compare_tracking(const EvalArguments& arguments, const Protocol& protocol, const std::vector<SpikeImage>& images,
                      const std::optional<RecordedHead>& recorded_head, const std::function<void(double)>& watch,
                      CommandContext& context) {
  const RecordedHead* recorded = recorded_head ? &*recorded_head : nullptr;
  std::vector<CircuitEvaluation> circuits;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto watch_one = [&](double done) {
      watch((static_cast<double>(i) + done) / static_cast<double>(images.size()));
    };
    circuits.push_back({name_of(images[i]), evaluate_tracking(images[i], protocol, arguments.threads, watch_one)});
  }
  if (!arguments.report_path.empty()) {
    report(arguments,
           tracking_report(title_of(arguments, images.front()), protocol, circuits.front().evaluation, recorded),
           context);
  }
  if (arguments.circuit.format != "json") {
    context.out << tracking_text(protocol, circuits, recorded);
    return;
  }
  std::vector<std::string> parts;
  for (const CircuitEvaluation& circuit : circuits) {
    parts.push_back(tracking_json(protocol, circuit.circuit, circuit.evaluation, recorded));
  }
  context.out << json_of(parts);
}

void measure_physiology(const EvalArguments& arguments, const Protocol& protocol, const std::vector<SpikeImage>& images,
                        const std::function<void(double)>& watch, CommandContext& context) {
  std::vector<std::string> parts;
  for (const SpikeImage& image : images) {
    const std::vector<Yardstick> yardsticks = physiology(image, protocol, arguments.threads, watch);
    if (!arguments.report_path.empty()) {
      report(arguments, physiology_report(title_of(arguments, image), protocol, yardsticks), context);
    }
    if (arguments.circuit.format == "json") {
      parts.push_back(physiology_json(protocol, name_of(image), yardsticks));
    } else {
      context.out << (images.size() > 1 ? name_of(image) + '\n' : "") << physiology_text(protocol, yardsticks);
    }
  }
  if (!parts.empty()) {
    context.out << json_of(parts);
  }
}

void measure_learning(const EvalArguments& arguments, const Protocol& protocol, const std::vector<SpikeImage>& images,
                      const std::function<void(double)>& watch, CommandContext& context) {
  std::vector<std::string> parts;
  for (const SpikeImage& image : images) {
    const std::vector<LearningResult> results = evaluate_learning(image, protocol, arguments.threads, watch);
    if (!arguments.report_path.empty()) {
      report(arguments, text_report(title_of(arguments, image), protocol, learning_text(protocol, results)), context);
    }
    if (arguments.circuit.format == "json") {
      parts.push_back(learning_json(protocol, name_of(image), results));
    } else {
      context.out << (images.size() > 1 ? name_of(image) + '\n' : "") << learning_text(protocol, results);
    }
  }
  if (!parts.empty()) {
    context.out << json_of(parts);
  }
}

void measure_one_kind(const EvalArguments& arguments, const Protocol& protocol, const std::vector<SpikeImage>& images,
                      const std::function<void(double)>& watch, CommandContext& context) {
  std::vector<std::string> parts;
  for (const SpikeImage& image : images) {
    const MeasuredProtocol measured = measure_movements(image, protocol, arguments.threads, watch);
    if (!arguments.report_path.empty()) {
      report(arguments, measures_report(title_of(arguments, image), protocol, measured), context);
    }
    if (arguments.circuit.format == "json") {
      parts.push_back(measures_json(protocol.name, name_of(image), measured.tables));
    } else {
      context.out << (images.size() > 1 ? name_of(image) + '\n' : "") << measures_text(measured.tables);
    }
  }
  if (!parts.empty()) {
    context.out << json_of(parts);
  }
}

void measure_robustness(const EvalArguments& arguments, const Protocol& protocol, CommandContext& context) {
  std::vector<std::string> paths = {arguments.circuit.path};
  paths.insert(paths.end(), arguments.others.begin(), arguments.others.end());
  std::vector<std::string> parts;
  for (const std::string& path : paths) {
    CircuitArguments circuit = arguments.circuit;
    circuit.path = path;
    const std::optional<MeasuredProtocol> measured = eval_robustness(
        circuit, protocol, protocol_path(arguments.protocol, arguments.circuit.path), arguments.threads, context);
    if (!measured) {
      return;
    }
    const std::string name = fs::path(path).stem().string();
    if (!arguments.report_path.empty()) {
      const EvaluationTitle title{name, fmt::format("tectum eval {} --protocol {}", path, arguments.protocol)};
      report(arguments, measures_report(title, protocol, *measured), context);
    }
    if (arguments.circuit.format == "json") {
      parts.push_back(measures_json(protocol.name, name, measured->tables));
    } else {
      context.out << (paths.size() > 1 ? name + '\n' : "") << measures_text(measured->tables);
    }
  }
  if (!parts.empty()) {
    context.out << json_of(parts);
  }
}

/// What stands in --recorded, read before anything runs; false when it cannot be used.
bool load_recorded(const EvalArguments& arguments, const Protocol& protocol, std::optional<RecordedHead>& head,
                   CommandContext& context) {
  if (arguments.recorded_path.empty()) {
    return true;
  }
  std::string error;
  if (protocol.kind != ProtocolKind::Tracking || protocol.scenario.kind != ScenarioKind::Step || arguments.tunes_pid) {
    error = arguments.tunes_pid ? "--recorded has no part in --tune-pid"
                                : fmt::format(
                                      "--recorded is a head that follows steps: it goes with --protocol step, "
                                      "not with `{}`",
                                      protocol.name);
  } else {
    ReadRecordedHead read = read_recorded_head(arguments.recorded_path, protocol.wall_distance_m);
    head = std::move(read.head);
    error = std::move(read.error);
  }
  if (!error.empty()) {
    context.err << fmt::format("tectum: {}\n", error);
    context.exit_status = kExitTrouble;
  }
  return error.empty();
}

void run(const EvalArguments& arguments, CommandContext& context) {
  const std::optional<Protocol> protocol = protocol_of(arguments, context);
  std::optional<RecordedHead> recorded;
  if (!protocol || !load_recorded(arguments, *protocol, recorded, context)) {
    return;
  }
  if (protocol->kind == ProtocolKind::Clinic) {
    std::vector<CircuitArguments> circuits = {arguments.circuit};
    for (const std::string& path : arguments.others) {
      circuits.push_back(arguments.circuit);
      circuits.back().path = path;
    }
    eval_clinic(circuits, *protocol, protocol_path(arguments.protocol, arguments.circuit.path), arguments.report_path,
                arguments.threads, context);
    return;
  }
  if (!arguments.report_path.empty() && !arguments.others.empty()) {
    context.err << "tectum: --report is for one circuit at a time, except in the clinic\n";
    context.exit_status = kExitTrouble;
    return;
  }
  if (protocol->kind == ProtocolKind::Robustness && !arguments.tunes_pid) {
    measure_robustness(arguments, *protocol, context);
    return;
  }
  const std::vector<SpikeImage> images = load_circuits(arguments, context);
  if (images.empty()) {
    return;
  }
  for (const SpikeImage& image : images) {
    if (protocol->kind == ProtocolKind::Learning && image.plasticity.empty()) {
      context.err << fmt::format("tectum: nothing in {} learns: no projection has `plasticity`\n", name_of(image));
      context.exit_status = kExitFailed;
      return;
    }
  }
  Progress progress(context.err,
                    fmt::format("{} {}", arguments.tunes_pid ? "tuning for" : "evaluating", protocol->name));
  const auto watch = [&](double done) { progress.update(done); };
  if (arguments.tunes_pid) {
    context.out << tuning_text(*protocol, tune_pid(images.front(), *protocol, arguments.threads, watch));
    return;
  }
  if (protocol->kind == ProtocolKind::Physiology) {
    measure_physiology(arguments, *protocol, images, watch, context);
  } else if (protocol->kind == ProtocolKind::Learning) {
    measure_learning(arguments, *protocol, images, watch, context);
  } else if (protocol->kind != ProtocolKind::Tracking) {
    measure_one_kind(arguments, *protocol, images, watch, context);
  } else {
    compare_tracking(arguments, *protocol, images, recorded, watch, context);
  }
}

}  // namespace

void add_eval_command(CLI::App& app, CommandContext& context) {
  CLI::App* command =
      app.add_subcommand("eval", "measure a circuit by a protocol, beside the physical limit and a PID servo");
  auto arguments = std::make_shared<EvalArguments>();
  add_circuit_arguments(*command, arguments->circuit, CircuitKinds::FileOrImage);
  command->add_option("others", arguments->others, "more circuits, for one table of all")->type_name("CIRCUIT");
  command->add_option("--protocol", arguments->protocol, "a name out of circuits/protocols, or a file (.json)")
      ->capture_default_str()
      ->type_name("NAME");
  command->add_option("--trials", arguments->trials, "fewer or more trials than the protocol says")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  command->add_option("--duration", arguments->duration_s, "seconds of each trial, instead of the protocol's")
      ->check(CLI::Range(1.0, 1e5))
      ->type_name("S");
  command
      ->add_option("--threads", arguments->threads, "trials side by side; never changes a result [one for each core]")
      ->check(CLI::Range(1U, 1024U))
      ->type_name("N");
  command->add_option("--report", arguments->report_path, "write a self-contained HTML report")->type_name("FILE");
  command
      ->add_option("--recorded", arguments->recorded_path,
                   "with `step`: a real head's run beside it, a CSV of t_s, laser_x_m, laser_z_m, left_x_m, left_z_m, "
                   "right_x_m, right_z_m")
      ->type_name("FILE");
  command->add_flag("--tune-pid", arguments->tunes_pid,
                    "instead: search the protocol's grid for the best PID servo, on the tuning seeds");
  command->footer(
      "Examples:\n"
      "  tectum eval circuits/oculomotor.json                                  the paper's protocol: about ten "
      "minutes\n"
      "  tectum eval circuits/oculomotor.json --trials 2 --duration 30         the same, short\n"
      "  tectum eval circuits/oculomotor.json circuits/balachandar2020.json circuits/polykretis2022.json   side by "
      "side\n"
      "  tectum eval circuits/oculomotor.json --protocol step --lesion IFN\n"
      "  tectum eval circuits/oculomotor.json --protocol step --recorded head.csv   a real head in the same table\n"
      "  tectum eval circuits/oculomotor.json --protocol saccades --report out/saccades.html\n"
      "  tectum eval circuits/oculomotor.json --protocol clinic --report out/clinic.html\n"
      "  tectum eval circuits/oculomotor.json --protocol robustness            noise, lost frames, lost neurons\n"
      "  tectum eval circuits/oculomotor.json --protocol paper --tune-pid      how the PID servo's gains were found\n");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace tectum
