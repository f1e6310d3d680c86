#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <type_traits>

#include "runtime/record/recording_file.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

/// Rows of comma-separated cells. Numbers are written with the fewest digits that read back exactly.
class CsvFile {
 public:
  explicit CsvFile(const fs::path& path) : file_(path, std::ios::binary) {}
  CsvFile& text(std::string_view value) {
    file_ << (is_first_ ? "" : ",") << value;
    is_first_ = false;
    return *this;
  }
  template <typename Number>
  CsvFile& number(Number value) {
    std::array<char, 32> digits{};
    char* const end = digits.data() + digits.size();
    const char* written = nullptr;
    if constexpr (std::is_floating_point_v<Number>) {
      written = std::to_chars(digits.data(), end, value, std::chars_format::general).ptr;
    } else {
      written = std::to_chars(digits.data(), end, value).ptr;
    }
    return text({digits.data(), static_cast<std::size_t>(written - digits.data())});
  }
  CsvFile& seconds(TimeNs time_ns) { return number(static_cast<double>(time_ns) / 1e9); }
  void end_row() {
    file_ << '\n';
    is_first_ = true;
  }
  [[nodiscard]] bool close() {
    file_.close();
    return !file_.fail();
  }

 private:
  std::ofstream file_;
  bool is_first_ = true;
};

/// Field indices apart by spaces, so that they stay in one cell.
std::string list_of(const std::vector<std::uint32_t>& fields) {
  std::string text;
  for (const std::uint32_t field : fields) {
    text += (text.empty() ? "" : " ") + std::to_string(field);
  }
  return text;
}

constexpr std::array<std::string_view, kEyeCount> kEyeNames = {"left", "right"};

bool write_frames(const Recording& recording, const fs::path& path) {
  CsvFile csv(path);
  csv.text("tick").text("time_s");
  for (const std::string_view eye : kEyeNames) {
    csv.text(std::string(eye) + "_captured_s").text(std::string(eye) + "_active_fields");
  }
  csv.text("has_truth").text("target_right_m").text("target_up_m");
  for (const std::string_view eye : kEyeNames) {
    for (const std::string_view what : {"target_pan_deg", "target_tilt_deg", "error_pan_deg", "error_tilt_deg",
                                        "gaze_pan_deg", "gaze_tilt_deg", "gaze_right_m", "gaze_up_m"}) {
      csv.text(std::string(eye) + "_" + std::string(what));
    }
  }
  csv.end_row();
  for (const RecordedFrame& frame : recording.frames) {
    csv.number(frame.tick).seconds(frame.time_ns);
    for (std::size_t e = 0; e < kEyeCount; ++e) {
      csv.seconds(frame.captured_ns[e]).text(list_of(frame.active_fields[e]));
    }
    csv.number(frame.has_truth ? 1 : 0).number(frame.target_on_wall_m[0]).number(frame.target_on_wall_m[1]);
    for (const EyeTruth& eye : frame.eye) {
      for (const double value : {eye.target_pan_deg, eye.target_tilt_deg, eye.error_pan_deg, eye.error_tilt_deg,
                                 eye.gaze_pan_deg, eye.gaze_tilt_deg, eye.gaze_on_wall_m[0], eye.gaze_on_wall_m[1]}) {
        csv.number(value);
      }
    }
    csv.end_row();
  }
  return csv.close();
}

bool write_commands(const Recording& recording, const fs::path& path) {
  CsvFile csv(path);
  csv.text("time_s");
  for (const std::string_view what : {"decoded", "goal", "position"}) {
    for (const char* joint : kJointNames) {
      csv.text(std::string(joint) + "_" + std::string(what) + "_deg");
    }
  }
  csv.end_row();
  for (const RecordedFrame& frame : recording.frames) {
    csv.seconds(frame.time_ns);
    for (const auto& angles : {frame.decoded_deg, frame.goal_deg, frame.position_deg}) {
      for (const double angle_deg : angles) {
        csv.number(angle_deg);
      }
    }
    csv.end_row();
  }
  return csv.close();
}

bool write_positions(const Recording& recording, const fs::path& path) {
  CsvFile csv(path);
  csv.text("time_s");
  for (const char* joint : kJointNames) {
    csv.text(std::string(joint) + "_deg");
  }
  csv.end_row();
  for (const RecordedPositions& sample : recording.positions) {
    csv.seconds(sample.time_ns);
    for (const double angle_deg : sample.position_deg) {
      csv.number(angle_deg);
    }
    csv.end_row();
  }
  return csv.close();
}

bool write_spikes(const Recording& recording, const fs::path& path) {
  std::vector<RecordedPopulation> populations = recording.populations;
  std::sort(populations.begin(), populations.end(),
            [](const auto& a, const auto& b) { return a.first_neuron < b.first_neuron; });
  const auto population_of = [&populations](std::uint32_t neuron) -> std::string_view {
    const auto after = std::upper_bound(populations.begin(), populations.end(), neuron,
                                        [](std::uint32_t n, const auto& p) { return n < p.first_neuron; });
    const bool is_in = after != populations.begin() && neuron - std::prev(after)->first_neuron < std::prev(after)->size;
    return is_in ? std::string_view(std::prev(after)->name) : std::string_view();
  };
  CsvFile csv(path);
  csv.text("tick").text("time_s").text("neuron").text("population").end_row();
  for (const RecordedSpike& spike : recording.spikes) {
    csv.number(spike.tick)
        .seconds(static_cast<TimeNs>(spike.tick * recording.tick_ns))
        .number(spike.neuron)
        .text(population_of(spike.neuron))
        .end_row();
  }
  return csv.close();
}

}  // namespace

std::string write_recording_csv(const Recording& recording, const std::string& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) {
    return "cannot make the folder `" + folder + "`: " + problem.message();
  }
  const fs::path base(folder);
  using Write = bool (*)(const Recording&, const fs::path&);
  for (const auto& [name, write] : {std::pair<const char*, Write>{"frames.csv", write_frames},
                                    {"commands.csv", write_commands},
                                    {"spikes.csv", write_spikes}}) {
    if (!write(recording, base / name)) {
      return "cannot write `" + (base / name).string() + "`";
    }
  }
  if (!recording.positions.empty() && !write_positions(recording, base / "positions.csv")) {
    return "cannot write `" + (base / "positions.csv").string() + "`";
  }
  return "";
}

}  // namespace tectum
