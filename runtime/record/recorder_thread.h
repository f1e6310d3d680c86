// A recorder that the loop does not wait for: the loop fills slots that were sized beforehand, a thread empties them
// into a file.
//
// A loop that is faster than the disk for longer than the slots last loses whole frames, and a turn with more spikes
// than a slot holds loses the last of them. Both are counted, and a recording that lost anything cannot be replayed.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "runtime/loop/spike_sink.h"
#include "runtime/record/recording.h"

namespace tectum {

struct RecorderOptions {
  std::string path;                     // of the file; empty for none
  bool keeps = false;                   // everything in memory too, for recording()
  std::size_t slots = 64;               // turns
  std::size_t spikes_per_turn = 32768;  // 16 bytes each
  /// Called from the recorder's thread with every turn, for those who watch. May be empty.
  std::function<void(const RecordedFrame&, const std::vector<RecordedSpike>&)> watch;
};

class RecorderThread final : public SpikeSink {
 public:
  RecorderThread();
  ~RecorderThread() override;

  /// Opens the file and starts the thread. One line when it cannot, else empty. Not real-time safe.
  [[nodiscard]] std::string start(const Recording& run, const RecorderOptions& options);

  /// Real-time safe.
  void take(std::uint64_t tick, std::span<const NeuronId> spikes) noexcept override;
  /// Ends a turn. Real-time safe.
  void frame(const RecordedFrame& frame) noexcept;

  /// Nothing of the turns to come is taken: a head that goes home is not part of the run. Real-time safe.
  void end_turns() noexcept;

  /// Waits until everything is written. One line when something could not be, else empty. Not real-time safe.
  [[nodiscard]] std::string finish(double duration_s);

  [[nodiscard]] std::uint64_t lost_frames() const noexcept;
  [[nodiscard]] std::uint64_t lost_spikes() const noexcept;
  /// After finish(), with RecorderOptions::keeps.
  [[nodiscard]] Recording& recording() noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tectum
