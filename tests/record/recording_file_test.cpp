#include "runtime/record/recording_file.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "tests/record/recording_fixture.h"

using namespace tectum;

namespace {

void check_prefix(const Recording& part, const Recording& whole) {
  REQUIRE(part.frames.size() <= whole.frames.size());
  for (std::size_t k = 0; k < part.frames.size(); ++k) {
    REQUIRE(same_frame(part.frames[k], whole.frames[k]));
  }
  REQUIRE(part.spikes.size() <= whole.spikes.size());
  REQUIRE(std::equal(part.spikes.begin(), part.spikes.end(), whole.spikes.begin()));
}

ReadRecording read_bytes(const std::string& bytes) {
  std::istringstream in(bytes);
  return read_recording(in, "bytes");
}

/// As a process that was killed leaves it: never finished.
void record_unfinished(const Recording& recording, const std::string& path) {
  RecordingWriter writer;
  REQUIRE(writer.open(path, recording));
  for (const RecordedFrame& frame : recording.frames) {
    REQUIRE(writer.frame(frame));
  }
}

}  // namespace

TEST_CASE("what is written is read back, bit for bit") {
  const ScratchPath path("whole.rec");
  const Recording written = small_recording(40);  // two full blocks and a part of one
  REQUIRE(write_recording(written, path.str()) == "");
  const ReadRecording read = read_recording(path.str());
  REQUIRE(read.error == "");
  CHECK_FALSE(read.is_truncated);
  CHECK(read.valid_bytes == bytes_of(path.str()).size());
  const Recording& r = read.recording;
  CHECK(r.circuit_name == written.circuit_name);
  CHECK(r.scenario == written.scenario);
  CHECK(r.seed == written.seed);
  CHECK(r.image_checksum == written.image_checksum);
  CHECK(r.tick_ns == written.tick_ns);
  CHECK(r.frame_period_ns == written.frame_period_ns);
  CHECK(r.duration_s == written.duration_s);
  CHECK(r.wall_distance_m == written.wall_distance_m);
  REQUIRE(r.populations.size() == 2);
  CHECK(r.populations[0].name == "SC.left");
  CHECK(r.populations[0].nucleus == "SC");
  CHECK(r.populations[1].first_neuron == 3);
  CHECK(r.populations[1].size == 2);
  REQUIRE(r.retinas.size() == 2);
  CHECK(r.retinas[1].name == "right_eye");
  CHECK(r.retinas[1].eye == Eye::Right);
  CHECK(r.retinas[1].field_of_view_deg == 40.5);
  CHECK(r.retinas[0].frame_width == 720);
  CHECK(r.retinas[0].frame_height == 480);
  REQUIRE(r.retinas[0].fields.size() == 2);
  CHECK(r.retinas[0].fields[1].y1 == 7);
  CHECK(r.guard.neutral_deg == written.guard.neutral_deg);
  CHECK(r.guard.ease_speed_deg_s == 8);
  CHECK(r.guard.max_step_ns == 12);
  CHECK(r.image == written.image);
  REQUIRE(r.positions.size() == 40);
  CHECK(r.positions[39].time_ns == written.positions[39].time_ns);
  CHECK(r.positions[39].position_deg == written.positions[39].position_deg);
  CHECK(r.frames.size() == 40);
  CHECK(r.spikes.size() == 120);
  check_prefix(r, written);
}

TEST_CASE("the same run leaves the same bytes") {
  const ScratchPath one("one.rec"), two("two.rec");
  REQUIRE(write_recording(small_recording(20), one.str()) == "");
  REQUIRE(write_recording(small_recording(20), two.str()) == "");
  CHECK(bytes_of(one.str()) == bytes_of(two.str()));
}

TEST_CASE("the file says in words what its fields are") {
  const ScratchPath path("words.rec");
  REQUIRE(write_recording(small_recording(1), path.str()) == "");
  const std::string bytes = bytes_of(path.str());
  for (const char* word : {"TECTREC", "FNV-1a", "goal_deg", "list<spike>", "gaze_on_wall_m"}) {
    CAPTURE(word);
    CHECK(bytes.find(word) != std::string::npos);
  }
}

TEST_CASE("a recording cut at any byte opens, up to its last whole block, and says where it ends") {
  const ScratchPath path("whole.rec");
  const Recording written = small_recording(18);
  REQUIRE(write_recording(written, path.str()) == "");
  const std::string bytes = bytes_of(path.str());
  std::size_t frames_before = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    CAPTURE(size);
    const ReadRecording read = read_bytes(bytes.substr(0, size));
    if (!read.error.empty()) {
      REQUIRE(frames_before == 0);
      REQUIRE(read.recording.frames.empty());
      continue;
    }
    REQUIRE(read.is_truncated);
    REQUIRE(read.valid_bytes <= size);
    REQUIRE(read.ending.find("of " + std::to_string(size)) != std::string::npos);
    check_prefix(read.recording, written);
    REQUIRE(read.recording.frames.size() >= frames_before);
    frames_before = read.recording.frames.size();
  }
  CHECK(frames_before == 18);  // only the end block is cut
}

