#include "compiler/parse/parse_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "compiler/parse/explain_syntax_error.h"
#include "compiler/parse/text_scan.h"

namespace tectum {
namespace {

/// Builds the tree from the events of a JSON reader. The reader gives values, not places: a cursor follows
/// it through the text, over blanks, comments and separators, to each token in turn.
class TreeBuilder {
 public:
  using json = nlohmann::json;

  TreeBuilder(FileId file, std::string_view text, Diagnostics& diagnostics)
      : text_(text), diagnostics_(diagnostics), stop_{file, text, 0, 0, false, false, {}} {}

  bool null() { return scalar(JsonKind::Null); }
  bool boolean(bool value) {
    const bool ok = scalar(JsonKind::Boolean);
    tree.nodes.back().boolean = value;
    return ok;
  }
  bool number_integer(json::number_integer_t value) { return number(static_cast<double>(value)); }
  bool number_unsigned(json::number_unsigned_t value) { return number(static_cast<double>(value)); }
  bool number_float(json::number_float_t value, const std::string&) { return number(value); }
  bool string(std::string& value) {
    const bool ok = scalar(JsonKind::String);
    JsonNode& node = tree.nodes.back();
    node.has_escapes = value.size() + 2 != node.span.end - node.span.begin;
    node.text = std::move(value);
    return ok;
  }
  bool binary(json::binary_t&) { return false; }  // JSON text has none
  bool start_object(std::size_t) { return open(JsonKind::Object); }
  bool start_array(std::size_t) { return open(JsonKind::Array); }
  bool end_array() { return close(); }
  bool end_object() {
    report_duplicates(open_nodes_.back());
    return close();
  }
  bool key(std::string& name) {
    const std::size_t begin = next_token();
    const std::size_t end = string_end(text_, begin);
    key_span_ = span(begin, end);
    key_ = std::move(name);
    advance(begin, end, true);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) {
    // 406: a number outside the range of double, which reads as a value to explain_syntax_error.
    if (error.id == 406) {
      const std::size_t begin = next_token();
      const std::size_t end = word_end(text_, begin);
      diagnostics_.add(Code::BadNumber, span(begin, end), {std::string(text_.substr(begin, end - begin))})
          .help("it is outside the range of a double");
    } else {
      explain_syntax_error(stop_, diagnostics_);
    }
    return false;
  }

  JsonTree tree;

