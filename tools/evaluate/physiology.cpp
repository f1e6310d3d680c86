#include "tools/evaluate/physiology.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/analysis/saccades.h"
#include "tools/analysis/statistics.h"
#include "tools/evaluate/eye_plant.h"
#include "tools/evaluate/parallel_jobs.h"
#include "tools/evaluate/tracking_evaluation.h"
#include "tools/evaluate/trial_columns.h"

namespace tectum {
namespace {

constexpr double kSampleS = TrialColumns::kSampleS;

struct Line {
  double slope = 0, intercept = 0, correlation = 0;
};

Line fit(const std::vector<double>& x, const std::vector<double>& y) {
  const double mean_x = mean(x);
  const double mean_y = mean(y);
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mean_x) * (x[k] - mean_x);
    xy += (x[k] - mean_x) * (y[k] - mean_y);
    yy += (y[k] - mean_y) * (y[k] - mean_y);
  }
  Line line;
  line.slope = xx > 0 ? xy / xx : 0;
  line.intercept = mean_y - line.slope * mean_x;
  line.correlation = xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : 0;
  return line;
}

class Measures {
 public:
  explicit Measures(const std::vector<TrialColumns>& trials) : trials_(trials) {}

  [[nodiscard]] std::vector<Yardstick> all() {
    kinematics();
    timing();
    omnipause();
    bursters("EBN.left", "EBN.right");
    holders();
    return std::move(found_);
  }

 private:
  void add(std::string what, std::string unit, std::optional<double> value, double low, double high,
           std::string source) {
    found_.push_back({std::move(what), std::move(unit), value, low, high, std::move(source)});
  }

  template <typename Visit>
  void each_saccade(const Visit& visit) const {
    for (const TrialColumns& trial : trials_) {
      for (const Saccade& saccade : trial.saccades) {
        visit(trial, saccade);
      }
    }
  }

  [[nodiscard]] std::optional<double> peak_near(double amplitude_deg) const {
    std::vector<double> peaks;
    each_saccade([&](const TrialColumns&, const Saccade& s) {
      if (std::abs(s.amplitude_deg - amplitude_deg) < 0.2 * amplitude_deg) {
        peaks.push_back(s.peak_velocity_deg_s);
      }
    });
    return peaks.size() < 3 ? std::nullopt : std::optional<double>(median(peaks));
  }

  void kinematics() {
    add("peak velocity, 5 deg saccades", "deg/s", peak_near(5), 155, 271, "VOG at 220 Hz 213 +- 2 x 29, PMC6143243");
    add("peak velocity, 10 deg saccades", "deg/s", peak_near(10), 426, 639,
        "700 (1 - exp(-A/7)) +- 20 %, as Bahill and others");
    add("peak velocity, 15 deg saccades", "deg/s", peak_near(15), 252, 452, "VOG 352 +- 2 x 50, PMC6143243");
    std::vector<double> amplitude_deg, duration_ms, skewness;
    each_saccade([&](const TrialColumns&, const Saccade& s) {
      amplitude_deg.push_back(s.amplitude_deg);
      duration_ms.push_back(1000 * s.duration_s);
      if (s.amplitude_deg <= 10 && s.amplitude_deg > 3) {
        skewness.push_back(s.skewness);
      }
    });
    const bool has_enough = amplitude_deg.size() >= 10;
    const Line line = fit(amplitude_deg, duration_ms);
    add("duration, slope over amplitude", "ms/deg", has_enough ? std::optional(line.slope) : std::nullopt, 1.8, 3.2,
        "2.2 A + 21 ms; 2.7 A + 37 ms, Baloh 1975");
    add("duration, intercept", "ms", has_enough ? std::optional(line.intercept) : std::nullopt, 15, 45, "as above");
    add("share of the duration at which the speed peaks, 3-10 deg", "",
        skewness.empty() ? std::nullopt : std::optional(median(skewness)), 0.35, 0.55,
        "0.45, Collewijn, Erkelens & Steinman 1988");
  }

