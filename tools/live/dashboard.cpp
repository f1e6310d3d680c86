#include "tools/live/dashboard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tectum {
namespace {

constexpr int kEyeColumns = 36, kEyeRows = 18;  // a letter is about twice as high as it is wide
constexpr std::size_t kHistory = 60;
constexpr std::size_t kLines = 5;
constexpr std::size_t kRasterRows = 14;
constexpr std::string_view kShades = " .:-=+*#%@";
constexpr const char* kHome = "\x1b[H";
constexpr const char* kEndOfLine = "\x1b[K\n";
constexpr const char* kEndOfScreen = "\x1b[J";

std::string bar(double value, double most, int half_width) {
  const int at = static_cast<int>(std::lround(std::clamp(value / most, -1.0, 1.0) * half_width)) + half_width;
  std::string text(static_cast<std::size_t>(2 * half_width + 1), '-');
  text[static_cast<std::size_t>(half_width)] = '|';
  text[static_cast<std::size_t>(at)] = 'o';
  return text;
}

}  // namespace

Dashboard::Dashboard(const SpikeImage& image) : image_(image) {}

void Dashboard::add_line(const std::string& text) {
  lines_.push_back(text);
  if (lines_.size() > kLines) {
    lines_.pop_front();
  }
}

/// Rows of both eyes side by side: dots where receptive fields are, shade where they are active.
std::vector<std::string> Dashboard::eyes(const RecordedFrame& frame) const {
  std::vector<std::string> rows(kEyeRows);
  for (std::size_t e = 0; e < kEyeCount; ++e) {
    std::vector<std::string> picture(kEyeRows, std::string(kEyeColumns, ' '));
    std::uint32_t first = 0;
    for (const RetinaRecord& retina : image_.retinas) {
      if (static_cast<std::size_t>(retina.eye) != e) {
        continue;
      }
      const double across = static_cast<double>(retina.frame_width) / kEyeColumns;
      const double down = static_cast<double>(retina.frame_height) / kEyeRows;
      for (std::uint32_t f = 0; f < retina.field_count; ++f) {
        const FieldRecord& field = image_.fields[retina.first_field + f];
        const bool is_active =
            std::binary_search(frame.active_fields[e].begin(), frame.active_fields[e].end(), first + f);
        const auto x = std::clamp(static_cast<int>((field.x0 + field.x1) / 2 / across), 0, kEyeColumns - 1);
        const auto y = std::clamp(static_cast<int>((field.y0 + field.y1) / 2 / down), 0, kEyeRows - 1);
        char& cell = picture[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
        cell = is_active ? '@' : (cell == '@' ? '@' : '.');
      }
      first += retina.field_count;
    }
    for (std::size_t y = 0; y < rows.size(); ++y) {
      rows[y] += fmt::format("{}|{}|", e == 0 ? "" : "  ", picture[y]);
    }
  }
  return rows;
}

std::string Dashboard::raster_row(std::size_t population) const {
  const double size = image_.populations[population].size;
  std::string row;
  for (const std::vector<std::uint32_t>& spikes : history_) {
    const double each = population < spikes.size() ? spikes[population] / size : 0;  // spikes a neuron and turn
    const auto shade = static_cast<std::size_t>(std::lround(std::min(1.0, each / 4) * 9));
    row += each > 0 ? kShades[std::max<std::size_t>(shade, 1)] : ' ';
  }
  return row;
}

std::string Dashboard::draw(const LiveGlimpse& glimpse) {
  history_.push_back(glimpse.spikes_of_population);
  if (history_.size() > kHistory) {
    history_.pop_front();
  }
  std::string text = kHome;
  const auto line = [&](const std::string& content) { text += content + kEndOfLine; };
  line(fmt::format("{:7.1f} s   guard {:<12} camera {:5.0f} ms old   late {:6.2f} ms", glimpse.time_s,
                   kGuardStateNames[static_cast<std::size_t>(glimpse.state)],
                   static_cast<double>(glimpse.frame.camera_age_ns) * 1e-6,
                   static_cast<double>(glimpse.frame.late_ns) * 1e-6));
  line(fmt::format("{:<{}}  {}", "left eye", kEyeColumns + 2, "right eye"));
  for (const std::string& row : eyes(glimpse.frame)) {
    line(row);
  }
  for (std::size_t j = 0; j < kJointCount; ++j) {
    line(fmt::format("{:<15} {} {:+6.1f} deg, goal {:+6.1f}", kHeadJointNames[j],
                     bar(glimpse.frame.position_deg[j], 50, 20), glimpse.frame.position_deg[j],
                     glimpse.frame.goal_deg[j]));
  }
  // The populations whose rates change most, in the circuit's order: those that only hum say nothing.
  std::vector<std::size_t> order(image_.populations.size());
  std::vector<double> changes(order.size());
  for (std::size_t p = 0; p < order.size(); ++p) {
    order[p] = p;
    for (std::size_t k = 1; k < history_.size() && p < history_[k].size() && p < history_[k - 1].size(); ++k) {
      const double change = std::abs(static_cast<double>(history_[k][p]) - static_cast<double>(history_[k - 1][p]));
      changes[p] += change / image_.populations[p].size;
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return changes[a] > changes[b]; });
  order.resize(std::min(order.size(), kRasterRows));
  std::sort(order.begin(), order.end());
  for (const std::size_t p : order) {
    line(fmt::format("{:<18.18} {}", image_.name(image_.populations[p].name), raster_row(p)));
  }
  for (const std::string& told : lines_) {
    line(told);
  }
  return text + kEndOfScreen;
}

}  // namespace tectum
