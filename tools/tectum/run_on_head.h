// tectum run --head: the circuit on a head, in real time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/image/load_image.h"
#include "runtime/record/recording.h"
#include "tools/analysis/simulated_run.h"
#include "tools/tectum/command.h"

namespace tectum {

struct HeadArguments {
  std::string path;  // of the head file; empty: no head
  bool is_real_time = false;
  int core = -1;
  std::string view;  // auto, text, window or a picture file; empty for none
};

/// Adds --head, --realtime, --core and --view.
void add_head_arguments(CLI::App& command, HeadArguments& arguments);

struct HeadRunRequest {
  HeadArguments head;
  SimulatedRunOptions simulation;  // of the emulated head, and of the comparison in virtual time
  double duration_s = 60;
  std::string record_path;  // empty for none
};

/// Deadlines, latencies and bus, with tracking beside virtual time for an emulated head.
struct HeadFigures {
  std::string text;
  std::string json;                          // one object
  std::vector<std::int32_t> learned_scales;  // of a run that learns
};

/// Prints what happens to the error stream, and fills `figures`. Nothing when there was no run; that has been said and
/// the exit status set.
[[nodiscard]] std::optional<Recording> run_on_head(const SpikeImage& image, const HeadRunRequest& request,
                                                   CommandContext& context, HeadFigures& figures);

}  // namespace tectum