  void timing() {
    std::vector<double> latency_ms, count, interval_ms;
    for (const TrialColumns& trial : trials_) {
      for (const double latency_s : saccade_latencies_s(trial.saccades, trial.jumps_s)) {
        latency_ms.push_back(1000 * latency_s);
      }
      for (std::size_t k = 1; k < trial.saccades.size(); ++k) {
        interval_ms.push_back(1000 * (trial.saccades[k].onset_s - trial.saccades[k - 1].offset_s));
      }
      count.push_back(static_cast<double>(trial.saccades.size()) /
                      std::max<double>(1, static_cast<double>(trial.jumps_s.size())));
    }
    add("latency of the first saccade after a jump, median", "ms",
        latency_ms.empty() ? std::nullopt : std::optional(median(latency_ms)), 100, 300,
        "180-200, range 100-300, JOV 2577684");
    add("shortest pause between saccades (5th percentile)", "ms",
        interval_ms.empty() ? std::nullopt : std::optional(quantile(interval_ms, 0.05)), 100, 1e4,
        "refractory > 100 ms");
    add("saccades for one jump", "", mean(count), 1, 2, "one, and perhaps one small correction");
  }

  void omnipause() {
    std::vector<double> tonic_hz, silent_share, lead_ms;
    each_saccade([&](const TrialColumns& trial, const Saccade& s) {
      const auto opn = trial.population("OPN");
      if (!opn || s.amplitude_deg < 3) {
        return;
      }
      const double before_hz = trial.rate(*opn, s.onset_s - 0.3, s.onset_s - 0.1);
      if (before_hz <= 0) {
        return;
      }
      tonic_hz.push_back(before_hz);
      silent_share.push_back(trial.rate(*opn, s.onset_s, s.offset_s - kEyePlantLagS) / before_hz);
      double last_s = s.onset_s + 0.02;  // the last sample with an OPN spike before the pause
      while (last_s > s.onset_s - 0.08 && trial.rate(*opn, last_s, last_s + 1.5 * kSampleS) <= 0.2 * before_hz) {
        last_s -= kSampleS;
      }
      lead_ms.push_back(1000 * (s.onset_s - last_s));
    });
    const auto middle = [](const std::vector<double>& v) {
      return v.empty() ? std::nullopt : std::optional(median(v));
    };
    add("OPN rate between saccades", "sp/s", middle(tonic_hz), 50, 130, "Evinger, Kaneko & Fuchs 1982 (cat)");
    add("OPN rate in saccades, share of that", "", middle(silent_share), 0, 0.1, "silent, PMC5332859");
    add("OPN pause leads the saccade by", "ms", middle(lead_ms), 5, 37, "15 monkey, 18.2-32.4 cat");
  }

  void bursters(const char* left, const char* right) {
    std::vector<double> peak_hz, spikes, horizontal_deg, burst_ms, duration_ms, lead_ms;
    each_saccade([&](const TrialColumns& trial, const Saccade& s) {
      const double pan_deg = s.to_deg[0] - s.from_deg[0];
      const auto agonist = trial.population(pan_deg > 0 ? right : left);
      if (!agonist || std::abs(pan_deg) < 2 || std::abs(pan_deg) < 0.7 * s.amplitude_deg) {
        return;
      }
      double peak = 0, first_s = -1, last_s = -1, sum = 0;
      for (double at_s = s.onset_s - 0.06; at_s < s.offset_s + 0.02; at_s += kSampleS) {
        const double rate_hz = trial.rate(*agonist, at_s, at_s + 3.5 * kSampleS);
        peak = std::max(peak, rate_hz);
        sum += rate_hz * kSampleS;
        if (rate_hz > 50) {
          first_s = first_s < 0 ? at_s : first_s;
          last_s = at_s;
        }
      }
      if (first_s < 0) {
        return;
      }
      if (s.amplitude_deg > 8) {
        peak_hz.push_back(peak);
      }
      spikes.push_back(sum);
      horizontal_deg.push_back(std::abs(pan_deg));
      burst_ms.push_back(1000 * (last_s - first_s));
      duration_ms.push_back(1000 * s.duration_s);
      lead_ms.push_back(1000 * (s.onset_s - first_s));
    });
    const bool has_enough = spikes.size() >= 10;
    const auto if_enough = [&](double value) { return has_enough ? std::optional(value) : std::nullopt; };
    add("EBN peak rate, saccades over 8 deg", "sp/s", peak_hz.empty() ? std::nullopt : std::optional(median(peak_hz)),
        600, 1000, "textbook figure, unverified");
    add("EBN spikes against horizontal amplitude, r", "", if_enough(fit(horizontal_deg, spikes).correlation), 0.8, 1,
        "linear, Strassman, Highstein & McCrea 1986");
    add("EBN burst duration against saccade duration, r", "", if_enough(fit(duration_ms, burst_ms).correlation), 0.8, 1,
        "linear, Strassman, Highstein & McCrea 1986");
    add("EBN burst leads the saccade by", "ms", lead_ms.empty() ? std::nullopt : std::optional(median(lead_ms)), 5, 15,
        "5-15, Strassman and others 1986");
  }

