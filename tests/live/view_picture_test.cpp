// The picture of a live run, pixel by pixel where it says something.
#include "tools/live/view_picture.h"

#include <doctest/doctest.h>

#include <opencv2/imgproc.hpp>

#include "tests/loop/loop_fixture.h"

using namespace tectum;

namespace {

/// How many pixels of `where` are greener than they are red or blue by more than `by`.
int green_pixels(const cv::Mat& picture, const cv::Rect& where, int by) {
  int count = 0;
  for (int y = where.y; y < where.y + where.height; ++y) {
    for (int x = where.x; x < where.x + where.width; ++x) {
      const cv::Vec3b pixel = picture.at<cv::Vec3b>(y, x);
      count += pixel[1] > std::max(pixel[0], pixel[2]) + by ? 1 : 0;
    }
  }
  return count;
}

LiveGlimpse glimpse_at(const SpikeImage& image, double time_s) {
  LiveGlimpse glimpse;
  glimpse.time_s = time_s;
  glimpse.state = GuardState::Tracking;
  glimpse.spikes_of_population.resize(image.populations.size());
  return glimpse;
}

}  // namespace

TEST_CASE("an active receptive field is lit in the panel of its eye, and only there") {
  const SpikeImage image = two_eyed_image(1.0);
  ViewPicture view(image);
  LiveGlimpse glimpse = glimpse_at(image, 1);
  const cv::Mat dark = view.draw(glimpse).clone();
  CHECK(dark.cols == ViewPicture::kWidthPx);
  CHECK(dark.rows == ViewPicture::kHeightPx);
  CHECK(green_pixels(dark, ViewPicture::eye_panel(0), 60) == 0);
  CHECK(green_pixels(dark, ViewPicture::eye_panel(1), 60) == 0);
  glimpse.frame.active_fields[1] = {0};
  const cv::Mat lit = view.draw(glimpse).clone();
  CHECK(green_pixels(lit, ViewPicture::eye_panel(0), 60) == 0);
  CHECK(green_pixels(lit, ViewPicture::eye_panel(1), 60) > 20);
}

TEST_CASE("a lost servo, a line told and a new column of rates change the picture; the same glimpse again does not") {
  const SpikeImage image = two_eyed_image(1.0);
  ViewPicture view(image);
  LiveGlimpse glimpse = glimpse_at(image, 1);
  static_cast<void>(view.draw(glimpse));
  glimpse.time_s = 1.05;
  glimpse.spikes_of_population[0] = 7;
  const cv::Mat before = view.draw(glimpse).clone();
  CHECK(cv::norm(view.draw(glimpse), before) == 0);
  glimpse.lost_mask = 1;
  const cv::Mat lost = view.draw(glimpse).clone();
  CHECK(cv::norm(lost, before) > 0);
  view.add_line("servo 3 does not answer");
  const cv::Mat told = view.draw(glimpse).clone();
  CHECK(cv::norm(told, lost) > 0);
  glimpse.time_s = 1.10;
  CHECK(cv::norm(view.draw(glimpse), told) > 0);
}
