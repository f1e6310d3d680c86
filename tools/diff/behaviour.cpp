#include "tools/diff/behaviour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tools/analysis/statistics.h"
#include "tools/diff/kinematics.h"
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
};

bool is_same_run(const SeedRun& run, const std::vector<std::uint32_t>& in_b) {
  std::vector<RecordedSpike> mapped;
  for (const RecordedSpike& spike : run.a.spikes) {
    if (in_b[spike.neuron] == kNoMatch) {
      return false;
    }
    mapped.push_back({spike.tick, in_b[spike.neuron]});
  }
  std::sort(mapped.begin(), mapped.end(), [](const RecordedSpike& x, const RecordedSpike& y) {
    return x.tick != y.tick ? x.tick < y.tick : x.neuron < y.neuron;
  });
  const auto same_command = [](const RecordedFrame& x, const RecordedFrame& y) {
    return x.decoded_deg == y.decoded_deg && x.goal_deg == y.goal_deg;
  };
  return run.a.tick_ns == run.b.tick_ns && mapped == run.b.spikes &&
         std::equal(run.a.frames.begin(), run.a.frames.end(), run.b.frames.begin(), run.b.frames.end(), same_command);
}

class BehaviourComparison {
 public:
  BehaviourComparison(const CircuitView& a, const CircuitView& b, const StructureDiff& structure,
                      const BehaviourOptions& options)
      : a_(a), b_(b), structure_(structure), options_(options), tap_(a.image, b.image), runs_(options.seeds) {}

  Behaviour run() {
    run_batteries();
    Behaviour behaviour;
    behaviour.what =
        fmt::format("fixation, steps in eight directions and a pursuit ramp, {:.2g} s, {}", runs_[0].battery.duration_s,
                    runs_.size() == 1 ? "seed 1" : fmt::format("seeds 1 to {}", runs_.size()));
    std::vector<std::uint32_t> in_b(a_.image.header.neuron_count);
    for (std::uint32_t neuron = 0; neuron < in_b.size(); ++neuron) {
      in_b[neuron] = counterpart(a_, b_, structure_.match, neuron);
    }
    behaviour.is_same =
        std::all_of(runs_.begin(), runs_.end(), [&](const SeedRun& seed) { return is_same_run(seed, in_b); });
    const LitNeurons lit_b = tap_.lit_neurons(runs_[0].a);
    const std::vector<Job> jobs = {
        [&](const auto&) {
          OpenLoopRun driven(b_.image, runs_[0].a, lit_b);
          behaviour.divergence = find_divergence({a_, b_, structure_, runs_[0].a, driven.recording(),
                                                  [&](std::size_t frame) { driven.run_frame(frame); }});
        },
        [&](const auto&) {
          std::vector<const Recording*> first, second;
          for (const SeedRun& seed : runs_) {
            first.push_back(&seed.a);
            second.push_back(&seed.b);
          }
          behaviour.populations = compare_spikes(first, second, structure_.match.population_of_b);
          behaviour.kinematics = figures();
        }};
    run_jobs(jobs, options_.threads, {});
    behaviour.first_a = std::move(runs_[0].a);
    behaviour.first_b = std::move(runs_[0].b);
    return behaviour;
  }

