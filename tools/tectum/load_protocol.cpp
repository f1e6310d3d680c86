#include "tools/tectum/load_protocol.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

std::string known_protocols(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".json") {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string protocol_path(const std::string& name, const std::string& circuit_path) {
  std::error_code ignored;
  if (name.ends_with(".json")) {
    return name;
  }
  const fs::path beside = fs::path(circuit_path).parent_path() / "protocols" / (name + ".json");
  return (fs::exists(beside, ignored) ? beside : fs::path("circuits/protocols") / (name + ".json")).string();
}

std::optional<Protocol> load_protocol(const std::string& name, const std::string& circuit_path,
                                      CommandContext& context) {
  const fs::path path = protocol_path(name, circuit_path);
  ReadProtocol read = read_protocol_file(path.string());
  context.err << read.problems;
  if (!read.protocol) {
    context.exit_status = read.error.empty() ? kExitFailed : kExitTrouble;
    if (!read.error.empty()) {
      context.err << fmt::format("tectum: {}\n", read.error);
      const std::string known = known_protocols(path.parent_path());
      if (!known.empty()) {
        context.err << fmt::format("    = help: {} holds {}\n", path.parent_path().string(), known);
      }
    }
    return std::nullopt;
  }
  return read.protocol;
}

}  // namespace tectum
