// The paper's own controller against what its authors' program did: the same drives must give the same motor spikes.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "compiler/source/csv_reader.h"
#include "runtime/engine/spike_engine.h"
#include "tests/circuits/compiled_circuit.h"
#include "tests/support/laser_dot.h"
#include "tools/analysis/simulated_run.h"
#include "tools/analysis/tracking_metrics.h"

using namespace tectum;

namespace {

constexpr int kWindowTicks = 22;
constexpr int kIdleWindows = 30;
constexpr std::size_t kDrives = 6;
constexpr std::array<const char*, kDrives> kDriveNames = {"LL", "RR", "LR", "RL", "U", "D"};
/// In the order of the operating curve's columns.
constexpr std::array<const char*, 10> kCounted = {
    "MN_lateral.left",  "MN_lateral.right", "MN_medial.right", "MN_medial.left", "MN_vertical.up",
    "MN_vertical.down", "neck_pan.left",    "neck_pan.right",  "neck_tilt.up",   "neck_tilt.down"};
constexpr std::array<const char*, 6> kSpeeds = {"speed.left",  "speed_d.right", "speed_d.left",
                                                "speed.right", "speed_v.up",    "speed_v.down"};
using Window = std::array<int, kCounted.size() + kSpeeds.size()>;

SpikeImage operating_point(const std::array<double, kDrives>& drives) {
  std::vector<std::string> parameters;
  for (std::size_t d = 0; d < kDrives; ++d) {
    parameters.push_back(std::string(kDriveNames[d]) + "=" + std::to_string(drives[d]));
  }
  return shipped_circuit("experiments/balachandar2020_operating_point.json", parameters);
}

/// Spikes of each window that follows the idle ones; of a speed population, those of its highest unit.
std::vector<Window> driven_windows(const SpikeImage& image, int count) {
  std::vector<std::uint32_t> neurons;
  for (const char* name : kCounted) {
    neurons.push_back(image.populations[image.find_population(name).value()].first_neuron);
  }
  for (const char* name : kSpeeds) {
    neurons.push_back(image.populations[image.find_population(name).value()].first_neuron + 4);
  }
  SpikeEngine engine(image);
  std::vector<Window> windows;
  for (int w = 0; w < kIdleWindows + count; ++w) {
    Window counts{};
    for (int t = 0; t < kWindowTicks; ++t) {
      engine.step();
      const auto spikes = engine.spikes();
      for (std::size_t k = 0; k < neurons.size(); ++k) {
        counts[k] += std::binary_search(spikes.begin(), spikes.end(), NeuronId{neurons[k]}) ? 1 : 0;
      }
    }
    if (w >= kIdleWindows) {
      windows.push_back(counts);
    }
  }
  return windows;
}

/// Of a pair of antagonists: 1 when the first leads, -1 when the second does.
int direction(double first, double second) { return first > second ? 1 : first < second ? -1 : 0; }

}  // namespace

TEST_CASE("a constant target to the left gives the original's motor spikes, window by window") {
  const std::vector<std::array<int, 4>> original = {{13, 0, 0, 13}, {16, 0, 0, 18}, {17, 0, 0, 20}, {4, 0, 12, 18},
                                                    {20, 0, 0, 20}, {12, 0, 0, 15}, {17, 0, 0, 17}, {0, 0, 19, 7},
                                                    {22, 0, 0, 22}, {9, 0, 0, 16},  {5, 0, 4, 17},  {15, 0, 0, 21}};
  const std::vector<Window> windows = driven_windows(operating_point({0.5, 0, 0, 0.5, 0, 0}), 12);
  for (std::size_t w = 0; w < original.size(); ++w) {
    CAPTURE(w);
    CHECK(std::array<int, 4>{windows[w][0], windows[w][1], windows[w][2], windows[w][3]} == original[w]);
  }
}

// Needs the recorded curve, which lies beside the checkout and is no part of it.
TEST_CASE("every point of the published operating curve is met" *
          doctest::skip(!std::filesystem::exists(laser_dot_folder() + "/original_controller_operating_curve.csv"))) {
  CsvReader reader(laser_dot_folder() + "/original_controller_operating_curve.csv");
  REQUIRE(reader.error().empty());
  // Columns: pattern, drive, the six drives, ten counts, six speeds.
  std::vector<std::size_t> columns(kDrives + kCounted.size() + kSpeeds.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c] = c + 2;
  }
  reader.select(columns, true);
  std::vector<double> row(columns.size());
  constexpr int kWindows = 40;
  int rows = 0;
  for (; reader.next(row); ++rows) {
    CAPTURE(reader.line());
    const std::vector<Window> windows =
        driven_windows(operating_point({row[0], row[1], row[2], row[3], row[4], row[5]}), kWindows);
    Window sums{};
    for (const Window& window : windows) {
      for (std::size_t k = 0; k < sums.size(); ++k) {
        sums[k] += window[k];
      }
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
      CAPTURE(k);
      CHECK(sums[k] / double{kWindows} == doctest::Approx(row[kDrives + k]).epsilon(1e-12));
    }
    for (const std::size_t k : {4U, 6U, 8U}) {
      CHECK(direction(sums[k], sums[k + 1]) == direction(row[kDrives + k], row[kDrives + k + 1]));
    }
  }
  CHECK(rows == 25);
}

TEST_CASE("the paper's own controller follows a jumping target") {
  const SpikeImage image = shipped_circuit("balachandar2020.json");
  SimulatedRunOptions options;
  options.head = fitted_to(image, options.head);
  options.head.scenario.kind = ScenarioKind::Random;
  options.head.seed = 1;
  options.duration_s = 20;
  const TrackingMetrics moving = tracking_metrics(run_simulated_head(image, options));
  const SpikeImage still = shipped_circuit("balachandar2020.json", {}, {"SC"});
  const TrackingMetrics blind = tracking_metrics(run_simulated_head(still, options));
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    CAPTURE(eye);
    CHECK(moving.eye[eye].pan.all.rmse_deg < 0.6 * blind.eye[eye].pan.all.rmse_deg);
    CHECK(moving.eye[eye].tilt.all.rmse_deg < 0.6 * blind.eye[eye].tilt.all.rmse_deg);
  }
}