 private:
  [[nodiscard]] Span span(std::size_t begin, std::size_t end) const {
    return {stop_.file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
  }

  [[nodiscard]] std::size_t next_token() const {
    std::size_t at = skip_blanks(text_, stop_.after);
    while (at < text_.size() && (text_[at] == ',' || text_[at] == ':')) {
      at = skip_blanks(text_, at + 1);
    }
    return at;
  }

  void advance(std::size_t begin, std::size_t end, bool is_key) {
    stop_.before = begin;
    stop_.after = end;
    stop_.after_key = is_key;
    stop_.after_value = !is_key;
  }

  JsonNode& add_node(JsonKind kind, std::size_t begin, std::size_t end) {
    const auto id = static_cast<JsonId>(tree.nodes.size());
    JsonNode& node = tree.nodes.emplace_back();
    node.kind = kind;
    node.span = span(begin, end);
    if (!open_nodes_.empty()) {
      JsonNode& parent = tree[open_nodes_.back()];
      if (parent.kind == JsonKind::Object) {
        node.key = std::move(key_);
        node.key_span = key_span_;
      }
      ++parent.child_count;
      (last_children_.back() == JsonId::None ? parent.first_child : tree[last_children_.back()].next_sibling) = id;
      last_children_.back() = id;
    }
    return node;
  }

  bool scalar(JsonKind kind) {
    const std::size_t begin = next_token();
    const std::size_t end = kind == JsonKind::String ? string_end(text_, begin) : word_end(text_, begin);
    add_node(kind, begin, end);
    advance(begin, end, false);
    return true;
  }

  bool number(double value) {
    scalar(JsonKind::Number);
    JsonNode& node = tree.nodes.back();
    node.number = value;
    node.text = text_.substr(node.span.begin, node.span.end - node.span.begin);
    // The reader takes the 0 of "01" for a number and stumbles over the rest: the whole word is what is wrong.
    if (!is_json_number(node.text)) {
      diagnostics_.add(Code::BadNumber, node.span, {node.text}).help(std::string(kNumberHelp));
      return false;
    }
    return true;
  }

  bool open(JsonKind kind) {
    const std::size_t begin = next_token();
    if (stop_.open_brackets.size() >= static_cast<std::size_t>(kMaxJsonDepth)) {
      diagnostics_.add(Code::TooDeep, span(begin, begin + 1), {fmt::format("{}", kMaxJsonDepth)});
      return false;
    }
    add_node(kind, begin, begin + 1);
    open_nodes_.push_back(static_cast<JsonId>(tree.nodes.size() - 1));
    last_children_.push_back(JsonId::None);
    stop_.open_brackets.push_back(begin);
    stop_.before = begin;
    stop_.after = begin + 1;
    stop_.after_key = false;
    stop_.after_value = false;
    return true;
  }

  bool close() {
    const std::size_t end = next_token() + 1;
    tree[open_nodes_.back()].span.end = static_cast<std::uint32_t>(end);
    open_nodes_.pop_back();
    last_children_.pop_back();
    stop_.open_brackets.pop_back();
    advance(end - 1, end, false);
    return true;
  }

  void report_duplicates(JsonId object) {
    std::vector<JsonId> members;
    for (JsonId id = tree[object].first_child; id != JsonId::None; id = tree[id].next_sibling) {
      members.push_back(id);
    }
    const std::vector<JsonId> in_order = members;
    std::stable_sort(members.begin(), members.end(), [&](JsonId a, JsonId b) { return tree[a].key < tree[b].key; });
    std::vector<JsonId> dropped;
    for (std::size_t i = 1; i < members.size(); ++i) {
      const JsonNode& first = tree[members[i - 1]];
      const JsonNode& second = tree[members[i]];
      if (first.key == second.key) {
        diagnostics_.add(Code::DuplicateKey, second.key_span, {second.key}).label(first.key_span, "first here");
        dropped.push_back(members[i]);
        members[i] = members[i - 1];  // a third one is compared with the first, too
      }
    }
    if (!dropped.empty()) {
      keep_others(object, in_order, dropped);
    }
  }

  /// The first of two members of one name counts.
  void keep_others(JsonId object, const std::vector<JsonId>& members, const std::vector<JsonId>& dropped) {
    tree[object].child_count -= static_cast<std::uint32_t>(dropped.size());
    JsonId last = JsonId::None;
    for (const JsonId id : members) {
      if (std::find(dropped.begin(), dropped.end(), id) == dropped.end()) {
        (last == JsonId::None ? tree[object].first_child : tree[last].next_sibling) = id;
        last = id;
      }
    }
    tree[last].next_sibling = JsonId::None;
  }

  std::string_view text_;
  Diagnostics& diagnostics_;
  JsonStop stop_;
  std::vector<JsonId> open_nodes_;
  std::vector<JsonId> last_children_;  // of each open node
  std::string key_;
  Span key_span_;
};

/// A byte that no text file holds, or that is no UTF-8, makes the file unreadable as a whole: one line says so.
bool is_text(FileId file, std::string_view text, Diagnostics& diagnostics) {
  const auto hex = [&](std::size_t at) { return fmt::format("{:02X}", static_cast<unsigned char>(text[at])); };
  const auto at_byte = [&](std::size_t at) {
    return Span{file, static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at + 1)};
  };
  const auto control = std::find_if(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte == 0x7FU || (byte < 0x20U && byte != '\n' && byte != '\r' && byte != '\t');
  });
  const std::size_t invalid = find_invalid_utf8(text);
  const auto control_at = static_cast<std::size_t>(control - text.begin());
  if (control != text.end() && control_at < invalid) {
    diagnostics.add(Code::NotText, at_byte(control_at), {hex(control_at)});
    return false;
  }
  if (invalid != std::string_view::npos) {
    diagnostics.add(Code::InvalidUtf8, at_byte(invalid), {hex(invalid)}).help("save the file as UTF-8");
    return false;
  }
  return true;
}

}  // namespace

std::optional<JsonTree> parse_json(const Sources& sources, FileId file, Diagnostics& diagnostics) {
  const std::string_view text = sources.file(file).bytes;
  if (!is_text(file, text, diagnostics)) {
    return std::nullopt;
  }
  TreeBuilder builder(file, text, diagnostics);
  const bool ok =
      nlohmann::json::sax_parse(text.begin(), text.end(), &builder, nlohmann::json::input_format_t::json, true, true);
  if (!ok) {
    return std::nullopt;
  }
  return std::move(builder.tree);
}

}  // namespace tectum
