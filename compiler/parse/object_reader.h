// Reads one JSON object key by key and says what does not fit.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/parse/circuit_decl.h"
#include "compiler/parse/json_tree.h"

namespace tectum {

/// Every read marks its key as known; finish() reports the keys that nothing read.
/// Absent keys are empty results. Wrong JSON types, and required keys that are absent, are reported and poisoned.
class ObjectReader {
 public:
  /// `what` names the object in messages: "population `EBN`".
  ObjectReader(const JsonTree& tree, JsonId object, std::string what, Diagnostics& diagnostics);

  /// False when it is no object; that has then been reported.
  [[nodiscard]] bool is_object() const { return is_object_; }
  [[nodiscard]] bool has(std::string_view key) const;

  std::optional<NameDecl> name(std::string_view key);
  std::optional<ValueDecl> value(std::string_view key);
  /// A string, or a list of strings.
  std::vector<NameDecl> names(std::string_view key);
  /// A list of values of this length (0 = any).
  std::vector<ValueDecl> values(std::string_view key, std::size_t count);
  std::string text(std::string_view key);
  ProvenanceDecl provenance();
  /// The member's node, None when absent.
  JsonId child(std::string_view key);

  /// As above, and reports a missing key.
  NameDecl required_name(std::string_view key);
  ValueDecl required_value(std::string_view key);
  std::vector<NameDecl> required_names(std::string_view key);

  /// The members that no call has read yet, as values; marks them read.
  std::vector<KeyedValue> rest();
  void report_missing(std::string_view key);
  void finish();

  [[nodiscard]] const std::string& what() const { return what_; }
  [[nodiscard]] JsonId id() const { return object_; }
  [[nodiscard]] Span span() const { return tree_[object_].span; }

 private:
  NameDecl name_of(JsonId id, std::string_view key);
  ValueDecl value_of(JsonId id, std::string_view key);
  /// The member that was probably meant to be `key`, None when there is none.
  [[nodiscard]] JsonId misspelt(std::string_view key) const;
  void report_type(JsonId id, std::string_view key, std::string_view expected);

  const JsonTree& tree_;
  JsonId object_;
  std::string what_;
  Diagnostics& diagnostics_;
  bool is_object_ = false;
  std::vector<std::string> known_;  // keys that were asked for by name
  std::vector<std::string> rest_;   // keys that rest() gave away
  std::vector<std::string> missing_;
};

/// The bytes between the quotes of a string node; the whole of any other.
[[nodiscard]] Span inner_span(const JsonNode& node);

}  // namespace tectum
