// A text file that is written piece by piece.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <utility>

namespace tectum {

class TextFile {
 public:
  /// Makes the folders above it. What goes wrong is told by close().
  explicit TextFile(std::string path);

  template <typename... Args>
  void write(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(buffer_), format, std::forward<Args>(args)...);
    if (buffer_.size() >= kFlushBytes) {
      flush();
    }
  }
  /// "cannot write PATH: reason", or nothing.
  [[nodiscard]] std::string close();

 private:
  static constexpr std::size_t kFlushBytes = std::size_t{1} << 20U;
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void flush();
  void fail();

  std::string path_;
  std::string error_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  fmt::memory_buffer buffer_;
};

/// Makes the folders above `path`, where they can be made.
void make_parent_folders(const std::string& path);

}  // namespace tectum