TEST_CASE("a changed byte is noticed, and what comes before it is kept") {
  const ScratchPath path("whole.rec");
  const Recording written = small_recording(18);
  REQUIRE(write_recording(written, path.str()) == "");
  const std::string bytes = bytes_of(path.str());
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    CAPTURE(at);
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    const ReadRecording read = read_bytes(damaged);
    const bool is_reserved_word = at >= 12 && at < 16;
    REQUIRE((!read.error.empty() || read.is_truncated || is_reserved_word));
    check_prefix(read.recording, written);
  }
}

TEST_CASE("a killed process loses only its last, unfinished block") {
  const ScratchPath path("killed.rec");
  const Recording written = small_recording(40);
  record_unfinished(written, path.str());
  const ReadRecording read = read_recording(path.str());
  REQUIRE(read.error == "");
  CHECK(read.is_truncated);
  CHECK(read.recording.frames.size() == 32);
  CHECK(read.ending.find("without an end block: 32 frames are whole") != std::string::npos);
  CHECK(read.recording.duration_s == doctest::Approx(32 * 0.022222222));
}

TEST_CASE("a frame in the file has all its spikes in the file") {
  const ScratchPath path("spikes.rec");
  const Recording written = small_recording(33);
  RecordingWriter writer;
  REQUIRE(writer.open(path.str(), written));
  for (std::size_t k = 0; k < written.frames.size(); ++k) {
    const NeuronId spikes[] = {NeuronId{0}, NeuronId{4}};
    writer.take(written.frames[k].tick, spikes);
    REQUIRE(writer.frame(written.frames[k]));
  }
  const ReadRecording read = read_recording(path.str());
  CHECK(read.recording.frames.size() == 32);
  CHECK(read.recording.spikes.size() == 64);
}

TEST_CASE("more spikes than a block holds, over ticks further apart than one block spans, survive") {
  const ScratchPath path("many.rec");
  Recording written = small_recording(0);
  for (std::uint64_t tick = 0; tick < 20'000; ++tick) {
    written.spikes.push_back({tick, 1});
    written.spikes.push_back({tick, 3});
  }
  written.spikes.push_back({std::uint64_t{1} << 40U, 2});
  REQUIRE(write_recording(written, path.str()) == "");
  const ReadRecording read = read_recording(path.str());
  REQUIRE(read.error == "");
  CHECK(read.recording.spikes == written.spikes);
}

TEST_CASE("what is no recording is refused with a reason") {
  const ScratchPath path("other.rec");
  CHECK(read_recording(path.str()).error.find("No such file") != std::string::npos);
  CHECK(read_recording(std::filesystem::temp_directory_path().string()).error != "");
  write_bytes(path.str(), "");
  CHECK(read_recording(path.str()).error.find("is no recording") != std::string::npos);
  write_bytes(path.str(), "{ \"name\": \"a circuit, not a recording\" }");
  CHECK(read_recording(path.str()).error.find("is no recording") != std::string::npos);
  write_bytes(path.str(), std::string("TECTREC\n\x09\0\0\0\0\0\0\0", 16));
  CHECK(read_recording(path.str()).error.find("version 9") != std::string::npos);
}

TEST_CASE("a path that cannot be written is an error, and so is a full disk") {
  RecordingWriter writer;
  CHECK_FALSE(writer.open("/nowhere/at/all.rec", small_recording(0)));
  CHECK(writer.error().find("/nowhere/at/all.rec") != std::string::npos);
  CHECK_FALSE(writer.frame({}));
  CHECK_FALSE(writer.finish(0));
  if (std::filesystem::exists("/dev/full")) {
    CHECK_FALSE(writer.open("/dev/full", small_recording(0)));
    CHECK(writer.error() == "cannot write to `/dev/full`");
  }
}

TEST_CASE("the CSV files carry units in their headers and one row each") {
  const ScratchPath folder("csv");
  REQUIRE(write_recording_csv(small_recording(3), folder.str()) == "");
  const std::string spikes = bytes_of(folder.str() + "/spikes.csv");
  CHECK(spikes.starts_with("tick,time_s,neuron,population\n3,0.0003,0,SC.left\n3,0.0003,4,EBN.right\n"));
  CHECK(std::count(spikes.begin(), spikes.end(), '\n') == 10);
  const std::string commands = bytes_of(folder.str() + "/commands.csv");
  CHECK(commands.starts_with("time_s,left_eye_pan_decoded_deg,left_eye_tilt_decoded_deg,"));
  CHECK(std::count(commands.begin(), commands.end(), '\n') == 4);
  const std::string frames = bytes_of(folder.str() + "/frames.csv");
  CHECK(frames.find("left_error_pan_deg") != std::string::npos);
  CHECK(frames.find("\n444,0.044444444,0.044444439,2 2,") != std::string::npos);
  const std::string below_a_file = folder.str() + "/spikes.csv/deeper";
  CHECK(write_recording_csv(small_recording(1), below_a_file).find(below_a_file) != std::string::npos);
}