  /// Rate over position in the 100 ms before each saccade, when the eye has been still.
  void position_slope(const char* population, double sign, const char* what, double low, double high,
                      const char* source, bool is_rate_ahead) {
    std::vector<double> position_deg, rate_hz;
    each_saccade([&](const TrialColumns& trial, const Saccade& s) {
      const auto index = trial.population(population);
      if (index) {
        position_deg.push_back(sign * s.from_deg[0]);
        rate_hz.push_back(trial.rate(*index, s.onset_s - 0.12, s.onset_s - 0.02));
      }
    });
    const Line line = fit(position_deg, rate_hz);
    const bool has_enough = position_deg.size() >= 10;
    add(what, is_rate_ahead ? "sp/s" : "sp/s/deg",
        has_enough ? std::optional(is_rate_ahead ? line.intercept : line.slope) : std::nullopt, low, high, source);
  }

  void holders() {
    position_slope("TN.right", 1, "TN rate over eye position", 1.9, 5.2,
                   "4.04 + 0.032 T monkey; 2.8 goldfish, Aksay 2000", false);
    position_slope("MN_lateral.left", -1, "lateral rectus MN rate over eye position, whole pool", 4, 8.5,
                   "6.2, PMC3118740; 7.2 cat", false);
    position_slope("MN_medial.left", 1, "medial rectus MN rate over eye position, whole pool", 4, 8.5,
                   "5.4, PMC3118740", false);
    position_slope("MN_lateral.left", -1, "lateral rectus MN rate straight ahead", 70, 130, "97, Goldstein & Robinson",
                   true);
  }

  const std::vector<TrialColumns>& trials_;
  std::vector<Yardstick> found_;
};

}  // namespace

std::vector<Yardstick> physiology(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                  const std::function<void(double)>& progress) {
  std::vector<TrialColumns> trials(static_cast<std::size_t>(protocol.trials));
  std::vector<Job> jobs;
  for (std::size_t trial = 0; trial < trials.size(); ++trial) {
    jobs.emplace_back([&, trial](const std::function<void(double)>& report) {
      const Setting setting{protocol.hold_s.front(), protocol.camera_latency_frames.front()};
      SimulatedRunOptions options = trial_options(image, protocol, setting, protocol.first_seed + trial);
      options.keeps_spikes = true;
      RunObserver observer;
      observer.progress = report;
      trials[trial] = trial_columns(image, run_simulated_head(image, options, observer));
    });
  }
  run_jobs(jobs, threads, progress);
  return Measures(trials).all();
}

std::string physiology_text(const Protocol& protocol, const std::vector<Yardstick>& yardsticks) {
  std::string text = fmt::format(
      "protocol {}: {} trial{} of {:g} s, seeds from {}; movements that the motoneurons would give a human eye\n\n",
      protocol.name, protocol.trials, protocol.trials == 1 ? "" : "s", protocol.duration_s, protocol.first_seed);
  std::size_t passed = 0;
  for (const Yardstick& y : yardsticks) {
    const std::string value = y.value ? fmt::format("{:.4g}", *y.value) : std::string("-");
    const std::string wanted =
        y.high >= 1e4 ? fmt::format("over {:g}", y.low) : fmt::format("{:g} to {:g}", y.low, y.high);
    text += fmt::format("{}  {:<58}{:>8} {:<9}{:>12}   {}\n",
                        y.passes() ? "pass"
                        : y.value  ? "FAIL"
                                   : "none",
                        y.what, value, y.unit, wanted, y.source);
    passed += y.passes() ? 1U : 0U;
  }
  return text + fmt::format("\n{} of {} pass\n", passed, yardsticks.size());
}

std::string physiology_json(const Protocol& protocol, const std::string& circuit,
                            const std::vector<Yardstick>& yardsticks) {
  nlohmann::ordered_json json{{"protocol", protocol.name}, {"circuit", circuit}};
  json["yardsticks"] = nlohmann::ordered_json::array();
  for (const Yardstick& y : yardsticks) {
    nlohmann::ordered_json row{{"what", y.what}, {"unit", y.unit}};
    row["value"] = y.value ? nlohmann::ordered_json(*y.value) : nlohmann::ordered_json(nullptr);
    row["low"] = y.low;
    row["high"] = y.high;
    row["passes"] = y.passes();
    row["source"] = y.source;
    json["yardsticks"].push_back(std::move(row));
  }
  return json.dump(2);
}

}  // namespace tectum