 private:
  void run_batteries() {
    const SpikeImage& fitted = a_.image.retinas.empty() ? b_.image : a_.image;
    std::vector<Job> jobs;
    for (std::size_t s = 0; s < runs_.size(); ++s) {
      const std::uint64_t seed = s + 1;
      runs_[s].battery = make_battery(seed, HeadGeometry{}.wall_distance_m);
      for (const bool is_a : {true, false}) {
        jobs.push_back([this, s, seed, is_a, &fitted](const std::function<void(double)>& progress) {
          const SimulatedRunOptions options = battery_options(fitted, runs_[s].battery, seed);
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

  [[nodiscard]] std::vector<PairedFigure> figures() const {
    std::vector<PairedFigure> found;
    for (const SeedRun& seed : runs_) {
      const std::vector<KinematicFigure> x = kinematics(seed.a, seed.battery), y = kinematics(seed.b, seed.battery);
      found.resize(x.size());
      for (std::size_t k = 0; k < x.size(); ++k) {
        found[k].name = x[k].name;
        found[k].unit = x[k].unit;
        if (x[k].value && y[k].value) {
          found[k].a.push_back(*x[k].value);
          found[k].b.push_back(*y[k].value);
        }
      }
    }
    return found;
  }

  const CircuitView& a_;
  const CircuitView& b_;
  const StructureDiff& structure_;
  const BehaviourOptions& options_;
  PictureTap tap_;
  std::vector<SeedRun> runs_;
};

std::string figure_line(const PairedFigure& figure) {
  const std::optional<bool> exceeds = figure.exceeds_spread();
  const char* verdict = !exceeds ? "one seed" : *exceeds ? "beyond the spread" : "within the spread";
  return fmt::format("  {:<18} {:>9.4g} {:>9.4g} {:>+9.3g} {:>9.3g}  {:<5}  {}\n", figure.name, figure.mean_a(),
                     figure.mean_b(), figure.difference(), figure.spread(), figure.unit, verdict);
}

std::string kinematics_text(const Behaviour& behaviour) {
  std::string text = fmt::format("  {:<18} {:>9} {:>9} {:>9} {:>9}\n", "", "first", "second", "change", "spread");
  for (const PairedFigure& figure : behaviour.kinematics) {
    text += figure.a.empty() ? fmt::format("  {:<18} {:>9}\n", figure.name, "-") : figure_line(figure);
  }
  return text;
}

std::string populations_text(const Behaviour& behaviour) {
  constexpr std::size_t kMost = 10;
  std::vector<const PopulationDifference*> order;
  for (const PopulationDifference& population : behaviour.populations) {
    order.push_back(&population);
  }
  std::stable_sort(order.begin(), order.end(), [](const PopulationDifference* x, const PopulationDifference* y) {
    return x->van_rossum > y->van_rossum;
  });
  std::string text =
      fmt::format("  {:<18} {:>9} {:>9} {:>9} {:>9} {:>7} {:>10} {:>9} {:>6}\n", "population", "first Hz", "second Hz",
                  "change", "spread", "lag ms", "van Rossum", "Vic.-Pur.", "SPIKE");
  for (std::size_t k = 0; k < std::min(order.size(), kMost); ++k) {
    const PopulationDifference& p = *order[k];
    const std::optional<bool> exceeds = p.rate.exceeds_spread();
    text += fmt::format("  {:<18} {:>9.1f} {:>9.1f} {:>+8.1f}{} {:>9.2f} {:>7} {:>10.2f} {:>9.1f} {:>6.3f}\n", p.name,
                        p.rate.mean_a(), p.rate.mean_b(), p.rate.difference(), exceeds && *exceeds ? "*" : " ",
                        p.rate.spread(), p.lag_ms ? fmt::format("{:+.0f}", *p.lag_ms) : "-", p.van_rossum,
                        p.victor_purpura, p.spike);
  }
  if (order.size() > kMost) {
    text += fmt::format("  and {} more, which differ less\n", order.size() - kMost);
  }
  return text;
}

}  // namespace

double PairedFigure::mean_a() const { return mean(a); }
double PairedFigure::mean_b() const { return mean(b); }
double PairedFigure::spread() const { return std::max(standard_deviation(a), standard_deviation(b)); }
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

Behaviour compare_behaviour(const CircuitView& a, const CircuitView& b, const StructureDiff& structure,
                            const BehaviourOptions& options) {
  return BehaviourComparison(a, b, structure, options).run();
}

std::string behaviour_text(const Behaviour& behaviour) {
  std::string text = divergence_text(behaviour.divergence);
  text += "\nbehaviour: " + behaviour.what + "\n";
  if (behaviour.is_same) {
    return text + "  the same, spike for spike and command for command\n";
  }
  if (!behaviour.kinematics.empty()) {
    text += kinematics_text(behaviour);
  }
  if (!behaviour.populations.empty()) {
    text += populations_text(behaviour);
  }
  return text;
}

}  // namespace tectum
