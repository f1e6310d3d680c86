// Circuits and commands for the tests of export and import.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/image/load_image.h"

namespace tectum {

/// A folder that goes with its owner.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

struct CommandResult {
  int exit_status = 0;
  std::string out, err;
};

/// `tectum ARGS...`
[[nodiscard]] CommandResult tectum(const std::vector<std::string>& args);
/// The same; fails the test, with what was printed, unless the command succeeds.
CommandResult tectum_succeeds(const std::vector<std::string>& args);

/// One population of every kind; one circuit that moves a head.
[[nodiscard]] std::string every_model_path();
[[nodiscard]] std::string oculomotor_path();

[[nodiscard]] std::string text_of(const std::string& path);
void write_text(const std::string& path, const std::string& text);

/// The circuit file compiled, or the test fails with its diagnostics.
[[nodiscard]] SpikeImage compiled_file(const std::string& path);

}  // namespace tectum
