#include "tools/git/temporary_folder.h"

#include <cstdlib>
#include <system_error>

namespace tectum {

TemporaryFolder::TemporaryFolder() {
  std::error_code failure;
  std::string name = (std::filesystem::temp_directory_path(failure) / "tectum-XXXXXX").string();
  if (!failure && ::mkdtemp(name.data()) != nullptr) {
    path_ = std::filesystem::canonical(name, failure);
  }
}

TemporaryFolder::~TemporaryFolder() {
  if (!path_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
}

}  // namespace tectum
