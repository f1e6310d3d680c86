// Recordings on disk: one append-only file that describes itself and survives a process that is killed.
//
//   1. Magic (8 bytes) "TECTREC\n", u32 version, u32 zero.
//   2. Blocks, each: u32 kind, u32 payload bytes, u64 checksum of kind, payload bytes and payload; then the payload.
//
// All numbers are little-endian. The kinds, in the order in which they come:
//   1  Description  text: what every field of the other blocks is, so that the file can be read without this source
//   2  Run          what was run; once, before any frame
//   3  Spikes       of the frames that follow
//   4  Frames       turns of the loop; their spikes are in the blocks before
//   5  End          the run was finished; nothing follows
//   6  Image        the image that ran, so that the run can be replayed from this file alone; after Run, or not at all
//   7  Positions    of the joints between the frames, where they were sampled; anywhere after Run
//
// A file cut at any byte opens up to its last whole block. It holds no wall-clock time: identical runs leave identical
// bytes. Blocks are cut by counts of frames and bytes alone.
//
// Version history
//   1  first version
//   2  what the guard saw and did, loop timing, the image, positions between frames
//   3  whether weights learned
#pragma once

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <string>

#include "runtime/act/servo_guard.h"
#include "runtime/image/load_image.h"
#include "runtime/loop/spike_sink.h"
#include "runtime/record/recording.h"

namespace tectum {

inline constexpr std::uint32_t kRecordingVersion = 3;

/// What a recording says of its image: names, populations, retinas, tick, seed, its bytes. No frames or spikes yet.
[[nodiscard]] Recording describe_run(const SpikeImage& image);
/// With which settings the guard ran; describe_run() takes the guard's own.
void describe_guard(const GuardOptions& options, Recording& run);

/// Appends a run to a file. A failed write is remembered: everything after it does nothing and says false.
class RecordingWriter final : public SpikeSink {
 public:
  RecordingWriter();
  ~RecordingWriter() override;

  /// Creates or replaces the file and writes what is known before the run; frames and spikes of `run` are ignored.
  /// Not real-time safe.
  [[nodiscard]] bool open(const std::string& path, const Recording& run);
  /// Spikes of one tick; before the frame that they belong to. No allocation.
  void take(std::uint64_t tick, std::span<const NeuronId> spikes) noexcept override;
  /// One turn. Writes a block now and then. No allocation.
  [[nodiscard]] bool frame(const RecordedFrame& frame) noexcept;
  /// Joints between two frames; before the frame that follows it. No allocation.
  void positions(const RecordedPositions& positions) noexcept;
  /// Writes what is left and the end block, and closes.
  [[nodiscard]] bool finish(double duration_s);
  /// One line, or empty.
  [[nodiscard]] const std::string& error() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A recording, or a line that says why there is none.
struct ReadRecording {
  Recording recording;
  std::string error;              // empty: `recording` holds all that could be read
  bool is_truncated = false;      // the run was not finished, or the file is cut or damaged
  std::uint64_t valid_bytes = 0;  // up to the end of the last whole block
  std::string ending;             // where and why a truncated file ends, one line
};
[[nodiscard]] ReadRecording read_recording(const std::string& path);
/// From a seekable stream; `name` is for messages.
[[nodiscard]] ReadRecording read_recording(std::istream& in, const std::string& name);

/// Writes a whole recording at once. Returns a line that says what failed, or nothing.
[[nodiscard]] std::string write_recording(const Recording& recording, const std::string& path);

/// frames.csv, commands.csv, spikes.csv, and positions.csv if joints were sampled between frames, into a folder that is
/// made if need be; units are in the column names. Returns a line that says what failed, or nothing.
[[nodiscard]] std::string write_recording_csv(const Recording& recording, const std::string& folder);

}  // namespace tectum
