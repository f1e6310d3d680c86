#include "compiler/source/source_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <utility>

namespace tectum {
namespace {

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

FileId Sources::add(SourceFile file) {
  files_.push_back(std::move(file));
  return static_cast<FileId>(files_.size() - 1);
}

std::string_view Sources::text(const Span& span) const {
  const std::string& bytes = file(span.file).bytes;
  const std::size_t begin = std::min<std::size_t>(span.begin, bytes.size());
  const std::size_t end = std::clamp<std::size_t>(span.end, begin, bytes.size());
  return std::string_view(bytes).substr(begin, end - begin);
}

Position position_of(std::string_view bytes, std::size_t offset) {
  offset = std::min(offset, bytes.size());
  const std::string_view before = bytes.substr(0, offset);
  const std::size_t line_begin = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  const std::string_view line = before.substr(line_begin);
  Position position;
  position.line = static_cast<std::uint32_t>(1 + std::count(before.begin(), before.end(), '\n'));
  position.column = static_cast<std::uint32_t>(
      1 + std::count_if(line.begin(), line.end(), [](char c) { return !is_continuation(c); }));
  return position;
}

std::string_view line_around(std::string_view bytes, std::size_t offset) {
  offset = std::min(offset, bytes.size());
  const std::size_t before = offset == 0 ? std::string_view::npos : bytes.rfind('\n', offset - 1);
  const std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
  std::size_t end = bytes.find('\n', begin);
  end = end == std::string_view::npos ? bytes.size() : end;
  if (end > begin && bytes[end - 1] == '\r') {
    --end;
  }
  return bytes.substr(begin, end - begin);
}

ReadSource read_source(const std::string& path) {
  ReadSource result;
  result.file.name = path;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    result.error = path + ": is a directory, not a circuit file";
    return result;
  }
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (!file) {
    result.error = path + ": " + std::strerror(errno);
    return result;
  }
  std::string& bytes = result.file.bytes;
  constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;
  while (bytes.size() <= kMaxSourceBytes) {
    const std::size_t old_size = bytes.size();
    bytes.resize(old_size + kChunkBytes);
    const std::size_t got = std::fread(bytes.data() + old_size, 1, kChunkBytes, file.get());
    bytes.resize(old_size + got);
    if (got < kChunkBytes) {
      break;
    }
  }
  if (std::ferror(file.get()) != 0) {
    result.error = path + ": " + std::strerror(errno);
    return result;
  }
  if (bytes.size() > kMaxSourceBytes) {
    bytes.clear();
    result.error =
        path + ": is larger than 64 MiB; a circuit file is text to read, wiring in bulk goes in an edge list";
    return result;
  }
  result.ok = true;
  return result;
}

}  // namespace tectum
