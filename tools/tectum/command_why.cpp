// tectum why: what made a recorded movement or spike.
#include "tools/tectum/command_why.h"

#include <fmt/format.h>

#include <charconv>
#include <memory>

#include "tools/diff/subject.h"
#include "tools/diff/why.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct WhyArguments {
  std::string path;
  std::string joint, neuron;
  std::string at;
  std::string format = "text";
};

void complain(CommandContext& context, const std::string& line) {
  context.err << "tectum why: " << line << '\n';
  context.exit_status = kExitUsage;
}

/// "1.24s", "1.24 s", "1240 ms", "1.24".
std::optional<double> seconds(const std::string& text) {
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(read.ptr, text.data() + text.size());
  unit.erase(0, unit.find_first_not_of(' '));
  if (read.ec != std::errc() || (!unit.empty() && unit != "s" && unit != "ms")) {
    return std::nullopt;
  }
  return unit == "ms" ? value * 1e-3 : value;
}

std::optional<Joint> joint_named(const std::string& name) {
  for (std::uint32_t j = 0; j < kJointCount; ++j) {
    if (name == kJointNames[j]) {
      return static_cast<Joint>(j);
    }
  }
  return std::nullopt;
}

template <typename Why>
void print(const Why& why, const WhyArguments& arguments, CommandContext& context) {
  context.out << (arguments.format == "json" ? why_json(why) + "\n" : why_text(why));
}

void explain_joint(const RecordedCircuit& run, const WhyArguments& arguments, double at_s, CommandContext& context) {
  const std::optional<Joint> joint = joint_named(arguments.joint);
  if (!joint) {
    complain(context, fmt::format("no joint `{}`; there are {}", arguments.joint, fmt::join(kJointNames, ", ")));
    return;
  }
  const std::optional<JointWhy> why = why_joint(run, *joint, at_s);
  if (!why) {
    complain(context, fmt::format("no output of the circuit drives {}", arguments.joint));
    return;
  }
  print(*why, arguments, context);
}

void why(const WhyArguments& arguments, CommandContext& context) {
  const std::optional<double> at_s = seconds(arguments.at);
  if (!at_s) {
    complain(context, fmt::format("`{}` is no time; write it as 1.24s or 1240ms", arguments.at));
    return;
  }
  const DiffSubject subject = load_subject(arguments.path);
  context.err << subject.notice << subject.error;
  if (!subject.error.empty()) {
    context.exit_status = kExitTrouble;
    return;
  }
  if (!subject.recording || !subject.has_circuit) {
    complain(context, subject.recording ? arguments.path + " does not hold its circuit"
                                        : arguments.path + " is no recording; `tectum run --record` makes one");
    return;
  }
  const RecordedCircuit run{*subject.recording, subject.view};
  if (*at_s < 0 || *at_s > subject.recording->duration_s) {
    complain(context, fmt::format("the recording is {:.3g} s long", subject.recording->duration_s));
    return;
  }
  if (!arguments.joint.empty()) {
    explain_joint(run, arguments, *at_s, context);
    return;
  }
  const NamedNeuron named = find_neuron(subject.view, arguments.neuron);
  if (!named.neuron) {
    complain(context, named.error);
    return;
  }
  print(why_neuron(run, *named.neuron, *at_s), arguments, context);
}

}  // namespace

void add_why_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("why", "which spikes made a recorded movement, or a spike");
  auto arguments = std::make_shared<WhyArguments>();
  command->add_option("recording", arguments->path, "run.trec of `tectum run --record`")->required()->type_name("REC");
  auto* what = command->add_option_group("what", "what to explain");
  what->add_option("--joint", arguments->joint, "a joint: left_eye_pan, neck_tilt, ...")->type_name("JOINT");
  what->add_option("--neuron", arguments->neuron, "a neuron: EBN.left[3]")->type_name("NEURON");
  what->require_option(1);
  command->add_option("--at", arguments->at, "when: 1.24s or 1240ms")->required()->type_name("TIME");
  command->add_option("--format", arguments->format, "what to print: text for people, json for programs")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->footer(
      "A joint: what its motoneurons fire, and inwards from there the input that changed most, up to the retina.\n"
      "A neuron: its spike nearest to the time, and what each pathway had added to its potential.\n\n"
      "Examples:\n"
      "  tectum run circuits/oculomotor.json --scenario step --duration 4 --record out/rec\n"
      "  tectum why out/rec/run.trec --joint left_eye_pan --at 0.2s\n"
      "  tectum why out/rec/run.trec --neuron 'EBN.left[3]' --at 0.12s\n");
  command->callback([arguments, &context] { why(*arguments, context); });
}

}  // namespace tectum
