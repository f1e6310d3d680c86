// tectum run: a circuit on the simulated head, or on recorded video.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>

#include "drivers/camera/video_writer.h"
#include "runtime/record/recording_file.h"
#include "tools/analysis/simulated_world.h"
#include "tools/analysis/video_run.h"
#include "tools/report/run_report.h"
#include "tools/report/run_text.h"
#include "tools/tectum/learned_overlay.h"
#include "tools/tectum/load_circuit.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/run_on_head.h"
#include "tools/tectum/tectum_main.h"
#include "tools/tectum/video_text.h"

namespace tectum {
namespace {

struct RunArguments {
  CircuitArguments circuit;
  SimulatedWorld world;
  std::vector<std::string> video;
  double duration_s = 0;     // 0: the world's, or to the video's end
  double frame_rate_hz = 0;  // 0: the world's, or the video's own
  std::vector<double> to_deg;
  double sample_rate_hz = 0;
  std::size_t lines = 40;
  std::string record_folder, report_path, picture_path, render_path, weights_path;
  bool learns = false;
  HeadArguments head;
};

void add_world_options(CLI::App& command, RunArguments& arguments) {
  SimulatedWorld& world = arguments.world;
  command
      .add_option("--scenario", world.scenario, "what the laser dot does: hold, step, circle, chirp, random or jump")
      ->check(CLI::IsMember(world_scenarios()))
      ->capture_default_str();
  command
      .add_option("--to", arguments.to_deg,
                  "where --scenario hold rests, or where jump goes to and comes back from: degrees right and up")
      ->expected(2)
      ->check(CLI::Range(-60.0, 60.0))
      ->type_name("PAN TILT");
  command
      .add_option("--video", arguments.video, "run on recorded video instead: one file for both eyes, or left right")
      ->expected(1, 2)
      ->type_name("FILE");
  command.add_option("--duration", arguments.duration_s, "seconds to run [60; for video: to its end]")
      ->check(CLI::Range(0.02, 1e6))
      ->type_name("S");
  command.add_option("--seed", world.seed, "of the simulated world: target, servos, camera noise")
      ->capture_default_str();
  command.add_option("--frame-rate", arguments.frame_rate_hz, "frames a second [45; for video: the file's own]")
      ->check(CLI::Range(1.0, 1000.0))
      ->type_name("HZ");
  command.add_option("--camera-latency", world.camera_latency_frames, "frames from exposure to the loop")
      ->check(CLI::Range(0U, 15U))
      ->capture_default_str()
      ->type_name("FRAMES");
  command.add_option("--hold", world.hold_s, "seconds between the jumps of --scenario random and jump")
      ->check(CLI::Range(0.05, 1000.0))
      ->capture_default_str()
      ->type_name("S");
  command.add_option("--resolution", world.resolution_px, "of each simulated camera, square")
      ->check(CLI::Range(32, 2160))
      ->capture_default_str()
      ->type_name("PX");
  command.add_option("--noise", world.noise, "of the simulated cameras, standard deviation in grey levels of 255")
      ->check(CLI::Range(0.0, 64.0))
      ->type_name("SIGMA");
  command.add_flag("--clutter", world.clutter, "hang a textured wall with a bright window and coloured boxes");
  command.add_option("--dot", world.dot, "the laser's colour: red, green or blue [the one that the retina looks for]")
      ->check(CLI::IsMember({"red", "green", "blue"}));
}

void add_output_options(CLI::App& command, RunArguments& arguments) {
  command.add_option("--record", arguments.record_folder, "write run.trec into this folder")->type_name("DIR");
  command
      .add_option("--sample-rate", arguments.sample_rate_hz,
                  "with --record: also note the simulated joints this often, for the speed of saccades [not between "
                  "frames]")
      ->check(CLI::Range(1.0, 10000.0))
      ->type_name("HZ");
  command.add_option("--report", arguments.report_path, "write a self-contained HTML report")->type_name("FILE");
  command.add_option("--picture", arguments.picture_path, "write one summary figure as SVG")->type_name("FILE");
  command.add_option("--render", arguments.render_path, "write what the simulated cameras see as video")
      ->type_name("FILE");
  command.add_flag("--learn", arguments.learns, "let weights change while it runs, where the circuit has `plasticity`");
  command
      .add_option("--save-weights", arguments.weights_path,
                  "with --learn: write what was learned as a small circuit file that extends this one")
      ->type_name("FILE");
  command.add_option("--lines", arguments.lines, "most lines to print of a video run; 0 prints every frame")
      ->capture_default_str()
      ->type_name("N");
  command.footer(
      "Examples:\n"
      "  tectum run circuits/oculomotor.json                               a minute of random targets\n"
      "  tectum run circuits/oculomotor.json --scenario step --duration 32 --report out/step.html\n"
      "  tectum run circuits/oculomotor.json --video left.avi right.avi --record out/recording\n"
      "  tectum run circuits/oculomotor.json --head circuits/heads/emulated.json     in real time, over a serial port\n"
      "  tectum run circuits/oculomotor.json --noise 8 --clutter --render out/eyes.mp4\n"
      "  tectum run circuits/oculomotor_learning.json --learn --save-weights out/learned.json     then: tectum run "
      "out/learned.json\n"
      "  tectum run circuits/oculomotor.json --lesion OPN --format json    what is lost without the omnipause "
      "neurons\n");
}

SimulatedRunOptions simulation_of(const SpikeImage& image, const RunArguments& arguments) {
  SimulatedWorld world = arguments.world;
  world.duration_s = arguments.duration_s > 0 ? arguments.duration_s : world.duration_s;
  world.frame_rate_hz = arguments.frame_rate_hz > 0 ? arguments.frame_rate_hz : world.frame_rate_hz;
  if (arguments.to_deg.size() == 2) {
    world.to_deg = {arguments.to_deg[0], arguments.to_deg[1]};
  }
  SimulatedRunOptions options = world_options(image, world);
  options.sample_rate_hz = arguments.sample_rate_hz;
  options.learns = arguments.learns;
  return options;
}

bool write_text(const std::string& path, const std::string& text, CommandContext& context) {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) {
    std::filesystem::create_directories(parent, error);
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

/// Opens on the first frame, whose size it takes.
class RenderedVideo {
 public:
  RenderedVideo(std::string path, double fps) : path_(std::move(path)), fps_(fps) {}

  void add(const Frame& left, const Frame& right) {
    if (!error_.empty()) {
      return;
    }
    if (writer_ == nullptr) {
      std::error_code ignored;
      std::filesystem::create_directories(std::filesystem::path(path_).parent_path(), ignored);
      writer_ = EyeVideoWriter::open(
          {.path = path_, .fps = fps_, .width_px = left.width_px, .height_px = left.height_px}, error_);
    }
    if (writer_ != nullptr) {
      writer_->write(left, right);
    }
  }
  /// One line, or empty.
  [[nodiscard]] std::string finish() {
    if (error_.empty() && writer_ != nullptr && !writer_->close()) {
      error_ = fmt::format("cannot write {}", path_);
    }
    return error_;
  }

 private:
  std::string path_;
  double fps_;
  std::unique_ptr<EyeVideoWriter> writer_;
  std::string error_;
};

using Scales = std::vector<std::int32_t>;

std::optional<Recording> run_head(const SpikeImage& image, const RunArguments& arguments, CommandContext& context,
                                  Scales& learned) {
  const SimulatedRunOptions options = simulation_of(image, arguments);
  Progress progress(context.err, fmt::format("running {}", image.name(image.header.circuit_name)));
  RunObserver observer;
  observer.progress = [&](double done) { progress.update(done); };
  observer.learned = [&](std::span<const std::int32_t> scales) { learned.assign(scales.begin(), scales.end()); };
  std::optional<RenderedVideo> video;
  if (!arguments.render_path.empty()) {
    video.emplace(arguments.render_path, 1e9 / static_cast<double>(options.head.frame_period_ns));
    observer.pictures = [&](const Frame& left, const Frame& right) { video->add(left, right); };
  }
  Recording recording = run_simulated_head(image, options, observer);
  if (video) {
    const std::string error = video->finish();
    if (!error.empty()) {
      context.err << fmt::format("tectum: {}\n", error);
      context.exit_status = kExitTrouble;
      return std::nullopt;
    }
  }
  return recording;
}

std::optional<Recording> run_video(const SpikeImage& image, const RunArguments& arguments, CommandContext& context,
                                   Scales& learned) {
  if (image.retinas.empty()) {
    context.err << fmt::format("tectum: {} has no retina, so there is nothing to show the video to\n",
                               arguments.circuit.path);
    context.exit_status = kExitFailed;
    return std::nullopt;
  }
  Progress progress(context.err, "running on video");
  RunObserver observer;
  observer.progress = [&](double done) { progress.update(done); };
  observer.learned = [&](std::span<const std::int32_t> scales) { learned.assign(scales.begin(), scales.end()); };
  VideoRun run = run_on_video(image,
                              {.files = arguments.video,
                               .frame_rate_hz = arguments.frame_rate_hz,
                               .duration_s = arguments.duration_s,
                               .learns = arguments.learns,
                               .engine = {}},
                              observer);
  if (!run.error.empty()) {
    context.err << fmt::format("tectum: {}\n", run.error);
    context.exit_status = kExitTrouble;
    return std::nullopt;
  }
  return std::move(run.recording);
}

void write_files(const Recording& recording, const RunArguments& arguments, double times_real_time,
                 CommandContext& context) {
  if (!arguments.record_folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(arguments.record_folder, error);
    const bool is_written = !arguments.head.path.empty();  // while it ran
    const std::string path = arguments.record_folder + "/run.trec";
    const std::string problem = is_written ? "" : write_recording(recording, path);
    if (problem.empty()) {
      context.err << fmt::format("recording: {}   (`tectum record export` makes CSV or .npz of it)\n", path);
    } else {
      context.err << fmt::format("tectum: {}\n", problem);
      context.exit_status = kExitTrouble;
    }
  }
  if (!arguments.report_path.empty()) {
    RunReportOptions options;
    options.times_real_time = times_real_time;
    if (write_text(arguments.report_path, run_report_html(recording, options), context)) {
      context.err << fmt::format("report: {}\n", arguments.report_path);
    }
  }
  if (!arguments.picture_path.empty()) {
    (void)write_text(arguments.picture_path, tracking_svg(recording), context);
  }
}

std::optional<Recording> run_real_time(const SpikeImage& image, const RunArguments& arguments, CommandContext& context,
                                       HeadFigures& figures) {
  HeadRunRequest request;
  request.head = arguments.head;
  request.simulation = simulation_of(image, arguments);
  request.duration_s = request.simulation.duration_s;
  if (!arguments.record_folder.empty()) {
    std::error_code ignored;
    std::filesystem::create_directories(arguments.record_folder, ignored);
    request.record_path = arguments.record_folder + "/run.trec";
  }
  return run_on_head(image, request, context, figures);
}

bool can_learn(const SpikeImage& image, const RunArguments& arguments, CommandContext& context) {
  if (!arguments.weights_path.empty() && !arguments.learns) {
    context.err << "tectum: --save-weights writes what --learn has learned, and --learn is not given\n";
    context.exit_status = kExitUsage;
  } else if (!arguments.weights_path.empty() && is_image_file(arguments.circuit.path)) {
    context.err << "tectum: --save-weights extends a circuit file, and this is an image\n";
    context.exit_status = kExitUsage;
  } else if (arguments.learns && image.plasticity.empty()) {
    context.err << fmt::format("tectum: nothing in {} learns: no projection has `plasticity`\n",
                               arguments.circuit.path);
    context.exit_status = kExitFailed;
  } else {
    return true;
  }
  return false;
}

void run(const RunArguments& arguments, CommandContext& context) {
  const bool is_video = !arguments.video.empty();
  if (is_video && !arguments.render_path.empty()) {
    context.err << "tectum: --render writes what the simulated cameras see; it does not go with --video\n";
    context.exit_status = kExitUsage;
    return;
  }
  const bool is_head = !arguments.head.path.empty();
  if (is_head && (is_video || !arguments.render_path.empty())) {
    context.err << "tectum: --head runs on the cameras of the head file; it does not go with --video or --render\n";
    context.exit_status = kExitUsage;
    return;
  }
  const std::optional<SpikeImage> image = load_circuit(arguments.circuit, context, WarningPolicy::Quiet);
  if (!image) {
    return;
  }
  if (!can_learn(*image, arguments, context)) {
    return;
  }
  const auto begin = std::chrono::steady_clock::now();
  HeadFigures figures;
  Scales& learned = figures.learned_scales;
  const std::optional<Recording> recording = is_head    ? run_real_time(*image, arguments, context, figures)
                                             : is_video ? run_video(*image, arguments, context, learned)
                                                        : run_head(*image, arguments, context, learned);
  if (!recording) {
    return;
  }
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double times_real_time = recording->duration_s / wall_s;
  const RunSummary summary = summarize_run(*recording);
  if (arguments.circuit.format == "json") {
    std::string json = run_summary_json(*recording, summary);
    if (is_head) {
      auto with_head = nlohmann::ordered_json::parse(json);
      with_head["head"] = nlohmann::ordered_json::parse(figures.json);
      json = with_head.dump(2);
    }
    context.out << json << '\n';
  } else {
    if (is_video) {
      context.out << video_text(*recording, arguments.lines);
    }
    context.out << run_table_text(summary);
    if (arguments.learns) {
      context.out << '\n' << learned_text(*image, learned);
    }
    if (is_head) {
      context.out << '\n' << figures.text;
    } else {
      context.err << fmt::format("{:.0f} s in {:.2f} s: {:.0f} times real time\n", recording->duration_s, wall_s,
                                 times_real_time);
    }
  }
  write_files(*recording, arguments, times_real_time, context);
  if (!arguments.weights_path.empty() &&
      write_text(arguments.weights_path,
                 learned_overlay(*image, learned, arguments.circuit.path, arguments.weights_path), context)) {
    context.err << fmt::format("weights: {}   (a circuit: `tectum run {}`, `tectum diff {} {}`)\n",
                               arguments.weights_path, arguments.weights_path, arguments.circuit.path,
                               arguments.weights_path);
  }
}

}  // namespace

void add_run_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("run", "run a circuit on the simulated head, on recorded video, or on a head");
  auto arguments = std::make_shared<RunArguments>();
  add_circuit_arguments(*command, arguments->circuit, CircuitKinds::FileOrImage);
  add_world_options(*command, *arguments);
  add_output_options(*command, *arguments);
  add_head_arguments(*command, arguments->head);
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace tectum
