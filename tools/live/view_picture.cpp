#include "tools/live/view_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace tectum {
namespace {

// Blue, green, red.
const cv::Scalar kGround(26, 22, 20);
const cv::Scalar kPanel(38, 33, 30);
const cv::Scalar kLine(72, 64, 58);
const cv::Scalar kFaint(150, 138, 130);
const cv::Scalar kBright(236, 230, 226);
const cv::Scalar kGood(120, 200, 110);
const cv::Scalar kWarn(60, 170, 245);
const cv::Scalar kBad(80, 80, 240);
const cv::Scalar kLit(90, 225, 120);
const cv::Scalar kGoal(235, 180, 90);

constexpr int kMargin = 16;
constexpr int kHeadlinePx = 44;
constexpr int kEyePx = 372;
constexpr int kEyesTop = kHeadlinePx + 26;
constexpr int kJointsTop = kEyesTop + kEyePx + 34;
constexpr int kJointPx = 28;
constexpr int kRasterLeft = 3 * kMargin + 2 * kEyePx;
constexpr int kRasterNamePx = 126;
constexpr int kColumnPx = 2;
constexpr std::size_t kColumns = (ViewPicture::kWidthPx - kMargin - kRasterLeft - kRasterNamePx) / kColumnPx;
constexpr int kRowPx = 13;
constexpr std::size_t kRows = (ViewPicture::kHeightPx - kEyesTop - kMargin) / kRowPx;
constexpr std::size_t kLines = 5;
constexpr double kWhiteHz = 200;

cv::Scalar colour_of(GuardState state) {
  switch (state) {
    case GuardState::Tracking:
      return kGood;
    case GuardState::Stopped:
    case GuardState::Released:
      return kBad;
    default:
      return kWarn;
  }
}

}  // namespace

ViewPicture::ViewPicture(const SpikeImage& image) : image_(image), picture_(kHeightPx, kWidthPx, CV_8UC3) {}

cv::Rect ViewPicture::eye_panel(std::size_t eye) {
  return {kMargin + static_cast<int>(eye) * (kEyePx + kMargin), kEyesTop, kEyePx, kEyePx};
}

void ViewPicture::add_line(const std::string& text) {
  lines_.push_back(text);
  if (lines_.size() > kLines) {
    lines_.pop_front();
  }
}

