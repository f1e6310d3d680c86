#include "tools/sweep/sweep.h"

#include <fmt/format.h>

#include <atomic>
#include <cstring>
#include <map>
#include <mutex>
#include <set>

#include "compiler/diagnostics/render.h"
#include "runtime/image/load_image.h"
#include "runtime/image/philox.h"
#include "tools/evaluate/parallel_jobs.h"
#include "tools/evaluate/tracking_evaluation.h"
#include "tools/sweep/row_file.h"

namespace tectum {
namespace {

struct CompiledPoint {
  std::vector<std::byte> bytes;
  std::string problems;  // why there are none
};

CompiledPoint compile_point(const SweepPlan& plan, const SourceFile& source,
                            const std::vector<std::string>& parameters) {
  CompileOptions options = plan.compile;
  options.parameters.insert(options.parameters.end(), parameters.begin(), parameters.end());
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit(source, options, diagnostics);
  if (!result.image) {
    return {{}, render_text(diagnostics, result.sources)};
  }
  return {write_image(*result.image), ""};
}

std::uint64_t seed_of(const SweepPlan& plan, const SweepPoint& point) {
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    if (plan.axes[a].name == kSeedAxis) {
      return std::stoull(plan.axes[a].values[point[a]]);
    }
  }
  return plan.protocol.first_seed;
}

// Structured bindings name every field, so that a new one does not compile until it is said here whether a run reads
// it.

std::string target_text(const ScenarioParams& target) {
  // The seed is the point's, the wall the protocol's, the random target's hold the setting's: trial_options().
  const auto& [kind, seed, wall_distance_m, hold_at_m, extent_m, step_hold_s, circle_period_s, chirp_first_period_s,
               chirp_ratio, chirp_shortest_period_s, random_hold_s, random_pan_deg, random_tilt_deg, random_jump_deg,
               path] = target;
  std::string text = fmt::format("{} {} {} {}", static_cast<int>(kind), seed, wall_distance_m, random_hold_s);
  for (const double value : {hold_at_m[0], hold_at_m[1], extent_m, step_hold_s, circle_period_s, chirp_first_period_s,
                             chirp_ratio, chirp_shortest_period_s, random_pan_deg, random_tilt_deg, random_jump_deg}) {
    text += fmt::format(" {}", value);
  }
  for (const PathPoint& point : path) {
    const auto& [time_s, at_m, distance_m] = point;
    text += fmt::format(" {} {} {} {}", time_s, at_m[0], at_m[1], distance_m);
  }
  return text;
}

std::string protocol_text(const Protocol& protocol) {
  // Not part of a row: names and other people's numbers, the PID servo beside the circuit, how many trials and from
  // which seed (a sweep has its own), which of the holds and latencies (the setting has it), training, and the sizes of
  // the protocols that no sweep runs.
  const auto& [name, about, kind, scenario, movement, wall_distance_m, servo_speed_deg_s, frame_rate_hz, trials,
               duration_s, first_seed, hold_s, camera_latency_frames, pid, tuning, learning, published_by, published] =
      protocol;
  const Setting setting = settings_of(protocol).front();
  return fmt::format("{} {} {} {} {} {} {} [{}]", static_cast<int>(kind), wall_distance_m, servo_speed_deg_s,
                     frame_rate_hz, duration_s, setting.hold_s, setting.camera_latency_frames, target_text(scenario));
}

/// Raised when a measure or the simulated head changes what it computes, so that rows of before are not taken for it.
constexpr int kRowVersion = 1;

/// Of all that a row depends on.
std::string digest_of(const SweepPlan& plan, const std::vector<std::byte>& image, std::uint64_t seed) {
  std::string all = fmt::format("{} {} {} ", kRowVersion, seed, protocol_text(plan.protocol));
  const std::size_t before = all.size();
  all.resize(before + image.size());
  std::memcpy(all.data() + before, image.data(), image.size());
  // Two hashes, the second of another text: 128 bits, so that no two of 100 000 runs share a name.
  return fmt::format("{:016x}{:016x}", name_hash(all), name_hash("2 " + all));
}

SweepRow row_of(const TrialResult& trial) {
  const auto average = [&](const auto& pick) {
    double sum = 0;
    for (std::size_t c = 0; c < kChannels; ++c) {
      sum += pick(channel_of(trial.metrics, c)) / static_cast<double>(kChannels);
    }
    return sum;
  };
  const bool has_steps = trial.steps.steps > 0;
  const auto of_steps = [&](double value) { return has_steps ? std::optional(value) : std::nullopt; };
  return {average([](const AxisMetrics& a) { return a.all.rmse_deg; }),
          average([](const AxisMetrics& a) { return a.settled.rmse_deg; }),
          average([](const AxisMetrics& a) { return a.all.median_abs_deg; }),
          average([](const AxisMetrics& a) { return a.all.p90_abs_deg; }),
          average([](const AxisMetrics& a) { return a.all.fovea_share; }),
          has_steps ? std::optional(average([](const AxisMetrics& a) { return a.jitter_deg; })) : std::nullopt,
          of_steps(1000 * trial.steps.median_latency_s),
          of_steps(100 * trial.steps.median_overshoot_share),
          of_steps(1000 * trial.steps.median_settled_s),
          trial.metrics.neck_pan_travel_deg + trial.metrics.neck_tilt_travel_deg};
}

class SweepRun {
 public:
  SweepRun(const SweepPlan& plan, SourceFile source, SweepProgress progress)
      : plan_(plan), source_(std::move(source)), progress_(std::move(progress)) {
    result_.points = points_of(plan.axes);
    result_.rows.resize(result_.points.size());
    digests_.resize(result_.points.size());
  }

