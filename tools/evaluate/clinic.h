// The clinic: a circuit with the lesion of a disease, and whether the disease's sign appears.
//
// Everything of a disease is data (circuits/protocols/clinic.json): what is taken out, and which measures of the eyes'
// movements must then differ from those of the same circuit whole. Nothing here knows a disease or a structure.
//
// The head looks at a dot that jumps between the middle and four places, rests in the dark at the end, and looks once
// more at a near wall. The movements are those of the motoneurons' command at 500 Hz. Measures of an eye are named
// EYE.MEASURE or EYE.MEASURE.DIRECTION, `left_eye.reach.right`:
//
//   reach           deg    farthest that the eye gets to this side of where it looks when whole and the dot is in the
//                          middle, while the dot is on that side (means of 100 ms)
//   saccades        1      saccades in this direction for each jump in this direction, within 0.8 s
//   first_saccade   deg    how far the first saccade after an outward jump goes in this direction, median; 0 for none
//   overshoot       deg    farthest beyond where the eye rests before the next jump, in 0.5 s after the jump, median
//   peak_velocity   deg/s  of saccades in this direction, median
//   ripple          deg    standard deviation in the last 0.6 s before each jump, median
//   lost            1      share of an outward saccade that is lost 100 ms after its end, median; 0 for none
//   drift_time      s      what `lost` is as the time constant of a decay back to the start; 100 at most
//   convergence     deg    how much farther in the eye turns for the near wall than for the far one
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runtime/image/load_image.h"
#include "tools/analysis/gaze_traces.h"
#include "tools/evaluate/protocol.h"

namespace tectum {

struct ClinicCondition {
  std::string measure;
  bool is_above = false;
  bool is_ratio = false;  // of what the whole circuit shows
  double bound = 0;
};

/// A sign is there when each finding is; a finding is there when any of its conditions holds.
struct ClinicFinding {
  std::string says;
  std::vector<ClinicCondition> any;
};

struct ClinicLesion {
  std::string name;
  std::string about;
  std::string sign;  // in words
  std::string source;
  std::string doi;
  std::vector<std::string> remove;  // what a circuit does not have is left out
  std::vector<std::string> needs;   // without one of these the circuit has no such structure
  /// Circuits in which the structure bears other names: what to remove there, nothing when it is not there.
  std::map<std::string, std::vector<std::string>> in_circuit;
  double fraction = 1;
  std::vector<ClinicFinding> findings;
};

struct ClinicPlan {
  double jump_deg = 10, vertical_jump_deg = 8;
  double dwell_s = 1.2, dark_s = 2;
  double near_wall_m = 0.3, near_s = 8;  // the last second of which is measured
  std::vector<std::string> restrain;     // silenced in every run, whole or lesioned: the neck
  std::vector<ClinicLesion> lesions;
};

struct ReadClinic {
  std::optional<ClinicPlan> plan;
  std::string problems;
};
/// The `clinic` part of a protocol's bytes.
[[nodiscard]] ReadClinic read_clinic_text(const std::string& name, const std::string& bytes);

/// The eyes' commanded angles at 500 Hz.
struct ClinicTrial {
  std::array<AngleTrace, kEyeCount> command;
  std::array<AngleTrace, kEyeCount> near;
  std::array<double, 2> ahead_deg{};  // pan of each eye, whole, with the dot in the middle
};
using Measures = std::map<std::string, double>;

[[nodiscard]] ClinicTrial clinic_trial(const SpikeImage& image, const Protocol& protocol, const ClinicPlan& plan,
                                       const std::function<void(double)>& progress = {});
[[nodiscard]] Measures clinic_measures(const ClinicTrial& trial, const ClinicTrial& whole, const ClinicPlan& plan);

/// Where the dot is and when: for the measures and the pictures. Degrees right and up; nothing in the dark.
struct ClinicStep {
  double begin_s = 0, end_s = 0;
  double pan_deg = 0, tilt_deg = 0;
  bool is_dark = false;
};
[[nodiscard]] std::vector<ClinicStep> clinic_steps(const ClinicPlan& plan);

enum class ClinicVerdict { Shows, Misses, NoStructure };

/// A condition with the figures that it was tried on.
struct Observation {
  ClinicCondition condition;
  double lesioned = 0, whole = 0, bound = 0;
  bool holds = false;
};

struct FindingResult {
  std::string says;
  std::vector<Observation> observed;
  bool is_there = false;
  bool is_there_when_whole = false;
};

struct ClinicResult {
  ClinicVerdict verdict = ClinicVerdict::NoStructure;
  std::vector<std::string> removed;
  ClinicTrial trial;
  Measures measures;
  std::vector<FindingResult> findings;
  /// The sign shows in the whole circuit, so that it says nothing.
  [[nodiscard]] bool is_shown_by_the_whole() const;
};

[[nodiscard]] ClinicResult judge(const ClinicLesion& lesion, ClinicTrial trial, const ClinicTrial& whole,
                                 const ClinicPlan& plan);

struct ClinicReport {
  std::string circuit;
  ClinicTrial whole;
  Measures measures;
  std::vector<ClinicResult> results;  // one a lesion of the plan
};
/// With several reports, a table of all circuits comes first.
[[nodiscard]] std::string clinic_text(const ClinicPlan& plan, const std::vector<ClinicReport>& reports);
/// An object for one circuit, a list of such for several.
[[nodiscard]] std::string clinic_json(const ClinicPlan& plan, const std::vector<ClinicReport>& reports);
[[nodiscard]] std::string clinic_html(const ClinicPlan& plan, const std::vector<ClinicReport>& reports);

}  // namespace tectum
