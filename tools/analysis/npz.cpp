#include "tools/analysis/npz.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

namespace tectum {
namespace {

constexpr double kNs = 1e-9;

/// CRC-32 of ZIP (reflected 0x04C11DB7), a nibble at a time.
std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc >> 1U) ^ (0xEDB88320U & (0U - (crc & 1U)));
    }
  }
  return ~crc;
}

/// A ZIP archive of stored members (PKWARE APPNOTE 6.3: local headers, central directory, its end), which is what .npz
/// is. Members stay below 4 GB.
class StoredZip {
 public:
  void add(const std::string& name, const std::string& content) {
    const auto at = static_cast<std::uint32_t>(bytes_.size());
    const std::string fields = fields_of(name, content);
    put32(bytes_, 0x04034b50U);
    bytes_ += fields + name + content;
    put32(directory_, 0x02014b50U);
    put16(directory_, 20);  // made by
    directory_ += fields;
    put16(directory_, 0);  // comment
    put16(directory_, 0);  // disk
    put16(directory_, 0);  // internal attributes
    put32(directory_, 0);  // external attributes
    put32(directory_, at);
    directory_ += name;
    ++count_;
  }
  [[nodiscard]] std::string finish() {
    std::string whole = bytes_ + directory_;
    put32(whole, 0x06054b50U);
    put16(whole, 0);
    put16(whole, 0);
    put16(whole, count_);
    put16(whole, count_);
    put32(whole, static_cast<std::uint32_t>(directory_.size()));
    put32(whole, static_cast<std::uint32_t>(bytes_.size()));
    put16(whole, 0);
    return whole;
  }

 private:
  /// What a local header and a directory entry have in common.
  static std::string fields_of(const std::string& name, const std::string& content) {
    std::string fields;
    put16(fields, 20);  // version needed
    put16(fields, 0);   // flags
    put16(fields, 0);   // stored
    put16(fields, 0);   // time
    put16(fields, 33);  // 1 January 1980
    put32(fields, crc32(content));
    put32(fields, static_cast<std::uint32_t>(content.size()));
    put32(fields, static_cast<std::uint32_t>(content.size()));
    put16(fields, static_cast<std::uint16_t>(name.size()));
    put16(fields, 0);  // extra
    return fields;
  }
  static void put16(std::string& out, std::uint16_t value) {
    out += static_cast<char>(value & 0xFFU);
    out += static_cast<char>(value >> 8U);
  }
  static void put32(std::string& out, std::uint32_t value) {
    put16(out, static_cast<std::uint16_t>(value & 0xFFFFU));
    put16(out, static_cast<std::uint16_t>(value >> 16U));
  }
  std::string bytes_, directory_;
  std::uint16_t count_ = 0;
};

template <typename Number>
constexpr const char* kTypeName = nullptr;
template <>
constexpr const char* kTypeName<double> = "<f8";
template <>
constexpr const char* kTypeName<std::uint64_t> = "<u8";
template <>
constexpr const char* kTypeName<std::uint32_t> = "<u4";

