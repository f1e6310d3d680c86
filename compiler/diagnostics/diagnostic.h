// What is wrong with a circuit, as flat data. Printed elsewhere (render.h), never where it is found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/source/source_file.h"

namespace tectum {

enum class Severity : std::uint8_t { Error, Warning };

/// One enumerator a row of diagnostics.def; its value is the row's index.
enum class Code : std::uint16_t {
#define DIAGNOSTIC(number, severity, name, message) name,
#include "compiler/diagnostics/diagnostics.def"
#undef DIAGNOSTIC
};

struct CodeInfo {
  std::uint16_t number;
  Severity severity;
  std::string_view name;     // "UnknownPopulation"
  std::string_view message;  // with one {} an argument
};
[[nodiscard]] const CodeInfo& code_info(Code code);
[[nodiscard]] std::size_t code_count();
/// "E0204", "W0401".
[[nodiscard]] std::string code_label(Code code);
/// Takes the label in any case.
[[nodiscard]] std::optional<Code> find_code(std::string_view label);

/// A second place that the message speaks of.
struct Label {
  Span span;
  std::string text;
};

struct Diagnostic {
  Code code;
  Span span;
  std::vector<std::string> args;
  std::vector<Label> labels;
  std::vector<std::string> help;

  /// The message with its arguments filled in.
  [[nodiscard]] std::string message() const;
};

class Diagnostics {
 public:
  /// Adds to the diagnostic just reported. Use within the statement that reports it.
  class Builder {
   public:
    explicit Builder(Diagnostic& diagnostic) : diagnostic_(diagnostic) {}
    Builder& help(std::string text);
    Builder& label(Span span, std::string text);
    /// Fills the {} of `format` with `value`, when there is one.
    Builder& help_if(const std::optional<std::string>& value, std::string_view format);

   private:
    Diagnostic& diagnostic_;
  };

  Builder add(Code code, Span span, std::vector<std::string> args = {});

  /// In order of place, the first to mend first. Two with the same code and span are one.
  void sort();

  [[nodiscard]] const std::vector<Diagnostic>& all() const { return all_; }
  [[nodiscard]] bool has_errors() const { return error_count_ > 0; }
  [[nodiscard]] std::size_t error_count() const { return error_count_; }
  [[nodiscard]] std::size_t warning_count() const { return all_.size() - error_count_; }

 private:
  std::vector<Diagnostic> all_;
  std::size_t error_count_ = 0;
};

}  // namespace tectum
