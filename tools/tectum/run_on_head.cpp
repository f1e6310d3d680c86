#include "tools/tectum/run_on_head.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/analysis/run_summary.h"
#include "tools/live/live_run.h"
#include "tools/tectum/keyboard.h"
#include "tools/tectum/live_view.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

constexpr int kLoopPriority = 40;  // above everything of a desktop, below the kernel's own interrupt threads at 50

LiveControls* signalled = nullptr;  // of the run in progress

void on_signal(int number) {
  LiveControls* const controls = signalled;
  if (controls == nullptr) {
    return;
  }
  if (number == SIGUSR1) {
    controls->request = GuardRequest::Stop;
  } else if (controls->ends.exchange(true)) {
    controls->ends_at_once = true;  // the second time
  }
}

/// While it lives, Ctrl-C and SIGTERM end the run gently and the second time at once; SIGUSR1 is the emergency stop.
class SignalsTo {
 public:
  explicit SignalsTo(LiveControls& controls) {
    signalled = &controls;
    for (std::size_t i = 0; i < kNumbers.size(); ++i) {
      before_[i] = signal(kNumbers[i], on_signal);
    }
  }
  SignalsTo(const SignalsTo&) = delete;
  SignalsTo& operator=(const SignalsTo&) = delete;
  ~SignalsTo() {
    for (std::size_t i = 0; i < kNumbers.size(); ++i) {
      signal(kNumbers[i], before_[i]);
    }
    signalled = nullptr;
  }

 private:
  static constexpr std::array<int, 3> kNumbers = {SIGINT, SIGTERM, SIGUSR1};
  std::array<void (*)(int), 3> before_{};
};

void obey_key(char key, LiveControls& controls) {
  switch (key) {
    case ' ':
      controls.request = GuardRequest::Stop;
      break;
    case 'p':
      controls.request = GuardRequest::Park;
      break;
    case 'r':
      controls.request = GuardRequest::Release;
      break;
    case 'q':
      controls.ends = true;
      break;
    default:
      break;
  }
}

std::string comparison_text(const RunSummary& real, const RunSummary& virtual_time) {
  std::string text =
      fmt::format("{:<18} {:>14} {:>14} {:>12}\n", "RMSE (deg)", "real time", "virtual time", "difference");
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    const EyeMetrics& a = real.tracking.eye[e];
    const EyeMetrics& b = virtual_time.tracking.eye[e];
    for (const auto& [axis, here, there] : {std::tuple{"horizontal", a.pan.all.rmse_deg, b.pan.all.rmse_deg},
                                            std::tuple{"vertical", a.tilt.all.rmse_deg, b.tilt.all.rmse_deg}}) {
      text += fmt::format("{:<18} {:>14.2f} {:>14.2f} {:>+10.1f} %\n",
                          fmt::format("{} {}", e == 0 ? "left" : "right", axis), here, there,
                          there > 0 ? 100 * (here / there - 1) : 0.0);
    }
  }
  return text;
}

nlohmann::ordered_json comparison_json(const RunSummary& real, const RunSummary& virtual_time) {
  nlohmann::ordered_json json;
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    const EyeMetrics& a = real.tracking.eye[e];
    const EyeMetrics& b = virtual_time.tracking.eye[e];
    json[e == 0 ? "left" : "right"] = {
        {"horizontal", {{"real_time", a.pan.all.rmse_deg}, {"virtual_time", b.pan.all.rmse_deg}}},
        {"vertical", {{"real_time", a.tilt.all.rmse_deg}, {"virtual_time", b.tilt.all.rmse_deg}}}};
  }
  return json;
}

std::optional<HeadFile> read_head(const std::string& path, CommandContext& context) {
  ReadHead read = read_head_file(path);
  if (!read.error.empty()) {
    context.err << fmt::format("tectum: {}\n", read.error);
  }
  context.err << read.problems;
  if (!read.head) {
    context.exit_status = read.error.empty() ? kExitFailed : kExitTrouble;
  }
  return std::move(read.head);
}

}  // namespace

