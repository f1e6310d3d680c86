// A circuit driven by what another one saw: its spikes and commands, which move nothing.
#pragma once

#include "runtime/act/decoder.h"
#include "runtime/act/servo_guard.h"
#include "runtime/engine/spike_engine.h"
#include "runtime/record/recording.h"
#include "tools/diff/picture_tap.h"

namespace tectum {

/// Holds the neurons of a list on, and all others off.
class FieldSwitch {
 public:
  void set(SpikeEngine& engine, const std::vector<std::uint32_t>& lit);

 private:
  std::vector<std::uint32_t> lit_;
};

/// First tick after the frame's own.
[[nodiscard]] std::uint64_t end_tick(const Recording& recording, std::size_t frame, std::uint64_t tick_ns);

class OpenLoopRun {
 public:
  /// All three outlive it. `lit` holds neurons of the image by frame of `input`.
  OpenLoopRun(const SpikeImage& image, const Recording& input, const LitNeurons& lit);
  OpenLoopRun(const SpikeImage&, const Recording&, LitNeurons&&) = delete;  // it keeps a reference
  /// Frames one after the other, from 0 on.
  void run_frame(std::size_t frame);
  [[nodiscard]] const Recording& recording() const { return recording_; }
  [[nodiscard]] Recording& recording() { return recording_; }

 private:
  const SpikeImage& image_;
  const Recording& input_;
  const LitNeurons& lit_;
  SpikeEngine engine_;
  Decoder decoder_;
  ServoGuard guard_;
  ServoCommand command_;
  FieldSwitch fields_;
  Recording recording_;
};

}  // namespace tectum
