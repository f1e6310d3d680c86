// --view: a live run in a window, in the terminal, or in a picture file.
#pragma once

#include <chrono>
#include <iosfwd>
#include <memory>
#include <string>

#include "tools/live/dashboard.h"
#include "tools/live/view_picture.h"

namespace tectum {

class LiveView {
 public:
  /// `wanted` is what followed --view: auto, text, window, or the name of a picture file; empty for no view. Null with
  /// a line in `error` when it is none of them. `image` and `terminal` outlive the view.
  [[nodiscard]] static std::unique_ptr<LiveView> make(const std::string& wanted, const SpikeImage& image,
                                                      std::ostream& terminal, std::string& error);

  /// Whether the terminal is the view's to draw on.
  [[nodiscard]] bool owns_terminal() const { return kind_ == Kind::Text; }
  /// Gives the key pressed in the window, or 0. A window that cannot be opened, or that was closed, is told once and
  /// then there is no view.
  [[nodiscard]] char show(const LiveGlimpse& glimpse);
  void add_line(const std::string& text);

 private:
  enum class Kind { None, Text, Window, File };

  LiveView(Kind kind, std::string path, const SpikeImage& image, std::ostream& terminal);
  void give_up(const std::string& why);

  Kind kind_;
  std::string path_;   // of the picture file
  std::string title_;  // of the window
  std::ostream& terminal_;
  Dashboard dashboard_;
  ViewPicture picture_;
  std::chrono::steady_clock::time_point last_written_{};
};

}  // namespace tectum
