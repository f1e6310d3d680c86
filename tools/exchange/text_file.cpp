#include "tools/exchange/text_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace tectum {

void make_parent_folders(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) {
    std::filesystem::create_directories(parent, ignored);
  }
}

TextFile::TextFile(std::string path) : path_(std::move(path)) {
  make_parent_folders(path_);
  file_.reset(std::fopen(path_.c_str(), "wb"));
  if (!file_) {
    fail();
  }
}

void TextFile::fail() {
  if (error_.empty()) {
    error_ = fmt::format("cannot write {}: {}", path_, std::strerror(errno));
  }
}

void TextFile::flush() {
  if (file_ && std::fwrite(buffer_.data(), 1, buffer_.size(), file_.get()) != buffer_.size()) {
    fail();
  }
  buffer_.clear();
}

std::string TextFile::close() {
  flush();
  if (file_ && std::fclose(file_.release()) != 0) {
    fail();
  }
  return error_;
}

}  // namespace tectum
