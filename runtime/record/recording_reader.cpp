#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "runtime/record/blocks.h"
#include "runtime/record/recording_file.h"

namespace tectum {
namespace {

// Blocks are far smaller; a larger length comes from a damaged file.
constexpr std::uint32_t kMaxPayloadBytes = 1U << 30U;

struct Block {
  BlockKind kind{};
  std::vector<std::byte> payload;
};

/// Reads one block. On a cut or damaged one, says why and returns false; `problem` is empty at the end of the file.
bool read_block(std::istream& file, std::uint64_t bytes_left, Block& block, std::string& problem) {
  problem.clear();
  if (bytes_left == 0) {
    return false;
  }
  std::array<char, kBlockHeaderBytes> header{};
  if (bytes_left < kBlockHeaderBytes || !file.read(header.data(), kBlockHeaderBytes)) {
    problem = "in the middle of a block's header";
    return false;
  }
  std::uint32_t kind = 0, size = 0;
  std::uint64_t checksum = 0;
  std::memcpy(&kind, header.data(), sizeof kind);
  std::memcpy(&size, header.data() + 4, sizeof size);
  std::memcpy(&checksum, header.data() + 8, sizeof checksum);
  if (size > std::min<std::uint64_t>(bytes_left - kBlockHeaderBytes, kMaxPayloadBytes)) {
    problem = "in the middle of a block";
    return false;
  }
  block.kind = static_cast<BlockKind>(kind);
  block.payload.resize(size);
  if (!file.read(reinterpret_cast<char*>(block.payload.data()), size)) {
    problem = "in the middle of a block";
    return false;
  }
  if (block_checksum(kind, block.payload) != checksum) {
    problem = "at a block whose checksum is wrong";
    return false;
  }
  return true;
}

/// Adds a block to what has been read; false when it says something else than its kind should.
bool take_block(const Block& block, ReadRecording& read, bool& has_run, bool& has_ended) {
  BlockReader in(block.payload);
  Recording& recording = read.recording;
  switch (block.kind) {
    case BlockKind::Description:
      return true;
    case BlockKind::Run: {
      if (has_run || !get_run(in, recording)) {
        return false;
      }
      has_run = true;
      return true;
    }
    case BlockKind::Spikes: {
      const std::size_t before = recording.spikes.size();
      if (has_run && get_spikes(in, recording)) {
        return true;
      }
      recording.spikes.resize(before);
      return false;
    }
    case BlockKind::Frames: {
      const std::size_t before = recording.frames.size();
      if (has_run && get_frames(in, recording)) {
        return true;
      }
      recording.frames.resize(before);
      return false;
    }
    case BlockKind::Positions: {
      const std::size_t before = recording.positions.size();
      if (has_run && get_positions(in, recording)) {
        return true;
      }
      recording.positions.resize(before);
      return false;
    }
    case BlockKind::Image:
      recording.image = block.payload;
      return has_run && recording.frames.empty();
    case BlockKind::End: {
      in.get(recording.duration_s);
      has_ended = has_run && in.is_whole() && in.is_at_end();
      return has_ended;
    }
  }
  return false;
}

}  // namespace

ReadRecording read_recording(const std::string& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    ReadRecording read;
    read.error = "`" + path + "`: " + (errno != 0 ? std::strerror(errno) : "cannot be opened");
    return read;
  }
  return read_recording(file, path);
}

ReadRecording read_recording(std::istream& file, const std::string& path) {
  ReadRecording read;
  const std::streamoff size = file.seekg(0, std::ios::end) ? static_cast<std::streamoff>(file.tellg()) : -1;
  if (size < 0 || !file.seekg(0)) {
    read.error = "cannot read `" + path + "`";
    return read;
  }
  const auto file_bytes = static_cast<std::uint64_t>(size);
  std::array<char, kFileHeaderBytes> header{};
  if (!file.read(header.data(), kFileHeaderBytes) ||
      !std::equal(kRecordingMagic.begin(), kRecordingMagic.end(), header.begin())) {
    read.error = "`" + path + "` is no recording: it does not start with the mark of one";
    return read;
  }
  std::uint32_t version = 0;
  std::memcpy(&version, header.data() + kRecordingMagic.size(), sizeof version);
  if (version != kRecordingVersion) {
    read.error = "`" + path + "` is a recording of version " + std::to_string(version) +
                 "; this program reads version " + std::to_string(kRecordingVersion);
    return read;
  }
  read.valid_bytes = kFileHeaderBytes;
  bool has_run = false, has_ended = false;
  Block block;
  std::string problem;
  while (!has_ended && read_block(file, file_bytes - read.valid_bytes, block, problem)) {
    if (!take_block(block, read, has_run, has_ended)) {
      problem = "at a block that says nothing known";
      break;
    }
    read.valid_bytes += kBlockHeaderBytes + block.payload.size();
  }
  if (!has_run) {
    read.error = "`" + path + "` ends before it says what was run";
    return read;
  }
  read.is_truncated = !has_ended;
  if (read.is_truncated) {
    Recording& recording = read.recording;
    recording.duration_s =
        static_cast<double>(recording.frames.size()) * static_cast<double>(recording.frame_period_ns) * 1e-9;
    read.ending = "ends after byte " + std::to_string(read.valid_bytes) + " of " + std::to_string(file_bytes) + ", " +
                  (problem.empty() ? "without an end block" : problem) + ": " +
                  std::to_string(recording.frames.size()) + " frames are whole";
  }
  return read;
}

}  // namespace tectum
