// What the laser dot on the wall does: a position for every time, the same for the same seed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "runtime/ports/frame.h"

namespace tectum {

enum class ScenarioKind {
  /// The dot stays at hold_at_m.
  Hold,
  /// Eight points, step_hold_s each, over and over: the order of the recorded experiment of the 2022 controller
  /// (laser_pointer_control.py of github.com/combra-lab/spiking-oculomotor-head-control).
  Step,
  /// A circle from its lowest point, counter-clockwise, circle_period_s a turn. Same source: six turns in 60 s.
  Circle,
  /// Circles ever faster: the first lasts chirp_first_period_s, each next one 1/chirp_ratio of the one before, down to
  /// the last that is no shorter than chirp_shortest_period_s; then from the start again. Same source.
  Chirp,
  /// A new place every random_hold_s, uniform on the wall within the range of the 2020 head's laser, no farther than
  /// random_jump_deg from the last, so that the dot stays in view. Starts straight ahead.
  Random,
  /// Straight lines between the points of `path`, each reached at its time; two points at one time are a jump. The dot
  /// rests at the first before and at the last after. For programs: no name on a command line stands for it.
  Path,
};

inline constexpr std::array<const char*, 5> kScenarioNames = {"hold", "step", "circle", "chirp", "random"};

struct PathPoint {
  double time_s = 0;
  std::array<double, 2> at_m{};
  double distance_m = 0;  // of a screen carried before the wall; 0: on the wall
};

/// Lengths on the wall in metres, right and up of the point straight ahead.
struct ScenarioParams {
  ScenarioKind kind = ScenarioKind::Random;
  std::uint64_t seed = 1;
  double wall_distance_m = 0.55;

  std::array<double, 2> hold_at_m = {0.10, 0.05};

  /// Half the side of the step's square, and the radius of circle and chirp. The experiment's 0.2 m on a wall 0.5865 m
  /// away is 18.8 deg; the same angle on a wall at 0.55 m keeps every jump inside a view of 39.4 deg.
  double extent_m = 0.2 * 0.55 / 0.5865;
  double step_hold_s = 4;
  double circle_period_s = 10;
  double chirp_first_period_s = 20;
  double chirp_ratio = 1.2;
  double chirp_shortest_period_s = 1;

  double random_hold_s = 1;
  double random_pan_deg = 25;   // to either side, seen from the head (servo calibration of the 2020 laser)
  double random_tilt_deg = 15;  // up and down
  double random_jump_deg = 15;  // 180 = no limit

  std::vector<PathPoint> path;  // times ascend
};

[[nodiscard]] const char* scenario_name(ScenarioKind kind);
[[nodiscard]] std::optional<ScenarioKind> scenario_from_name(std::string_view name);

class Scenario {
 public:
  explicit Scenario(const ScenarioParams& params);

  [[nodiscard]] std::array<double, 2> target_m(TimeNs time_ns);
  /// From the head's origin to the plane that the dot is on: the wall, except where a path says otherwise.
  [[nodiscard]] double target_distance_m(TimeNs time_ns) const;

 private:
  [[nodiscard]] std::array<double, 2> on_circle(double turn) const;
  [[nodiscard]] std::array<double, 2> chirp_m(double time_s) const;
  [[nodiscard]] std::array<double, 2> random_place(std::size_t index);
  [[nodiscard]] PathPoint on_path(double time_s) const;

  ScenarioParams params_;
  double chirp_cycle_s_ = 0;
  std::vector<std::array<double, 2>> random_places_;  // grows as time is asked for; place k follows from k - 1
};

}  // namespace tectum
