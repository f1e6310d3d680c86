#include "compiler/format/jsonc_tokens.h"

#include <algorithm>

namespace tectum {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_hex(char c) { return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

class Tokenizer {
 public:
  explicit Tokenizer(std::string_view text) : text_(text) {}

  JsoncTokens run() {
    if (text_.substr(0, 3) == "\xef\xbb\xbf") {
      at_ = 3;
    }  // a byte order mark says nothing in UTF-8
    while (result_.error.empty()) {
      skip_blanks();
      if (at_ == text_.size()) {
        push(JsoncTokenKind::End, at_);
        break;
      }
      next();
    }
    return std::move(result_);
  }

 private:
  char at(std::size_t i) const { return i < text_.size() ? text_[i] : '\0'; }

  void skip_blanks() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') {
        ++newlines_;
      } else if (c != ' ' && c != '\t' && c != '\r') {
        return;
      }
    }
  }

  void push(JsoncTokenKind kind, std::size_t end) {
    result_.tokens.push_back({kind, text_.substr(at_, end - at_), at_, newlines_});
    at_ = end;
    newlines_ = 0;
  }

  void fail(std::size_t offset, std::string error) {
    result_.error_offset = offset;
    result_.error = std::move(error);
  }

  void next() {
    switch (text_[at_]) {
      case '{':
        return push(JsoncTokenKind::OpenObject, at_ + 1);
      case '}':
        return push(JsoncTokenKind::CloseObject, at_ + 1);
      case '[':
        return push(JsoncTokenKind::OpenArray, at_ + 1);
      case ']':
        return push(JsoncTokenKind::CloseArray, at_ + 1);
      case ':':
        return push(JsoncTokenKind::Colon, at_ + 1);
      case ',':
        return push(JsoncTokenKind::Comma, at_ + 1);
      case '"':
        return string();
      case '/':
        return comment();
      default:
        return literal();
    }
  }

  void comment() {
    if (at(at_ + 1) == '/') {
      std::size_t end = std::min(text_.find('\n', at_), text_.size());
      while (end > at_ && (text_[end - 1] == ' ' || text_[end - 1] == '\t' || text_[end - 1] == '\r')) {
        --end;
      }
      push(JsoncTokenKind::LineComment, end);
    } else if (at(at_ + 1) == '*') {
      const std::size_t close = text_.find("*/", at_ + 2);
      if (close == std::string_view::npos) {
        return fail(at_, "comment is never closed");
      }
      push(JsoncTokenKind::BlockComment, close + 2);
    } else {
      fail(at_, "expected a comment after `/`");
    }
  }

  void string() {
    std::size_t i = at_ + 1;
    while (i < text_.size() && text_[i] != '"') {
      const std::size_t length = text_[i] == '\\' ? escape_bytes(i) : character_bytes(i);
      if (length == 0) {
        return fail(i, text_[i] == '\\' ? "broken escape in a string" : character_error(i));
      }
      i += length;
    }
    if (i >= text_.size()) {
      return fail(at_, "string is never closed");
    }
    push(JsoncTokenKind::String, i + 1);
  }

  std::string character_error(std::size_t i) const {
    if (text_[i] == '\n' || text_[i] == '\r') {
      return "string is not closed on its line";
    }
    return static_cast<unsigned char>(text_[i]) < 0x20 ? "control character in a string" : "text is not UTF-8";
  }

  // Bytes of the escape at `i`, 0 when broken. Half a surrogate pair is broken, RFC 8259 section 7.
  std::size_t escape_bytes(std::size_t i) const {
    if (std::string_view("\"\\/bfnrt").find(at(i + 1)) != std::string_view::npos && at(i + 1) != '\0') {
      return 2;
    }
    const unsigned first = code_unit(i);
    if (first >= 0xd800 && first <= 0xdbff) {
      const unsigned second = code_unit(i + 6);
      return second >= 0xdc00 && second <= 0xdfff ? 12 : 0;
    }
    return first > 0xffff || (first >= 0xdc00 && first <= 0xdfff) ? 0 : 6;
  }

  // The code unit of \uXXXX at `i`, above 0xffff when there is none.
  unsigned code_unit(std::size_t i) const {
    constexpr unsigned kNone = 0x10000;
    if (at(i) != '\\' || at(i + 1) != 'u') {
      return kNone;
    }
    unsigned value = 0;
    for (std::size_t k = i + 2; k < i + 6; ++k) {
      const char c = at(k);
      if (!is_hex(c)) {
        return kNone;
      }
      value = value * 16 + static_cast<unsigned>(is_digit(c) ? c - '0' : (c | 0x20) - 'a' + 10);
    }
    return value;
  }

  // Bytes of the UTF-8 character at `i`, 0 for a control character or broken bytes. Unicode 15, table 3-7.
  std::size_t character_bytes(std::size_t i) const {
    const auto within = [&](std::size_t k, unsigned low, unsigned high) {
      const unsigned byte = static_cast<unsigned char>(at(k));
      return byte >= low && byte <= high;
    };
    if (within(i, 0x20, 0x7f)) {
      return 1;
    }
    if (within(i, 0xc2, 0xdf)) {
      return within(i + 1, 0x80, 0xbf) ? 2 : 0;
    }
    if (within(i, 0xe0, 0xef)) {
      const bool second = within(i, 0xe0, 0xe0)   ? within(i + 1, 0xa0, 0xbf)
                          : within(i, 0xed, 0xed) ? within(i + 1, 0x80, 0x9f)
                                                  : within(i + 1, 0x80, 0xbf);
      return second && within(i + 2, 0x80, 0xbf) ? 3 : 0;
    }
    if (!within(i, 0xf0, 0xf4)) {
      return 0;
    }
    const bool second = within(i, 0xf0, 0xf0)   ? within(i + 1, 0x90, 0xbf)
                        : within(i, 0xf4, 0xf4) ? within(i + 1, 0x80, 0x8f)
                                                : within(i + 1, 0x80, 0xbf);
    return second && within(i + 2, 0x80, 0xbf) && within(i + 3, 0x80, 0xbf) ? 4 : 0;
  }

  void literal() {
    for (const std::string_view word : {"true", "false", "null"}) {
      if (text_.substr(at_, word.size()) == word) {
        return push(JsoncTokenKind::Literal, at_ + word.size());
      }
    }
    std::size_t i = at_;
    if (at(i) == '-') {
      ++i;
    }
    const std::size_t whole = i;
    i = digits_end(i);
    const bool is_padded = at(whole) == '0' && i > whole + 1;
    bool is_number = i > whole && !is_padded;
    if (is_number && at(i) == '.') {
      const std::size_t fraction = i + 1;
      i = digits_end(fraction);
      is_number = i > fraction;
    }
    if (is_number && (at(i) == 'e' || at(i) == 'E')) {
      const std::size_t exponent = at(i + 1) == '+' || at(i + 1) == '-' ? i + 2 : i + 1;
      i = digits_end(exponent);
      is_number = i > exponent;
    }
    if (is_number) {
      return push(JsoncTokenKind::Literal, i);
    }
    fail(at_, i > at_ ? "malformed number" : "expected a value, a bracket or a comment");
  }

  std::size_t digits_end(std::size_t i) const {
    while (is_digit(at(i))) {
      ++i;
    }
    return i;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::uint32_t newlines_ = 0;
  JsoncTokens result_;
};

}  // namespace

JsoncTokens tokenize_jsonc(std::string_view text) { return Tokenizer(text).run(); }

}  // namespace tectum
