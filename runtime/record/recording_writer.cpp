#include <algorithm>
#include <cstdio>

#include "runtime/record/blocks.h"
#include "runtime/record/recording_file.h"

namespace tectum {
namespace {

// At 45 Hz a killed process loses less than 0.4 s.
constexpr std::uint32_t kFramesPerBlock = 16;
constexpr std::size_t kSpikeBlockBytes = std::size_t{1} << 16U;
constexpr std::size_t kSpikeBytes = 8;
constexpr std::uint32_t kPositionsPerBlock = 1024;
constexpr std::uint64_t kMaxTickOffset = 0xFFFFFFFFU;

/// Neurons that can fire in one tick. Capped, since a recording read from a file can claim any number.
std::size_t neuron_count(const Recording& run) {
  std::size_t count = 0;
  for (const RecordedPopulation& population : run.populations) {
    count = std::max<std::size_t>(count, std::size_t{population.first_neuron} + population.size);
  }
  return std::min<std::size_t>(count, std::size_t{1} << 24U);
}

}  // namespace

struct RecordingWriter::Impl {
  std::FILE* file = nullptr;
  std::string path;
  std::string error;
  bool has_failed = false;
  BlockWriter frames, spikes, between;
  std::uint32_t frame_count = 0, spike_count = 0, between_count = 0;
  std::uint64_t first_tick = 0;