/// A .npy file, format 1.0: magic, a header padded to 64 bytes, the numbers row by row.
template <typename Number>
std::string npy(const std::vector<Number>& values, const std::vector<std::size_t>& row_shape) {
  std::size_t row = 1;
  std::string shape;
  for (const std::size_t extent : row_shape) {
    row *= extent;
    shape += ", " + std::to_string(extent);
  }
  std::string header = std::string("{'descr': '") + kTypeName<Number> + "', 'fortran_order': False, 'shape': (" +
                       std::to_string(values.size() / row) + (shape.empty() ? "," : shape) + "), }";
  constexpr std::size_t kBeforeHeader = 10;
  header.append(63 - (kBeforeHeader + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xFFU);
  bytes += static_cast<char>(header.size() >> 8U);
  bytes += header;
  const std::size_t at = bytes.size();
  bytes.resize(at + values.size() * sizeof(Number));
  if (!values.empty()) {
    std::memcpy(bytes.data() + at, values.data(), values.size() * sizeof(Number));
  }
  return bytes;
}

template <typename Range>
void append(std::vector<double>& to, const Range& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void add_frames(const Recording& recording, StoredZip& zip) {
  std::vector<double> time_s, captured_s, decoded, goal, position, late_s, stage_s;
  std::vector<std::uint64_t> tick;
  std::vector<std::uint32_t> guard_state;
  for (const RecordedFrame& frame : recording.frames) {
    time_s.push_back(static_cast<double>(frame.time_ns) * kNs);
    tick.push_back(frame.tick);
    for (const TimeNs captured_ns : frame.captured_ns) {
      captured_s.push_back(static_cast<double>(captured_ns) * kNs);
    }
    append(decoded, frame.decoded_deg);
    append(goal, frame.goal_deg);
    append(position, frame.position_deg);
    guard_state.push_back(frame.guard_state);
    late_s.push_back(static_cast<double>(frame.late_ns) * kNs);
    for (const TimeNs stage_ns : frame.stage_ns) {
      stage_s.push_back(static_cast<double>(stage_ns) * kNs);
    }
  }
  zip.add("time_s.npy", npy(time_s, {}));
  zip.add("tick.npy", npy(tick, {}));
  zip.add("captured_s.npy", npy(captured_s, {kEyeCount}));
  zip.add("decoded_deg.npy", npy(decoded, {kJointCount}));
  zip.add("goal_deg.npy", npy(goal, {kJointCount}));
  zip.add("position_deg.npy", npy(position, {kJointCount}));
  zip.add("guard_state.npy", npy(guard_state, {}));
  zip.add("late_s.npy", npy(late_s, {}));
  zip.add("stage_s.npy", npy(stage_s, {5}));
}

void add_fields(const Recording& recording, StoredZip& zip) {
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    std::vector<std::uint32_t> pairs;
    for (std::size_t k = 0; k < recording.frames.size(); ++k) {
      for (const std::uint32_t field : recording.frames[k].active_fields[e]) {
        pairs.push_back(static_cast<std::uint32_t>(k));
        pairs.push_back(field);
      }
    }
    zip.add(e == 0 ? "left_fields.npy" : "right_fields.npy", npy(pairs, {2}));
  }
}

void add_spikes(const Recording& recording, StoredZip& zip) {
  std::vector<std::uint64_t> tick;
  std::vector<std::uint32_t> neuron, first, size;
  for (const RecordedSpike& spike : recording.spikes) {
    tick.push_back(spike.tick);
    neuron.push_back(spike.neuron);
  }
  for (const RecordedPopulation& population : recording.populations) {
    first.push_back(population.first_neuron);
    size.push_back(population.size);
  }
  zip.add("spike_tick.npy", npy(tick, {}));
  zip.add("spike_neuron.npy", npy(neuron, {}));
  zip.add("population_first_neuron.npy", npy(first, {}));
  zip.add("population_size.npy", npy(size, {}));
}

void add_positions(const Recording& recording, StoredZip& zip) {
  std::vector<double> time_s, position;
  for (const RecordedPositions& sample : recording.positions) {
    time_s.push_back(static_cast<double>(sample.time_ns) * kNs);
    append(position, sample.position_deg);
  }
  if (!time_s.empty()) {
    zip.add("sampled_time_s.npy", npy(time_s, {}));
    zip.add("sampled_position_deg.npy", npy(position, {kJointCount}));
  }
}

void add_truth_arrays(const Recording& recording, StoredZip& zip) {
  std::vector<double> error, target;
  for (const RecordedFrame& frame : recording.frames) {
    if (!frame.has_truth) {
      return;
    }
    append(target, frame.target_on_wall_m);
    for (const EyeTruth& eye : frame.eye) {
      append(error, std::array{eye.error_pan_deg, eye.error_tilt_deg});
    }
  }
  zip.add("error_deg.npy", npy(error, {kEyeCount, 2}));
  zip.add("target_m.npy", npy(target, {2}));
}

}  // namespace

std::string write_recording_npz(const Recording& recording, const std::string& path) {
  StoredZip zip;
  add_frames(recording, zip);
  add_fields(recording, zip);
  add_spikes(recording, zip);
  add_positions(recording, zip);
  add_truth_arrays(recording, zip);
  std::error_code ignored;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) {
    std::filesystem::create_directories(parent, ignored);
  }
  std::ofstream file(path, std::ios::binary);
  file << zip.finish();
  file.close();
  return file ? "" : "cannot write `" + path + "`";
}

}  // namespace tectum
