// One run of a protocol for each combination of parameters and seeds, over the cores.
//
// Each result is a file of its own in FOLDER/rows, named by a digest of all that it depends on: the compiled image, the
// protocol and the seed. It is written beside and renamed, so that it is there whole or not at all. What a killed sweep
// has finished, or another machine with the same folder, is therefore found and not run again, and an edit of
// the circuit runs what the edit touches.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "compiler/compile.h"
#include "tools/evaluate/protocol.h"
#include "tools/sweep/sweep_axis.h"

namespace tectum {

struct SweepMeasure {
  const char* name;   // the CSV's column
  const char* title;  // for people
  int decimals;
};
inline constexpr std::array<SweepMeasure, 10> kSweepMeasures = {{
    {"rmse_deg", "tracking error, RMS (deg)", 2},
    {"settled_rmse_deg", "the same without the 300 ms after a jump (deg)", 2},
    {"median_abs_deg", "median of |error| (deg)", 2},
    {"p90_abs_deg", "90th percentile of |error| (deg)", 2},
    {"fovea_share", "share of frames within 1 deg", 2},
    {"jitter_deg", "gaze peak to peak while the target rests (deg)", 2},
    {"latency_ms", "latency of the answer to a jump (ms)", 0},
    {"overshoot_percent", "overshoot (%)", 1},
    {"settled_ms", "time to stay within 2 deg (ms)", 0},
    {"neck_travel_deg", "travel of the neck (deg)", 0},
}};

/// In the order of kSweepMeasures, means over both axes of both eyes; nothing where the protocol has no jumps.
using SweepRow = std::array<std::optional<double>, kSweepMeasures.size()>;

struct SweepPlan {
  std::string circuit_path;
  CompileOptions compile;  // what the command line sets for every point alike
  Protocol protocol;       // its first hold and camera latency are run
  std::vector<SweepAxis> axes;
  std::string folder;
  unsigned threads = 0;  // 0: one for each core
};

struct SweepResult {
  std::vector<SweepPoint> points;
  std::vector<SweepRow> rows;    // as points
  std::size_t runs = 0;          // what had to be run
  std::size_t distinct = 0;      // points that no other one shares its result with
  std::string circuit_problems;  // a value that the circuit does not take, as text for people
  std::string error;             // one line: a file that cannot be read or written
};

/// Compiles every point and runs none: `circuit_problems` and `error` alone are set.
[[nodiscard]] SweepResult check_sweep(const SweepPlan& plan);

/// `progress` gets the share that is done and how many runs are ready of how many.
using SweepProgress = std::function<void(double done, std::size_t ready, std::size_t all)>;
[[nodiscard]] SweepResult run_sweep(const SweepPlan& plan, const SweepProgress& progress);

/// "error_gain=0.3 nA/deg" for each axis but the seed.
[[nodiscard]] std::vector<std::string> parameters_of(const std::vector<SweepAxis>& axes, const SweepPoint& point);

}  // namespace tectum
