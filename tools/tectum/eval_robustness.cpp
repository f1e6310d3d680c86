#include "tools/tectum/eval_robustness.h"

#include <fmt/format.h>

#include <mutex>

#include "compiler/source/source_file.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

/// Populations that a disturbance takes neurons from: retinas, or all others.
std::vector<std::string> concerned(const Circuit& circuit, Disturbance disturbance) {
  std::vector<std::string> names;
  for (const Instance& instance : circuit.instances) {
    if (instance.retina.has_value() == (disturbance == Disturbance::DeadFields)) {
      names.push_back(instance.name);
    }
  }
  return names;
}

}  // namespace

std::optional<MeasuredProtocol> eval_robustness(const CircuitArguments& circuit, const Protocol& protocol,
                                                const std::string& protocol_path, unsigned threads,
                                                CommandContext& context) {
  if (is_image_file(circuit.path)) {
    context.err << fmt::format("tectum: {} is an image, and neurons are lost by name: give the circuit file\n",
                               circuit.path);
    context.exit_status = kExitUsage;
    return std::nullopt;
  }
  const ReadRobustness read = read_robustness_text(protocol_path, read_source(protocol_path).file.bytes);
  context.err << read.problems;
  if (!read.plan) {
    context.exit_status = kExitFailed;
    return std::nullopt;
  }
  const std::optional<Compilation> compilation = compile_file(circuit, compile_options(circuit), context);
  if (!compilation) {
    return std::nullopt;
  }
  if (!compilation->result.image) {
    print_diagnostics(*compilation, context);
    return std::nullopt;
  }
  const std::optional<SpikeImage> image = load_circuit(circuit, context, WarningPolicy::Quiet);
  if (!image) {
    return std::nullopt;
  }
  std::mutex compiling;  // it prints
  const LesionedImage lesioned = [&](Disturbance disturbance, double share, std::uint64_t seed) {
    CircuitArguments worse = circuit;
    worse.circuit_seed = seed;
    for (const std::string& name : concerned(*compilation->result.circuit, disturbance)) {
      worse.lesions.push_back(fmt::format("{}:{}", name, share));
    }
    const std::lock_guard<std::mutex> lock(compiling);
    return load_circuit(worse, context, WarningPolicy::Quiet);
  };
  Progress progress(context.err, "evaluating " + protocol.name);
  const std::optional<RobustnessResult> result =
      evaluate_robustness(*image, protocol, *read.plan, lesioned, threads, [&](double done) { progress.update(done); });
  return result ? std::optional(robustness_tables(*result)) : std::nullopt;
}

}  // namespace tectum
