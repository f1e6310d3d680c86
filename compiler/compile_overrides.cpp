#include "compiler/compile_overrides.h"

#include <algorithm>

#include <utility>

namespace tectum {
namespace {

NameDecl name_in(FileId file, const std::string& text, std::size_t begin, std::size_t end) {
  while (begin < end && text[begin] == ' ') {
    ++begin;
  }
  while (end > begin && text[end - 1] == ' ') {
    --end;
  }
  return {text.substr(begin, end - begin), {file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)}};
}

}  // namespace

Overrides make_overrides(const CompileOptions& options, Sources& sources, Diagnostics& diagnostics) {
  Overrides overrides;
  overrides.seed = options.seed;
  for (const std::string& text : options.parameters) {
    const FileId file = sources.add({"-p", text});
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      diagnostics.add(Code::UnexpectedToken, {file, 0, static_cast<std::uint32_t>(text.size())},
                      {"`name=value`", "`" + text + "`"});
      continue;
    }
    ParameterDecl parameter;
    parameter.name = name_in(file, text, 0, equals);
    const NameDecl value = name_in(file, text, equals + 1, text.size());
    parameter.value = {false, 0, value.text, value.span, true};
    overrides.parameters.push_back(std::move(parameter));
  }
  for (const std::string& text : options.lesions) {
    const FileId file = sources.add({"--lesion", text});
    LesionDecl lesion;
    const std::size_t colon = text.find(':');  // "EBN.left:0.5": half of it
    lesion.targets.push_back(name_in(file, text, 0, std::min(colon, text.size())));
    if (colon != std::string::npos) {
      const NameDecl fraction = name_in(file, text, colon + 1, text.size());
      lesion.fraction = {false, 0, fraction.text, fraction.span, true};
    }
    overrides.lesions.push_back(std::move(lesion));
  }
  return overrides;
}

}  // namespace tectum
