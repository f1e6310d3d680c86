// The blocks of a recording file, to and from bytes. Internal to runtime/record.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "runtime/record/block_bytes.h"
#include "runtime/record/recording.h"

namespace tectum {

inline constexpr std::array<char, 8> kRecordingMagic = {'T', 'E', 'C', 'T', 'R', 'E', 'C', '\n'};
inline constexpr std::size_t kFileHeaderBytes = 16;
inline constexpr std::size_t kBlockHeaderBytes = 16;

enum class BlockKind : std::uint32_t {
  Description = 1,
  Run = 2,
  Spikes = 3,
  Frames = 4,
  End = 5,
  Image = 6,
  Positions = 7
};

/// The text of the Description block.
[[nodiscard]] std::string_view recording_description();

/// Of kind, payload size and payload.
[[nodiscard]] std::uint64_t block_checksum(std::uint32_t kind, std::span<const std::byte> payload);

void put_run(const Recording& run, BlockWriter& out);
void put_frame(const RecordedFrame& frame, BlockWriter& out);
/// Bytes that put_frame writes at most for this run's retinas.
[[nodiscard]] std::size_t largest_frame_bytes(const Recording& run);

inline constexpr std::size_t kPositionsBytes = sizeof(TimeNs) + kJointCount * sizeof(double);
void put_positions(const RecordedPositions& positions, BlockWriter& out);

/// Each appends to `out` what the payload says; false when the payload is not what its kind says.
[[nodiscard]] bool get_run(BlockReader& in, Recording& out);
[[nodiscard]] bool get_frames(BlockReader& in, Recording& out);
[[nodiscard]] bool get_spikes(BlockReader& in, Recording& out);
[[nodiscard]] bool get_positions(BlockReader& in, Recording& out);

}  // namespace tectum
