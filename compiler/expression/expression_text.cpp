#include "compiler/expression/expression_text.h"

#include <cstddef>

namespace tectum {
namespace {

// Length of the well-formed UTF-8 character at `i`, 0 when it is broken. Unicode 15, table 3-7.
std::size_t character_bytes(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U; };
  const auto in = [](unsigned value, unsigned low, unsigned high) { return value >= low && value <= high; };
  const unsigned first = byte(i);
  if (in(first, 0x20, 0x7e)) {
    return 1;
  }
  if (in(first, 0xc2, 0xdf)) {
    return in(byte(i + 1), first == 0xc2 ? 0xa0 : 0x80, 0xbf) ? 2 : 0;
  }  // no C1 controls
  if (in(first, 0xe0, 0xef)) {
    const unsigned low = first == 0xe0 ? 0xa0 : 0x80;
    const unsigned high = first == 0xed ? 0x9f : 0xbf;
    return in(byte(i + 1), low, high) && in(byte(i + 2), 0x80, 0xbf) ? 3 : 0;
  }
  if (in(first, 0xf0, 0xf4)) {
    const unsigned low = first == 0xf0 ? 0x90 : 0x80;
    const unsigned high = first == 0xf4 ? 0x8f : 0xbf;
    return in(byte(i + 1), low, high) && in(byte(i + 2), 0x80, 0xbf) && in(byte(i + 3), 0x80, 0xbf) ? 4 : 0;
  }
  return 0;
}

}  // namespace

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string result = "`";
  std::size_t i = 0;
  while (i < text.size()) {
    if (result.size() > kLongest) {
      result += "…";
      break;
    }
    const std::size_t length = character_bytes(text, i);
    if (length == 0) {
      constexpr std::string_view kHex = "0123456789abcdef";
      const auto byte = static_cast<unsigned char>(text[i++]);
      result += "\\x";
      result += kHex[byte >> 4U];
      result += kHex[byte & 15U];
    } else {
      result += text.substr(i, length);
      i += length;
    }
  }
  return result + "`";
}

}  // namespace tectum