void add_head_arguments(CLI::App& command, HeadArguments& arguments) {
  CLI::Option* const head = command
                                .add_option("--head", arguments.path,
                                            "run in real time on the head that this file describes: a real one, or "
                                            "circuits/heads/emulated.json")
                                ->type_name("FILE");
  command
      .add_flag("--realtime", arguments.is_real_time,
                "with --head: real-time priority and locked memory, where the system permits them")
      ->needs(head);
  command.add_option("--core", arguments.core, "with --head: keep the loop on this processor core")
      ->check(CLI::Range(0, 1023))
      ->type_name("N")
      ->needs(head);
  command
      .add_flag("--view{auto}", arguments.view,
                "with --head: show eyes, spikes, joints and timing in a window, or in the terminal where there is no "
                "display; --view=text, --view=window, or --view=FILE.png to keep the newest view in a picture")
      ->type_name("")
      ->needs(head);
}

std::optional<Recording> run_on_head(const SpikeImage& image, const HeadRunRequest& request, CommandContext& context,
                                     HeadFigures& figures) {
  const std::optional<HeadFile> file = read_head(request.head.path, context);
  if (!file) {
    return std::nullopt;
  }
  std::string error;
  const std::unique_ptr<LiveView> view = LiveView::make(request.head.view, image, context.err, error);
  if (view == nullptr) {
    context.err << fmt::format("tectum run: {}\n", error);
    context.exit_status = kExitTrouble;
    return std::nullopt;
  }
  SimHeadParams simulation = request.simulation.head;
  simulation.geometry = file->geometry;
  const std::unique_ptr<LiveHead> head =
      LiveHead::open(*file, simulation, request.head.is_real_time ? kLoopPriority : 0, error);
  if (head == nullptr) {
    context.err << fmt::format("tectum: {}\n", error);
    context.exit_status = kExitTrouble;
    return std::nullopt;
  }
  LiveRunOptions options;
  options.duration_s = request.duration_s;
  options.frame_period_ns = simulation.frame_period_ns;
  options.record_path = request.record_path;
  options.scenario = head->emulated() != nullptr ? scenario_name(simulation.scenario.kind) : "head";
  options.seed = simulation.seed;
  options.learns = request.simulation.learns;
  options.guard.neutral_deg = file->neutral_deg;
  options.real_time.fifo_priority = request.head.is_real_time ? kLoopPriority : 0;
  options.real_time.locks_memory = request.head.is_real_time;
  options.real_time.core = request.head.core;

  LiveControls controls;
  const SignalsTo signals(controls);
  Keyboard keyboard;
  if (keyboard.is_there()) {
    context.err
        << "keys: space stops the head where it is, p parks it, r takes its torque, q ends; Ctrl-C twice ends at "
           "once\n";
  }
  Progress progress(context.err, fmt::format("{} on {}", image.name(image.header.circuit_name), file->name));
  LiveRun run = run_live(
      image, *head, options, controls,
      [&](const LiveGlimpse& glimpse) {
        for (char key = keyboard.next(); key != 0; key = keyboard.next()) {
          obey_key(key, controls);
        }
        obey_key(view->show(glimpse), controls);
        if (!view->owns_terminal() && request.duration_s > 0) {
          progress.update(std::min(1.0, glimpse.time_s / request.duration_s));
        }
      },
      [&](const LiveEvent& event) {
        view->add_line(event.text);
        if (!view->owns_terminal()) {
          context.err << fmt::format("\r{}\n", event.text);
        }
      });
  if (!run.error.empty()) {
    context.err << fmt::format("tectum: {}\n", run.error);
    context.exit_status = kExitTrouble;
    if (run.recording.frames.empty()) {
      return std::nullopt;
    }
  }
  figures.learned_scales = std::move(run.learned_scales);
  figures.text = live_figures_text(run);
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(live_figures_json(run));
  if (head->emulated() != nullptr && !run.recording.frames.empty()) {
    SimulatedRunOptions same = request.simulation;
    same.head = simulation;
    same.duration_s = run.recording.duration_s;
    const RunSummary real = summarize_run(run.recording);
    const RunSummary virtual_time = summarize_run(run_simulated_head(image, same));
    figures.text += "\n" + comparison_text(real, virtual_time);
    json["rmse_deg"] = comparison_json(real, virtual_time);
  }
  figures.json = json.dump();
  return std::move(run.recording);
}

}  // namespace tectum
