// What a test can ask of a run in one number.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compiler/expression/dimension.h"
#include "runtime/image/load_image.h"
#include "runtime/record/recording.h"
#include "tools/analysis/saccades.h"
#include "tools/analysis/tracking_metrics.h"
#include "tools/circuit_tests/circuit_test.h"
#include "tools/evaluate/step_response.h"
#include "tools/evaluate/trial_columns.h"

namespace tectum {

inline constexpr double kMeasureSampleRateHz = 500;  // of the shafts, for saccades

/// One run and what is computed of it, each when it is first asked for.
class RunFacts {
 public:
  RunFacts(const SpikeImage& image, const Recording& recording, double settle_s)
      : image_(image), recording_(recording), settle_s_(settle_s) {}

  [[nodiscard]] const Recording& recording() const { return recording_; }
  [[nodiscard]] double settle_s() const { return settle_s_; }
  [[nodiscard]] const TrackingMetrics& tracking();
  [[nodiscard]] const TrialColumns& columns();
  [[nodiscard]] const std::vector<StepResponse>& steps();  // of both eyes

  /// The first saccade of each eye after each jump of the target.
  struct JumpSaccade {
    Saccade saccade;
    double latency_s = 0;
    double landing_error_deg = 0;  // from where it ended to the target
  };
  [[nodiscard]] const std::vector<JumpSaccade>& first_saccades();
  [[nodiscard]] std::optional<double> saccades_per_jump();

  /// Mean rate of a neuron, Hz; nothing when there was no such time. Populations by index.
  [[nodiscard]] std::optional<double> rate_hz(const std::vector<std::size_t>& populations, RateTime time);
  /// Farthest that any eye joint was told to go from where it was told to be at settle_s.
  [[nodiscard]] double eye_travel_deg() const;

 private:
  void find_saccades();

  const SpikeImage& image_;
  const Recording& recording_;
  double settle_s_;
  std::optional<TrackingMetrics> tracking_;
  std::optional<TrialColumns> columns_;
  std::optional<std::vector<StepResponse>> steps_;
  std::optional<std::vector<JumpSaccade>> saccades_;
  std::size_t saccade_count_ = 0, jump_count_ = 0;  // over both eyes
};

struct Measure {
  const char* section;  // "saccade", or "" at the top
  const char* key;
  Dimension dimension;
  bool is_share;
  bool has_channels;  // may be asked of one eye and direction
  const char* about;
  /// Nothing when the run has no such event. Coherent units.
  std::optional<double> (*of)(RunFacts& facts, const std::optional<std::size_t>& channel);
};

[[nodiscard]] const std::vector<Measure>& measures();

/// The populations that a name means: itself, or all its sides ("EBN": "EBN.left", "EBN.right").
[[nodiscard]] std::vector<std::size_t> populations_named(const std::vector<std::string>& names,
                                                         const std::string& name);

}  // namespace tectum
