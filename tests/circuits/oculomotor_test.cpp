// The shipped circuit in the simulated head: that it tracks, and that it is the circuit that does.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/record/recording_file.h"
#include "tests/circuits/compiled_circuit.h"
#include "tools/analysis/simulated_run.h"
#include "tools/analysis/tracking_metrics.h"

using namespace tectum;

namespace {

Recording run(const SpikeImage& image, ScenarioKind scenario, double duration_s, std::uint64_t seed) {
  SimulatedRunOptions options;
  options.head = fitted_to(image, options.head);
  options.head.scenario.kind = scenario;
  options.head.seed = seed;
  options.duration_s = duration_s;
  return run_simulated_head(image, options);
}

/// How far any eye joint was told to go from where it was told to be half a second into the run, when the eyes have
/// taken up their tonic vergence.
double eye_travel_deg(const Recording& recording) {
  constexpr std::size_t kSettledFrame = 23;
  double most = 0;
  for (std::size_t joint = 0; joint < 4; ++joint) {
    for (std::size_t k = kSettledFrame; k < recording.frames.size(); ++k) {
      most = std::max(most,
                      std::abs(recording.frames[k].goal_deg[joint] - recording.frames[kSettledFrame].goal_deg[joint]));
    }
  }
  return most;
}

std::size_t replace_all(std::string& text, const std::string& what, const std::string& with) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
    ++count;
  }
  return count;
}

std::string recording_bytes(const Recording& recording) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("tectum_circuits_" + std::to_string(getpid()) + ".trec")).string();
  REQUIRE(write_recording(recording, path).empty());
  std::FILE* file = std::fopen(path.c_str(), "rb");
  REQUIRE(file != nullptr);
  std::string bytes;
  std::vector<char> chunk(1 << 16);
  for (std::size_t n = 0; (n = std::fread(chunk.data(), 1, chunk.size(), file)) > 0;) {
    bytes.append(chunk.data(), n);
  }
  std::fclose(file);
  std::remove(path.c_str());
  return bytes;
}

}  // namespace

TEST_CASE("structure alone keeps both eyes on a random target") {
  const SpikeImage image = compiled_circuit(oculomotor_text());
  const TrackingMetrics metrics = tracking_metrics(run(image, ScenarioKind::Random, 12, 11));
  REQUIRE(metrics.has_truth);
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    CAPTURE(eye);
    CHECK(metrics.eye[eye].pan.all.rmse_deg < 4);
    CHECK(metrics.eye[eye].tilt.all.rmse_deg < 4);
  }
}

TEST_CASE("without the colliculus's connections to the generators the eyes stay where they are") {
  const std::string text = oculomotor_text();
  const Recording intact = run(compiled_circuit(text), ScenarioKind::Step, 6, 1);
  const Recording lesioned = run(compiled_circuit(text, {"SC*->LLBN*", "SC*->EBN*"}), ScenarioKind::Step, 6, 1);
  CHECK(eye_travel_deg(intact) > 5);
  // What is left is the tonic neurons' own unevenness and the leak of the integrator, far below any eye movement.
  CHECK(eye_travel_deg(lesioned) < 1);
}

TEST_CASE("with left and right swapped in the circuit the eyes run away from the target") {
  std::string text = oculomotor_text();
  const Recording intact = run(compiled_circuit(text), ScenarioKind::Hold, 4, 1);
  // The colliculus's map, mirrored: what drove the left side's cells drives the right side's, up drives down.
  REQUIRE(replace_all(text, "hemifield == side", "hemifield == mirrored_side") > 0);
  replace_all(text, "hemifield != side", "hemifield == side");
  replace_all(text, "hemifield == mirrored_side", "hemifield != side");
  const Recording swapped = run(compiled_circuit(text), ScenarioKind::Hold, 4, 1);
  const auto error_at_end = [](const Recording& recording, std::size_t eye) {
    const EyeTruth& truth = recording.frames.back().eye[eye];
    return std::hypot(truth.error_pan_deg, truth.error_tilt_deg);
  };
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    CAPTURE(eye);
    const EyeTruth& start = swapped.frames.front().eye[eye];
    const double error_at_start_deg = std::hypot(start.error_pan_deg, start.error_tilt_deg);
    CHECK(error_at_end(intact, eye) < 2);
    CHECK(error_at_end(swapped, eye) > error_at_start_deg + 5);
  }
}

TEST_CASE("the same seed leaves the same bytes, another seed does not") {
  const SpikeImage image = compiled_circuit(oculomotor_text());
  const std::string first = recording_bytes(run(image, ScenarioKind::Step, 5, 3));
  CHECK(first == recording_bytes(run(image, ScenarioKind::Step, 5, 3)));
  CHECK(first != recording_bytes(run(image, ScenarioKind::Step, 5, 4)));
}
