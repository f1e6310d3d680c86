#include <zlib.h>

#include <algorithm>
#include <limits>

#include "tools/exchange/array.h"

namespace tectum {

std::optional<std::string> inflate(std::string_view compressed, std::size_t limit, bool is_raw) {
  constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;
  constexpr std::size_t kMostBytes = std::numeric_limits<uInt>::max();
  z_stream stream{};
  if (inflateInit2(&stream, is_raw ? -MAX_WBITS : MAX_WBITS) != Z_OK) {
    return std::nullopt;
  }
  std::string out;
  std::size_t taken = 0;
  int status = Z_OK;
  while (status == Z_OK && out.size() <= limit) {
    if (stream.avail_in == 0 && taken < compressed.size()) {
      const std::size_t next = std::min(kMostBytes, compressed.size() - taken);
      // zlib takes its input as non-const and leaves it alone.
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data() + taken));
      stream.avail_in = static_cast<uInt>(next);
      taken += next;
    }
    const std::size_t before = out.size();
    out.resize(before + kChunkBytes);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(kChunkBytes);
    status = ::inflate(&stream, Z_NO_FLUSH);
    out.resize(before + kChunkBytes - stream.avail_out);
  }
  inflateEnd(&stream);
  return status == Z_STREAM_END && out.size() <= limit ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace tectum