void ViewPicture::text(const std::string& words, cv::Point at, const cv::Scalar& colour, double scale) {
  cv::putText(picture_, words, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

const cv::Mat& ViewPicture::draw(const LiveGlimpse& glimpse) {
  if (glimpse.time_s > last_time_s_) {
    const double since_s = glimpse.time_s - std::max(last_time_s_, 0.0);
    std::vector<double> rates_hz(image_.populations.size());
    for (std::size_t p = 0; p < std::min(rates_hz.size(), glimpse.spikes_of_population.size()); ++p) {
      rates_hz[p] = glimpse.spikes_of_population[p] / (image_.populations[p].size * since_s);
    }
    if (last_time_s_ >= 0) {  // the first glimpse has a time of its own to be counted over, and none to show
      history_.push_back(std::move(rates_hz));
    }
    last_time_s_ = glimpse.time_s;
  }
  if (history_.size() > kColumns) {
    history_.pop_front();
  }
  picture_.setTo(kGround);
  draw_headline(glimpse);
  for (std::size_t eye = 0; eye < kEyeCount; ++eye) {
    draw_eye(eye, glimpse.frame);
  }
  draw_joints(glimpse);
  draw_raster();
  draw_lines();
  return picture_;
}

void ViewPicture::draw_headline(const LiveGlimpse& glimpse) {
  const int baseline = 29;
  text(std::string(image_.name(image_.header.circuit_name)), {kMargin, baseline}, kBright, 0.62);
  text(fmt::format("{:.1f} s", glimpse.time_s), {190, baseline}, kBright, 0.55);
  cv::circle(picture_, {285, baseline - 6}, 6, colour_of(glimpse.state), cv::FILLED, cv::LINE_AA);
  text(kGuardStateNames[static_cast<std::size_t>(glimpse.state)], {298, baseline}, kBright, 0.55);
  const double age_ms = static_cast<double>(glimpse.frame.camera_age_ns) * 1e-6;
  text(fmt::format("camera {:.0f} ms old", age_ms), {430, baseline}, age_ms > 100 ? kWarn : kFaint, 0.5);
  const double late_ms = static_cast<double>(glimpse.frame.late_ns) * 1e-6;
  text(fmt::format("turn {:.2f} ms late", late_ms), {620, baseline}, late_ms > 5 ? kWarn : kFaint, 0.5);
  const LoopCounters& counters = glimpse.counters;
  text(fmt::format("{} turns", counters.turns), {kRasterLeft, baseline}, kFaint, 0.5);
  text(fmt::format("{} late", counters.late_turns), {kRasterLeft + 130, baseline},
       counters.late_turns > 0 ? kWarn : kFaint, 0.5);
  text(fmt::format("{} periods skipped", counters.skipped_periods), {kRasterLeft + 230, baseline},
       counters.skipped_periods > 0 ? kWarn : kFaint, 0.5);
  cv::line(picture_, {0, kHeadlinePx}, {kWidthPx, kHeadlinePx}, kLine);
}

void ViewPicture::draw_eye(std::size_t eye, const RecordedFrame& frame) {
  const cv::Rect panel = eye_panel(eye);
  text(eye == 0 ? "left eye" : "right eye", {panel.x, panel.y - 8}, kFaint, 0.45);
  cv::rectangle(picture_, panel, kPanel, cv::FILLED);
  std::uint32_t first = 0;
  for (const RetinaRecord& retina : image_.retinas) {
    if (static_cast<std::size_t>(retina.eye) != eye) {
      continue;
    }
    // The reference frame, as large as it fits.
    const double scale = kEyePx / static_cast<double>(std::max(retina.frame_width, retina.frame_height));
    const double left = panel.x + (kEyePx - retina.frame_width * scale) / 2;
    const double top = panel.y + (kEyePx - retina.frame_height * scale) / 2;
    const auto place = [&](double x, double y) {
      return cv::Point(static_cast<int>(std::lround(left + x * scale)), static_cast<int>(std::lround(top + y * scale)));
    };
    const auto& active = frame.active_fields[eye];
    for (const bool draws_active : {false, true}) {  // what is lit lies above what is not
      for (std::uint32_t f = 0; f < retina.field_count; ++f) {
        if (std::binary_search(active.begin(), active.end(), first + f) != draws_active) {
          continue;
        }
        const FieldRecord& field = image_.fields[retina.first_field + f];
        const cv::Rect where(place(field.x0, field.y0), place(field.x1, field.y1));
        if (draws_active) {
          cv::rectangle(picture_, where, kLit, cv::FILLED);
        } else if (where.width > 2) {
          cv::rectangle(picture_, where, kLine, 1);
        }
      }
    }
    const cv::Point centre = place(retina.frame_width / 2.0, retina.frame_height / 2.0);
    cv::line(picture_, centre - cv::Point(9, 0), centre + cv::Point(9, 0), kFaint);
    cv::line(picture_, centre - cv::Point(0, 9), centre + cv::Point(0, 9), kFaint);
    first += retina.field_count;
  }
  cv::rectangle(picture_, panel, kLine, 1);
}

void ViewPicture::draw_joints(const LiveGlimpse& glimpse) {
  constexpr int kNamePx = 118;
  constexpr int kNumbersPx = 176;
  const int left = kMargin + kNamePx;
  const int right = 2 * kMargin + 2 * kEyePx - kNumbersPx;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const int y = kJointsTop + static_cast<int>(j) * kJointPx;
    double low = -50;
    double high = 50;
    for (const JointRecord& joint : image_.joints) {
      if (static_cast<std::size_t>(joint.joint) == j) {
        low = joint.min_deg;
        high = joint.max_deg;
      }
    }
    const auto at = [&](double deg) {
      const double share = std::clamp((deg - low) / (high - low), 0.0, 1.0);
      return left + static_cast<int>(std::lround(share * (right - left)));
    };
    const bool is_lost = (glimpse.lost_mask >> j & 1U) != 0;
    std::string name(kHeadJointNames[j]);
    std::replace(name.begin(), name.end(), '_', ' ');
    text(name, {kMargin, y + 4}, is_lost ? kBad : kFaint);
    cv::line(picture_, {left, y}, {right, y}, kLine, 3, cv::LINE_AA);
    cv::line(picture_, {at(0), y - 6}, {at(0), y + 6}, kLine, 1);
    cv::line(picture_, {at(0), y}, {at(glimpse.frame.position_deg[j]), y}, is_lost ? kBad : kGood, 3, cv::LINE_AA);
    cv::circle(picture_, {at(glimpse.frame.goal_deg[j]), y}, 5, kGoal, 1, cv::LINE_AA);
    cv::circle(picture_, {at(glimpse.frame.position_deg[j]), y}, 4, is_lost ? kBad : kGood, cv::FILLED, cv::LINE_AA);
    text(is_lost ? "lost" : fmt::format("{:+.1f} deg", glimpse.frame.position_deg[j]), {right + 16, y + 4},
         is_lost ? kBad : kBright);
    text(fmt::format("goal {:+.1f}", glimpse.frame.goal_deg[j]), {right + 98, y + 4}, kGoal);
  }
}

/// Populations that fired within the history, in the circuit's order; the busiest when there are too many.
void ViewPicture::draw_raster() {
  std::vector<std::size_t> rows;
  std::vector<double> sum_hz(image_.populations.size());
  for (std::size_t p = 0; p < sum_hz.size(); ++p) {
    for (const std::vector<double>& rates_hz : history_) {
      sum_hz[p] += rates_hz[p];
    }
    if (sum_hz[p] > 0) {
      rows.push_back(p);
    }
  }
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return sum_hz[a] > sum_hz[b]; });
  rows.resize(std::min(rows.size(), kRows));
  std::sort(rows.begin(), rows.end());
  const int left = kRasterLeft + kRasterNamePx;
  text(fmt::format("mean rates, white = {:.0f} Hz", kWhiteHz), {left, kEyesTop - 8}, kFaint, 0.45);
  const cv::Rect panel(left, kEyesTop, static_cast<int>(kColumns) * kColumnPx, static_cast<int>(kRows) * kRowPx);
  cv::rectangle(picture_, panel, kPanel, cv::FILLED);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const int top = kEyesTop + static_cast<int>(r) * kRowPx;
    const std::string name(image_.name(image_.populations[rows[r]].name));
    text(name.size() > 18 ? name.substr(0, 17) + "." : name, {kRasterLeft, top + kRowPx - 3}, kFaint, 0.34);
    for (std::size_t c = 0; c < history_.size(); ++c) {
      const double share = std::sqrt(std::min(history_[c][rows[r]] / kWhiteHz, 1.0));
      const int x = left + static_cast<int>(kColumns - history_.size() + c) * kColumnPx;
      cv::rectangle(picture_, {x, top + 1, kColumnPx, kRowPx - 2}, kPanel * (1 - share) + kBright * share, cv::FILLED);
    }
  }
}

void ViewPicture::draw_lines() {
  const int top = kJointsTop + static_cast<int>(kJointCount) * kJointPx + 12;
  for (std::size_t k = 0; k < lines_.size(); ++k) {
    const std::string words = lines_[k].size() > 100 ? lines_[k].substr(0, 97) + "..." : lines_[k];
    text(words, {kMargin, top + static_cast<int>(k) * 20}, k + 1 == lines_.size() ? kBright : kFaint);
  }
}

}  // namespace tectum
