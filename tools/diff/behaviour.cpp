#include "tools/diff/behaviour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/analysis/statistics.h"
#include "tools/diff/open_loop_run.h"
#include "tools/evaluate/parallel_jobs.h"

namespace tectum {
namespace {

double standard_deviation(const std::vector<double>& sample) {
  if (sample.size() < 2) {
    return 0;
  }
  const double middle = mean(sample);
  double squares = 0;
  for (const double value : sample) {
    squares += (value - middle) * (value - middle);
  }
  return std::sqrt(squares / static_cast<double>(sample.size() - 1));
}

struct SeedRun {
  Battery battery;
  Recording a, b;
  std::vector<PairedFigure> kinematics;  // of this seed alone
  bool is_same = false;

  [[nodiscard]] RecordingPair pair() const { return {a, b, battery.parts.empty() ? parts_of(a) : battery.parts}; }
};

/// What is cheap to compare comes first: two circuits that differ seldom make as many spikes.
bool is_same_run(const SeedRun& run, const std::vector<std::uint32_t>& in_b) {
  const auto same_command = [](const RecordedFrame& x, const RecordedFrame& y) {
    return x.decoded_deg == y.decoded_deg && x.goal_deg == y.goal_deg;
  };
  if (run.a.tick_ns != run.b.tick_ns || run.a.spikes.size() != run.b.spikes.size() ||
      !std::equal(run.a.frames.begin(), run.a.frames.end(), run.b.frames.begin(), run.b.frames.end(), same_command)) {
    return false;
  }
  std::vector<RecordedSpike> mapped;
  mapped.reserve(run.a.spikes.size());
  for (const RecordedSpike& spike : run.a.spikes) {
    if (in_b[spike.neuron] == kNoMatch) {
      return false;
    }
    mapped.push_back({spike.tick, in_b[spike.neuron]});
  }
  std::sort(mapped.begin(), mapped.end(), [](const RecordedSpike& x, const RecordedSpike& y) {
    return x.tick != y.tick ? x.tick < y.tick : x.neuron < y.neuron;
  });
  return mapped == run.b.spikes;
}

void append_seed(const std::vector<PairedFigure>& seed, std::vector<PairedFigure>& figures) {
  figures.resize(seed.size());
  for (std::size_t k = 0; k < seed.size(); ++k) {
    figures[k].name = seed[k].name;
    figures[k].unit = seed[k].unit;
    figures[k].a.insert(figures[k].a.end(), seed[k].a.begin(), seed[k].a.end());
    figures[k].b.insert(figures[k].b.end(), seed[k].b.begin(), seed[k].b.end());
  }
}

class BehaviourComparison {
 public:
  BehaviourComparison(const CircuitView& a, const CircuitView& b, const StructureDiff& structure,
                      const BehaviourOptions& options)
      : a_(a), b_(b), structure_(structure), options_(options), tap_(a.image, b.image), runs_(options.seeds) {}

  Behaviour run() {
    run_batteries();
    Behaviour behaviour;
    const std::uint64_t first_seed = options_.plan.first_seed;
    behaviour.what =
        fmt::format("{}, {:.3g} s, {}", options_.plan.what, runs_[0].battery.duration_s,
                    runs_.size() == 1 ? fmt::format("seed {}", first_seed)
                                      : fmt::format("seeds {} to {}", first_seed, first_seed + runs_.size() - 1));
    behaviour.divergence = compare_runs();
    std::vector<RecordingPair> pairs;
    for (const SeedRun& seed : runs_) {
      pairs.push_back(seed.pair());
      append_seed(seed.kinematics, behaviour.kinematics);
    }
    behaviour.populations = compare_spikes(pairs, structure_.match.population_of_b, options_.threads);
    behaviour.is_same = std::all_of(runs_.begin(), runs_.end(), [](const SeedRun& seed) { return seed.is_same; });
    behaviour.first_parts = runs_[0].pair().parts;
    behaviour.first_a = std::move(runs_[0].a);
    behaviour.first_b = std::move(runs_[0].b);
    return behaviour;
  }