  ~Impl() { close(); }
  void close() {
    if (file != nullptr && std::fclose(file) != 0) {
      has_failed = true;
    }
    file = nullptr;
  }
  void put(std::span<const std::byte> bytes) {
    has_failed = has_failed || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size();
  }
  void put_block(BlockKind kind, std::span<const std::byte> payload);
  void flush_spikes();
  void flush_positions();
  void flush_frames();
};

void RecordingWriter::Impl::put_block(BlockKind kind, std::span<const std::byte> payload) {
  if (file == nullptr || has_failed) {
    return;
  }
  const auto number = static_cast<std::uint32_t>(kind);
  const auto size = static_cast<std::uint32_t>(payload.size());
  const std::uint64_t checksum = block_checksum(number, payload);
  std::array<std::byte, kBlockHeaderBytes> header{};
  std::memcpy(header.data(), &number, sizeof number);
  std::memcpy(header.data() + 4, &size, sizeof size);
  std::memcpy(header.data() + 8, &checksum, sizeof checksum);
  put(header);
  put(payload);
  // Handed to the system at once: a block that is written survives the process.
  has_failed = has_failed || std::fflush(file) != 0;
}

void RecordingWriter::Impl::flush_spikes() {
  if (spike_count > 0) {
    std::memcpy(spikes.bytes.data(), &first_tick, sizeof first_tick);
    std::memcpy(spikes.bytes.data() + sizeof first_tick, &spike_count, sizeof spike_count);
    put_block(BlockKind::Spikes, spikes.bytes);
  }
  spikes.bytes.resize(sizeof first_tick + sizeof spike_count);
  spike_count = 0;
}

void RecordingWriter::Impl::flush_positions() {
  if (between_count > 0) {
    std::memcpy(between.bytes.data(), &between_count, sizeof between_count);
    put_block(BlockKind::Positions, between.bytes);
  }
  between.bytes.resize(sizeof between_count);
  between_count = 0;
}

void RecordingWriter::Impl::flush_frames() {
  flush_spikes();
  flush_positions();
  if (frame_count > 0) {
    std::memcpy(frames.bytes.data(), &frame_count, sizeof frame_count);
    put_block(BlockKind::Frames, frames.bytes);
  }
  frames.bytes.resize(sizeof frame_count);
  frame_count = 0;
}

RecordingWriter::RecordingWriter() : impl_(std::make_unique<Impl>()) {}
RecordingWriter::~RecordingWriter() = default;

bool RecordingWriter::open(const std::string& path, const Recording& run) {
  impl_ = std::make_unique<Impl>();
  Impl& out = *impl_;
  out.path = path;
  out.file = std::fopen(path.c_str(), "wb");
  if (out.file == nullptr) {
    out.error = "cannot write `" + path + "`";
    return false;
  }
  out.frames.bytes.reserve(kFramesPerBlock * largest_frame_bytes(run) + sizeof(std::uint32_t));
  out.spikes.bytes.reserve(kSpikeBlockBytes + kSpikeBytes * (neuron_count(run) + 2));

  out.between.bytes.reserve(kPositionsPerBlock * kPositionsBytes + sizeof(std::uint32_t));

  BlockWriter header;
  header.put_all(kRecordingMagic);
  header.put(kRecordingVersion);
  header.put(std::uint32_t{0});
  out.put(header.bytes);
  out.put_block(BlockKind::Description, std::as_bytes(std::span(recording_description())));
  BlockWriter facts;
  put_run(run, facts);
  out.put_block(BlockKind::Run, facts.bytes);
  if (!run.image.empty()) {
    out.put_block(BlockKind::Image, run.image);
  }
  out.flush_frames();  // nothing yet: leaves room for the counts
  if (out.has_failed) {
    out.error = "cannot write to `" + path + "`";
  }
  return !out.has_failed;
}

void RecordingWriter::take(std::uint64_t tick, std::span<const NeuronId> spikes) noexcept {
  Impl& out = *impl_;
  if (out.file == nullptr || spikes.empty()) {
    return;
  }
  if (out.spikes.bytes.size() >= kSpikeBlockBytes || (out.spike_count > 0 && tick - out.first_tick > kMaxTickOffset)) {
    out.flush_spikes();
  }
  if (out.spike_count == 0) {
    out.first_tick = tick;
  }
  for (const NeuronId neuron : spikes) {
    out.spikes.put(static_cast<std::uint32_t>(tick - out.first_tick));
    out.spikes.put(static_cast<std::uint32_t>(neuron));
  }
  out.spike_count += static_cast<std::uint32_t>(spikes.size());
}

bool RecordingWriter::frame(const RecordedFrame& frame) noexcept {
  Impl& out = *impl_;
  if (out.file == nullptr || out.has_failed) {
    return false;
  }
  put_frame(frame, out.frames);
  if (++out.frame_count == kFramesPerBlock) {
    out.flush_frames();
  }
  return !out.has_failed;
}

void RecordingWriter::positions(const RecordedPositions& positions) noexcept {
  Impl& out = *impl_;
  if (out.file == nullptr) {
    return;
  }
  put_positions(positions, out.between);
  if (++out.between_count == kPositionsPerBlock) {
    out.flush_positions();
  }
}

bool RecordingWriter::finish(double duration_s) {
  Impl& out = *impl_;
  if (out.file == nullptr) {
    return false;
  }
  out.flush_frames();
  BlockWriter end;
  end.put(duration_s);
  out.put_block(BlockKind::End, end.bytes);
  out.close();
  if (out.has_failed) {
    out.error = "cannot write to `" + out.path + "`";
  }
  return !out.has_failed;
}

const std::string& RecordingWriter::error() const noexcept { return impl_->error; }

std::string write_recording(const Recording& recording, const std::string& path) {
  RecordingWriter writer;
  if (!writer.open(path, recording)) {
    return writer.error();
  }
  std::vector<NeuronId> of_tick;
  std::size_t next = 0;
  const auto take_before = [&](std::uint64_t end_tick) {
    while (next < recording.spikes.size() && recording.spikes[next].tick < end_tick) {
      const std::uint64_t tick = recording.spikes[next].tick;
      of_tick.clear();
      for (; next < recording.spikes.size() && recording.spikes[next].tick == tick; ++next) {
        of_tick.push_back(NeuronId{recording.spikes[next].neuron});
      }
      writer.take(tick, of_tick);
    }
  };
  bool is_written = true;
  for (const RecordedPositions& positions : recording.positions) {
    writer.positions(positions);
  }
  for (std::size_t k = 0; k < recording.frames.size() && is_written; ++k) {
    const bool is_last = k + 1 == recording.frames.size();
    take_before(is_last ? ~std::uint64_t{0} : recording.frames[k + 1].tick);
    is_written = writer.frame(recording.frames[k]);
  }
  take_before(~std::uint64_t{0});
  return writer.finish(recording.duration_s) && is_written ? "" : writer.error();
}

}  // namespace tectum
