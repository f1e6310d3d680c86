// The functions of the window library, libtectum_window.so beside the binary: OpenCV's windows and picture files bring
// a whole desktop toolkit with them, which only --view needs.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace tectum {

extern "C" {
/// Shows `picture` (8-bit BGR) in the window `title`, which the first call opens. Gives the key pressed since the last
/// call, or 0; -1 with a line in `error` when there is no window to show it in, or when it was closed.
int tectum_show_picture(const std::string& title, const cv::Mat& picture, std::string& error);
/// False with a line in `error` when the file cannot be written. Its ending says what kind of picture.
bool tectum_write_picture(const std::string& path, const cv::Mat& picture, std::string& error);
}

/// The same, through the library.
[[nodiscard]] int show_picture(const std::string& title, const cv::Mat& picture, std::string& error);
[[nodiscard]] bool write_picture(const std::string& path, const cv::Mat& picture, std::string& error);
/// Whether a window can be asked for at all: a display is named in the environment.
[[nodiscard]] bool has_display();

}  // namespace tectum