 private:
  void run_batteries() {
    const SpikeImage& fitted = a_.image.retinas.empty() ? b_.image : a_.image;
    std::vector<Job> jobs;
    for (std::size_t s = 0; s < runs_.size(); ++s) {
      runs_[s].battery = make_battery(options_.plan, options_.plan.first_seed + s);
      for (const bool is_a : {true, false}) {
        jobs.push_back([this, s, is_a, &fitted](const std::function<void(double)>& progress) {
          const SimulatedRunOptions options = battery_options(fitted, runs_[s].battery);
          RunObserver observer{.progress = progress, .pictures = {}};
          std::size_t frame = 0;
          if (is_a && s == 0 && tap_.needs_pictures()) {
            observer.pictures = [&](const Frame& left, const Frame& right) { tap_.see(frame, left, right); };
            observer.progress = [&](double done) {
              ++frame;  // called once a frame, after its pictures
              progress(done);
            };
          }
          (is_a ? runs_[s].a : runs_[s].b) = run_simulated_head(is_a ? a_.image : b_.image, options, observer);
        });
      }
    }
    run_jobs(jobs, options_.threads, options_.progress);
  }

  /// Each seed's pair of runs, and the first seed's once more on one input: the divergence.
  Divergence compare_runs() {
    Divergence divergence;
    std::vector<std::uint32_t> in_b(a_.image.header.neuron_count);
    for (std::uint32_t neuron = 0; neuron < in_b.size(); ++neuron) {
      in_b[neuron] = counterpart(a_, b_, structure_.match, neuron);
    }
    std::vector<Job> jobs = {[&](const auto&) {  // the longest first
      const LitNeurons lit_b = tap_.lit_neurons(runs_[0].a);
      OpenLoopRun driven(b_.image, runs_[0].a, lit_b);
      divergence = find_divergence(
          {a_, b_, structure_, runs_[0].a, driven.recording(), [&](std::size_t frame) { driven.run_frame(frame); }});
    }};
    for (SeedRun& seed : runs_) {
      jobs.emplace_back([&](const auto&) {
        add_kinematics(seed.pair(), seed.kinematics);
        seed.is_same = is_same_run(seed, in_b);
      });
    }
    run_jobs(jobs, options_.threads, {});
    return divergence;
  }

  const CircuitView& a_;
  const CircuitView& b_;
  const StructureDiff& structure_;
  const BehaviourOptions& options_;
  PictureTap tap_;
  std::vector<SeedRun> runs_;
};

}  // namespace

double PairedFigure::mean_a() const { return mean(a); }
double PairedFigure::mean_b() const { return mean(b); }
double PairedFigure::spread() const {
  std::vector<double> differences;
  for (std::size_t s = 0; s < a.size(); ++s) {
    differences.push_back(b[s] - a[s]);
  }
  return standard_deviation(differences);
}
std::optional<bool> PairedFigure::exceeds_spread() const {
  if (a.size() < 2) {
    return std::nullopt;
  }
  bool is_up = true, is_down = true;
  for (std::size_t s = 0; s < a.size(); ++s) {
    is_up = is_up && b[s] > a[s];
    is_down = is_down && b[s] < a[s];
  }
  return (is_up || is_down) && std::abs(difference()) > spread();
}

void add_kinematics(const RecordingPair& pair, std::vector<PairedFigure>& figures) {
  const std::vector<KinematicFigure> x = kinematics(pair.a, pair.parts), y = kinematics(pair.b, pair.parts);
  figures.resize(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    figures[k].name = x[k].name;
    figures[k].unit = x[k].unit;
    if (x[k].value && y[k].value) {
      figures[k].a.push_back(*x[k].value);
      figures[k].b.push_back(*y[k].value);
    }
  }
}

Behaviour compare_behaviour(const CircuitView& a, const CircuitView& b, const StructureDiff& structure,
                            const BehaviourOptions& options) {
  return BehaviourComparison(a, b, structure, options).run();
}

}  // namespace tectum
