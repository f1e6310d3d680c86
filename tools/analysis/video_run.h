// A circuit on recorded video: real pictures in, commands out, nothing moves.
#pragma once

#include <string>
#include <vector>

#include "runtime/image/load_image.h"
#include "runtime/loop/control_loop.h"
#include "runtime/record/recording.h"
#include "tools/analysis/simulated_run.h"

namespace tectum {

struct VideoRunOptions {
  std::vector<std::string> files;  // one for both eyes, or left and right
  double frame_rate_hz = 0;        // 0: the first file's own
  double duration_s = 0;           // 0: to the end of the shorter file
  bool learns = false;             // weights change as the circuit declares
  EngineOptions engine;
};

struct VideoRun {
  Recording recording;
  std::string error;  // one line; empty when all went well
};

/// Frame k of the video is turn k of the loop when frame_rate_hz is the file's own. The servos are taken to be at once
/// where they are told to be, but the pictures do not follow them.
[[nodiscard]] VideoRun run_on_video(const SpikeImage& image, const VideoRunOptions& options,
                                    const RunObserver& observer = {});

}  // namespace tectum