  SweepResult check() {
    find_digests();
    return std::move(result_);
  }

  SweepResult run() {
    find_digests();
    if (!result_.circuit_problems.empty()) {
      return std::move(result_);
    }
    run_missing();
    for (std::size_t k = 0; k < result_.points.size() && result_.error.empty(); ++k) {
      const std::optional<SweepRow> row = read_row(plan_.folder, digests_[k]);
      if (row) {
        result_.rows[k] = *row;
      } else {
        result_.error = fmt::format("{}: vanished while the sweep ran", row_path(plan_.folder, digests_[k]));
      }
    }
    return std::move(result_);
  }

 private:
  /// Compiles every set of parameters once; seeds share it. The first set that the circuit refuses ends the sweep.
  void find_digests() {
    std::map<std::vector<std::string>, std::vector<std::size_t>> points_with;
    for (std::size_t k = 0; k < result_.points.size(); ++k) {
      points_with[parameters_of(plan_.axes, result_.points[k])].push_back(k);
    }
    std::map<std::size_t, std::string> problems;  // by the first point that has it
    std::mutex guard;
    std::vector<Job> jobs;
    for (const auto& [parameters, points] : points_with) {
      jobs.emplace_back([&, &set = parameters, &members = points](const std::function<void(double)>&) {
        const CompiledPoint compiled = compile_point(plan_, source_, set);
        if (!compiled.problems.empty()) {
          const std::lock_guard lock(guard);
          problems[members.front()] = compiled.problems;
          return;
        }
        for (const std::size_t k : members) {
          digests_[k] = digest_of(plan_, compiled.bytes, seed_of(plan_, result_.points[k]));
        }
      });
    }
    run_jobs(jobs, plan_.threads, [](double) {});
    result_.circuit_problems = problems.empty() ? "" : problems.begin()->second;
  }

  void run_missing() {
    std::set<std::string> seen;
    std::vector<std::size_t> missing;
    for (std::size_t k = 0; k < result_.points.size(); ++k) {
      if (seen.insert(digests_[k]).second && !read_row(plan_.folder, digests_[k])) {
        missing.push_back(k);
      }
    }
    result_.distinct = seen.size();
    result_.runs = missing.size();
    std::atomic<std::size_t> ready{seen.size() - missing.size()};
    const std::size_t kept = ready;
    std::mutex guard;
    std::vector<Job> jobs;
    for (const std::size_t k : missing) {
      jobs.emplace_back([&, k](const std::function<void(double)>& report) {
        const std::string error = run_point(k, report);
        ++ready;
        if (!error.empty()) {
          const std::lock_guard lock(guard);
          result_.error = error;
        }
      });
    }
    run_jobs(jobs, plan_.threads, [&](double done) {
      const auto all = static_cast<double>(seen.size());
      progress_((static_cast<double>(kept) + done * static_cast<double>(missing.size())) / all, ready, seen.size());
    });
  }

  std::string run_point(std::size_t k, const std::function<void(double)>& report) {
    {
      const std::lock_guard lock(failed_guard_);
      if (has_failed_) {
        return "";  // a full disk: the rest need not be run for nothing
      }
    }
    const SweepPoint& point = result_.points[k];
    const CompiledPoint compiled = compile_point(plan_, source_, parameters_of(plan_.axes, point));
    LoadedImage loaded = load_image(compiled.bytes);
    std::string error = loaded.error;
    if (loaded.image) {
      const Setting setting = settings_of(plan_.protocol).front();
      const TrialResult trial =
          run_circuit_trial(*loaded.image, plan_.protocol, setting, seed_of(plan_, point), report);
      error = write_row(plan_.folder, digests_[k], row_of(trial));
    }
    const std::lock_guard lock(failed_guard_);
    has_failed_ = has_failed_ || !error.empty();
    return error;
  }

  const SweepPlan& plan_;
  const SourceFile source_;
  const SweepProgress progress_;
  SweepResult result_;
  std::vector<std::string> digests_;
  std::mutex failed_guard_;
  bool has_failed_ = false;
};

}  // namespace

std::vector<std::string> parameters_of(const std::vector<SweepAxis>& axes, const SweepPoint& point) {
  std::vector<std::string> parameters;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (axes[a].name != kSeedAxis) {
      parameters.push_back(axes[a].name + "=" + axes[a].values[point[a]]);
    }
  }
  return parameters;
}

SweepResult check_sweep(const SweepPlan& plan) {
  SweepResult failed;
  ReadSource source = read_source(plan.circuit_path);
  if (!source.ok) {
    failed.error = source.error;
    return failed;
  }
  return SweepRun(plan, std::move(source.file), {}).check();
}

SweepResult run_sweep(const SweepPlan& plan, const SweepProgress& progress) {
  SweepResult failed;
  ReadSource source = read_source(plan.circuit_path);
  if (!source.ok) {
    failed.error = source.error;
    return failed;
  }
  failed.error = make_row_folder(plan.folder);
  if (!failed.error.empty()) {
    return failed;
  }
  return SweepRun(plan, std::move(source.file), progress).run();
}

}  // namespace tectum
