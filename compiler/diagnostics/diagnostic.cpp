#include "compiler/diagnostics/diagnostic.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <tuple>
#include <utility>

namespace tectum {
namespace {

constexpr std::array kCodes = {
#define DIAGNOSTIC(number, severity, name, message) CodeInfo{number, Severity::severity, #name, message},
#include "compiler/diagnostics/diagnostics.def"
#undef DIAGNOSTIC
};

std::string fill(std::string_view format, const std::vector<std::string>& args) {
  std::string text;
  std::size_t next = 0;
  for (std::size_t i = 0; i < format.size(); ++i) {
    if (format.substr(i, 2) == "{}" && next < args.size()) {
      text += args[next++];
      ++i;
    } else {
      text += format[i];
    }
  }
  return text;
}

auto place(const Diagnostic& d) { return std::tuple(d.span.file, d.span.begin, d.span.end); }

}  // namespace

const CodeInfo& code_info(Code code) { return kCodes[static_cast<std::size_t>(code)]; }

std::size_t code_count() { return kCodes.size(); }

std::string code_label(Code code) {
  const CodeInfo& info = code_info(code);
  return fmt::format("{}{:04}", info.severity == Severity::Error ? 'E' : 'W', info.number);
}

std::optional<Code> find_code(std::string_view label) {
  std::string upper(label);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  for (std::size_t i = 0; i < kCodes.size(); ++i) {
    if (code_label(static_cast<Code>(i)) == upper) {
      return static_cast<Code>(i);
    }
  }
  return std::nullopt;
}

std::string Diagnostic::message() const { return fill(code_info(code).message, args); }

Diagnostics::Builder& Diagnostics::Builder::help(std::string text) {
  diagnostic_.help.push_back(std::move(text));
  return *this;
}

Diagnostics::Builder& Diagnostics::Builder::label(Span span, std::string text) {
  diagnostic_.labels.push_back({span, std::move(text)});
  return *this;
}

Diagnostics::Builder& Diagnostics::Builder::help_if(const std::optional<std::string>& value, std::string_view format) {
  if (value) {
    diagnostic_.help.push_back(fill(format, {*value}));
  }
  return *this;
}

Diagnostics::Builder Diagnostics::add(Code code, Span span, std::vector<std::string> args) {
  all_.push_back({code, span, std::move(args), {}, {}});
  error_count_ += code_info(code).severity == Severity::Error ? 1 : 0;
  return Builder(all_.back());
}

void Diagnostics::sort() {
  std::stable_sort(all_.begin(), all_.end(), [](const auto& a, const auto& b) { return place(a) < place(b); });
  const auto same = [](const Diagnostic& a, const Diagnostic& b) {
    return a.code == b.code && place(a) == place(b) && a.args == b.args;
  };
  all_.erase(std::unique(all_.begin(), all_.end(), same), all_.end());
  error_count_ = static_cast<std::size_t>(std::count_if(
      all_.begin(), all_.end(), [](const Diagnostic& d) { return code_info(d.code).severity == Severity::Error; }));
}

}  // namespace tectum
