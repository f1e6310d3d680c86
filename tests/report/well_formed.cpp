#include "tests/report/well_formed.h"

#include <cctype>
#include <vector>

namespace tectum {
namespace {

std::string at(std::string_view what, std::string_view text, std::size_t position) {
  return std::string(what) + ": ..." + std::string(text.substr(position, 60));
}

bool is_entity(std::string_view text, std::size_t ampersand) {
  for (const std::string_view entity : {"&amp;", "&lt;", "&gt;", "&quot;"}) {
    if (text.substr(ampersand, entity.size()) == entity) {
      return true;
    }
  }
  return false;
}

/// Position of the tag's closing bracket, outside quotes; npos if there is none.
std::size_t tag_end(std::string_view text, std::size_t from) {
  bool is_quoted = false;
  for (std::size_t k = from; k < text.size(); ++k) {
    if (text[k] == '"') {
      is_quoted = !is_quoted;
    } else if (text[k] == '<') {
      return std::string_view::npos;
    } else if (text[k] == '>' && !is_quoted) {
      return k;
    }
  }
  return std::string_view::npos;
}

}  // namespace

std::string first_markup_error(std::string_view text) {
  std::vector<std::string> open;
  for (std::size_t k = 0; k < text.size();) {
    if (text[k] == '&' && !is_entity(text, k)) {
      return at("raw ampersand", text, k);
    }
    if (text[k] == '>') {
      return at("stray bracket", text, k);
    }
    if (text[k] != '<') {
      ++k;
      continue;
    }
    const std::size_t end = tag_end(text, k + 1);
    if (end == std::string_view::npos) {
      return at("unfinished tag", text, k);
    }
    const std::string_view tag = text.substr(k + 1, end - k - 1);
    if (tag.starts_with('?') || tag.starts_with('!')) {
      k = end + 1;
      continue;
    }
    std::size_t length = tag.starts_with('/') ? 1 : 0;
    while (length < tag.size() && std::isalnum(static_cast<unsigned char>(tag[length])) != 0) {
      ++length;
    }
    const std::string name(tag.substr(0, length));
    k = end + 1;
    if (name.starts_with('/')) {
      if (open.empty() || open.back() != name.substr(1)) {
        return at("closes what is not open", text, k - tag.size() - 2);
      }
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      open.push_back(name);
      if (name == "script" || name == "style") {
        k = text.find("</" + name, k);
        if (k == std::string_view::npos) {
          return "unclosed " + name;
        }
      }
    }
  }
  return open.empty() ? "" : "unclosed " + open.back();
}

}  // namespace tectum
