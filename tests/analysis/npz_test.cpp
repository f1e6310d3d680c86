#include "tools/analysis/npz.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

using namespace tectum;

namespace {

std::string written(const Recording& recording) {
  const auto path = std::filesystem::temp_directory_path() / ("tectum-npz-" + std::to_string(::getpid()) + ".npz");
  REQUIRE(write_recording_npz(recording, path.string()) == "");
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(path);
  return bytes;
}

template <typename Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The member's .npy file, found the way a reader of ZIP files does: from the directory at the end.
std::string member(const std::string& zip, const std::string& name) {
  const std::size_t end = zip.size() - 22;
  REQUIRE(number_at<std::uint32_t>(zip, end) == 0x06054b50U);
  std::size_t at = number_at<std::uint32_t>(zip, end + 16);
  for (int left = number_at<std::uint16_t>(zip, end + 10); left > 0; --left) {
    REQUIRE(number_at<std::uint32_t>(zip, at) == 0x02014b50U);
    const auto size = number_at<std::uint32_t>(zip, at + 20);
    const auto name_size = number_at<std::uint16_t>(zip, at + 28);
    const std::size_t local = number_at<std::uint32_t>(zip, at + 42);
    if (zip.substr(at + 46, name_size) == name) {
      return zip.substr(local + 30 + number_at<std::uint16_t>(zip, local + 26), size);
    }
    at += 46U + name_size;
  }
  return "";
}

Recording two_turns() {
  Recording recording;
  recording.populations = {{"EBN.left", "", 0, 3}};
  for (std::uint32_t k = 0; k < 2; ++k) {
    RecordedFrame frame;
    frame.tick = 20 * k;
    frame.time_ns = 1'500'000'000 + k;
    frame.goal_deg = {1.5 + k, 2, 3, 4, 5, 6.25};
    frame.active_fields[1] = {7 + k};
    recording.frames.push_back(frame);
    recording.spikes.push_back({20 * k + 3, k});
  }
  return recording;
}

}  // namespace

TEST_CASE("arrays have the shapes and numbers of the recording") {
  const std::string zip = written(two_turns());
  const std::string goal = member(zip, "goal_deg.npy");
  REQUIRE(goal.size() == 128 + 12 * sizeof(double));
  CHECK(goal.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  CHECK(number_at<std::uint16_t>(goal, 8) == 118);
  CHECK(goal.substr(10, 60).find("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 6), }") == 0);
  CHECK(goal[127] == '\n');
  CHECK(number_at<double>(goal, 128) == 1.5);
  CHECK(number_at<double>(goal, 128 + 5 * 8) == 6.25);
  CHECK(number_at<double>(goal, 128 + 6 * 8) == 2.5);
  const std::string ticks = member(zip, "spike_tick.npy");
  CHECK(ticks.find("'shape': (2,), }") != std::string::npos);
  CHECK(number_at<std::uint64_t>(ticks, 128 + 8) == 23);
  const std::string fields = member(zip, "right_fields.npy");
  CHECK(number_at<std::uint32_t>(fields, 128 + 2 * 4) == 1);
  CHECK(number_at<std::uint32_t>(fields, 128 + 3 * 4) == 8);
  CHECK(member(zip, "sampled_time_s.npy").empty());
  CHECK(member(zip, "error_deg.npy").empty());
}

TEST_CASE("members carry the checksum that ZIP readers look at") {
  // CRC-32 of nine bytes "123456789" is 0xCBF43926 (the check value of every catalogue); here of a real member,
  // computed another way: bit by bit, most significant first, on reflected bytes.
  const std::string zip = written(two_turns());
  const std::size_t end = zip.size() - 22;
  const std::size_t at = number_at<std::uint32_t>(zip, end + 16);
  const auto size = number_at<std::uint32_t>(zip, at + 20);
  const auto name_size = number_at<std::uint16_t>(zip, 26);
  std::uint32_t crc = 0xFFFFFFFFU;
  const auto reflect = [](std::uint32_t value, int bits) {
    std::uint32_t mirrored = 0;
    for (int bit = 0; bit < bits; ++bit) {
      mirrored |= (value >> bit & 1U) << (bits - 1 - bit);
    }
    return mirrored;
  };
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= reflect(static_cast<std::uint8_t>(zip[30 + name_size + i]), 8) << 24U;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x80000000U) != 0 ? (crc << 1U) ^ 0x04C11DB7U : crc << 1U;
    }
  }
  CHECK(number_at<std::uint32_t>(zip, at + 16) == reflect(~crc, 32));
}

TEST_CASE("the same recording gives the same bytes") { CHECK(written(two_turns()) == written(two_turns())); }
