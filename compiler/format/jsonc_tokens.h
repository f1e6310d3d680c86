// JSON with comments, cut into tokens that know how many line breaks stand before them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tectum {

enum class JsoncTokenKind : std::uint8_t {
  OpenObject,
  CloseObject,
  OpenArray,
  CloseArray,
  Colon,
  Comma,
  String,
  Literal,  // number, true, false, null
  LineComment,
  BlockComment,
  End,
};

struct JsoncToken {
  JsoncTokenKind kind = JsoncTokenKind::End;
  std::string_view text;  // into the input; a line comment without its line break
  std::size_t offset = 0;
  std::uint32_t newlines_before = 0;  // since the end of the token before
};

struct JsoncTokens {
  std::vector<JsoncToken> tokens;  // ends with End
  std::size_t error_offset = 0;
  std::string error;  // empty: all of the text is tokens
};

JsoncTokens tokenize_jsonc(std::string_view text);

}  // namespace tectum
