#include "tools/live/window_library.h"

#include <dlfcn.h>

#include <cstdlib>

#include "drivers/camera/side_library.h"

namespace tectum {
namespace {

constexpr const char* kLibraryName = "libtectum_window.so";

template <typename Function>
Function* find_function(const char* name, std::string& error) {
  static void* const library = open_side_library(kLibraryName);
  if (library == nullptr) {
    const char* why = dlerror();
    error = std::string(kLibraryName) + ", which shows and writes pictures, cannot be loaded" +
            (why != nullptr ? std::string(": ") + why : "");
    return nullptr;
  }
  auto* const function = reinterpret_cast<Function*>(dlsym(library, name));
  if (function == nullptr) {
    error = std::string(kLibraryName) + " is of another version: it has no " + name;
  }
  return function;
}

bool is_set(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

}  // namespace

int show_picture(const std::string& title, const cv::Mat& picture, std::string& error) {
  auto* const function = find_function<decltype(tectum_show_picture)>("tectum_show_picture", error);
  return function != nullptr ? function(title, picture, error) : -1;
}

bool write_picture(const std::string& path, const cv::Mat& picture, std::string& error) {
  auto* const function = find_function<decltype(tectum_write_picture)>("tectum_write_picture", error);
  return function != nullptr && function(path, picture, error);
}

bool has_display() { return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY"); }

}  // namespace tectum
