#include <cstdio>
#include <filesystem>
#include <opencv2/highgui.hpp>
#include <opencv2/imgcodecs.hpp>
#include <system_error>

#include "tools/live/window_library.h"

namespace tectum {
namespace {

// OpenCV's own text has lines and file names of its source in it.
std::string reason_of(const cv::Exception& error) { return error.err.substr(0, error.err.find('\n')); }

}  // namespace

extern "C" int tectum_show_picture(const std::string& title, const cv::Mat& picture, std::string& error) {
  static bool is_open = false;
  try {
    if (!is_open) {
      cv::namedWindow(title, cv::WINDOW_NORMAL | cv::WINDOW_KEEPRATIO | cv::WINDOW_GUI_NORMAL);
      cv::resizeWindow(title, picture.cols, picture.rows);
    } else if (cv::getWindowProperty(title, cv::WND_PROP_VISIBLE) < 1) {
      error = "the window was closed";
      return -1;
    }
    is_open = true;
    cv::imshow(title, picture);
    const int key = cv::pollKey();
    return key > 0 ? key : 0;
  } catch (const cv::Exception& why) {
    error = "no window can be opened: " + reason_of(why);
    return -1;
  }
}

extern "C" bool tectum_write_picture(const std::string& path, const cv::Mat& picture, std::string& error) {
  // Under another name first: who looks at the file never sees half of it.
  const std::filesystem::path to(path);
  const std::filesystem::path beside = to.parent_path() / (to.stem().string() + ".part" + to.extension().string());
  try {
    if (!cv::imwrite(beside.string(), picture)) {
      error = path + ": cannot be written";
      return false;
    }
  } catch (const cv::Exception& why) {
    error = path + ": " + reason_of(why);
    return false;
  }
  std::error_code failed;
  std::filesystem::rename(beside, to, failed);
  error = failed ? path + ": " + failed.message() : "";
  return !failed;
}

}  // namespace tectum
