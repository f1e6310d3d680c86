#include "tools/tectum/live_view.h"

#include <fmt/format.h>

#include <filesystem>
#include <ostream>

#include "tools/live/window_library.h"

namespace tectum {
namespace {

constexpr std::chrono::milliseconds kFilePeriod{500};  // a picture file takes some 20 ms to write

}  // namespace

LiveView::LiveView(Kind kind, std::string path, const SpikeImage& image, std::ostream& terminal)
    : kind_(kind),
      path_(std::move(path)),
      title_(fmt::format("tectum: {}", image.name(image.header.circuit_name))),
      terminal_(terminal),
      dashboard_(image),
      picture_(image) {}

std::unique_ptr<LiveView> LiveView::make(const std::string& wanted, const SpikeImage& image, std::ostream& terminal,
                                         std::string& error) {
  Kind kind = Kind::None;
  std::string path;
  if (wanted == "auto") {
    kind = has_display() ? Kind::Window : Kind::Text;
  } else if (wanted == "text") {
    kind = Kind::Text;
  } else if (wanted == "window") {
    kind = Kind::Window;
    if (!has_display()) {
      error = "--view=window: there is no display here; --view=text draws in the terminal";
      return nullptr;
    }
  } else if (const auto ending = std::filesystem::path(wanted).extension(); ending == ".png" || ending == ".jpg") {
    kind = Kind::File;
    path = wanted;
  } else if (!wanted.empty()) {
    error = fmt::format("--view={}: neither text nor window nor the name of a .png or .jpg file", wanted);
    return nullptr;
  }
  return std::unique_ptr<LiveView>(new LiveView(kind, std::move(path), image, terminal));
}

void LiveView::give_up(const std::string& why) {
  kind_ = Kind::None;
  terminal_ << fmt::format("\rtectum: no more view: {}\n", why);
}

char LiveView::show(const LiveGlimpse& glimpse) {
  std::string error;
  switch (kind_) {
    case Kind::None:
      break;
    case Kind::Text:
      terminal_ << dashboard_.draw(glimpse) << std::flush;
      break;
    case Kind::Window: {
      const int key = show_picture(title_, picture_.draw(glimpse), error);
      if (key < 0) {
        give_up(error);
      }
      return key > 0 && key < 128 ? static_cast<char>(key) : '\0';
    }
    case Kind::File: {
      const cv::Mat& picture = picture_.draw(glimpse);
      const auto now = std::chrono::steady_clock::now();
      if (now - last_written_ >= kFilePeriod) {
        last_written_ = now;
        if (!write_picture(path_, picture, error)) {
          give_up(error);
        }
      }
      break;
    }
  }
  return '\0';
}

void LiveView::add_line(const std::string& text) {
  dashboard_.add_line(text);
  picture_.add_line(text);
}

}  // namespace tectum
