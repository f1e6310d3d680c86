// The bytes of a circuit file, and places in them. Lines and columns are computed only to print.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tectum {

/// Index into Sources.
enum class FileId : std::uint32_t {};

/// Half-open range of bytes [begin, end) of one file.
struct Span {
  FileId file{};
  std::uint32_t begin = 0;
  std::uint32_t end = 0;

  friend bool operator==(const Span&, const Span&) = default;
};

struct SourceFile {
  std::string name;   // as the user gave it, for messages
  std::string bytes;  // at most kMaxSourceBytes
};

/// A circuit file is text that people read; wiring in bulk belongs in an edge list. Also keeps every
/// offset inside 32 bits.
inline constexpr std::size_t kMaxSourceBytes = std::size_t{64} * 1024 * 1024;

/// Counted from 1; columns count code points, so that carets stand under the right letter.
struct Position {
  std::uint32_t line = 1;
  std::uint32_t column = 1;
};

/// Every file of one compilation: the circuit, then what it includes, in reading order.
class Sources {
 public:
  FileId add(SourceFile file);
  [[nodiscard]] const SourceFile& file(FileId id) const { return files_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] std::size_t size() const { return files_.size(); }
  [[nodiscard]] std::string_view text(const Span& span) const;

 private:
  std::vector<SourceFile> files_;
};

[[nodiscard]] Position position_of(std::string_view bytes, std::size_t offset);
/// The whole line around `offset`, without its line break.
[[nodiscard]] std::string_view line_around(std::string_view bytes, std::size_t offset);

/// Either the file or one line that says why not.
struct ReadSource {
  bool ok = false;
  SourceFile file;
  std::string error;
};

/// Reads a file from disk. Reads at most kMaxSourceBytes + 1 bytes, whatever the file's size.
[[nodiscard]] ReadSource read_source(const std::string& path);

}  // namespace tectum
