// A live run as a picture: both eyes with their receptive fields, the spikes of every population as they scroll by, the
// joints, and whether the loop keeps its time.
#pragma once

#include <deque>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "tools/live/live_run.h"

namespace tectum {

class ViewPicture {
 public:
  static constexpr int kWidthPx = 1280;
  static constexpr int kHeightPx = 800;

  /// `image` outlives it.
  explicit ViewPicture(const SpikeImage& image);

  /// 8-bit BGR, kWidthPx by kHeightPx. Each call with a later glimpse adds a column to the scrolling raster.
  [[nodiscard]] const cv::Mat& draw(const LiveGlimpse& glimpse);
  /// Told below the joints, newest last.
  void add_line(const std::string& text);

  /// Where the fields of an eye are drawn, in pixels of the picture.
  [[nodiscard]] static cv::Rect eye_panel(std::size_t eye);

 private:
  void draw_headline(const LiveGlimpse& glimpse);
  void draw_eye(std::size_t eye, const RecordedFrame& frame);
  void draw_joints(const LiveGlimpse& glimpse);
  void draw_raster();
  void draw_lines();
  void text(const std::string& words, cv::Point at, const cv::Scalar& colour, double scale = 0.42);

  const SpikeImage& image_;
  std::deque<std::vector<double>> history_;  // mean rate of each population in Hz, one entry a column
  double last_time_s_ = -1;
  std::deque<std::string> lines_;
  cv::Mat picture_;
};

}  // namespace tectum
