#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "tools/exchange/hdf5_file.h"

namespace tectum {
namespace {

constexpr const char* kLibraryName = "libtectum_hdf5.so";

/// Beside the binary, else one folder up (where a build leaves it for its tests), else where the system looks.
void* open_library() {
  std::error_code failed;
  const std::filesystem::path binary = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (!failed) {
    for (const std::filesystem::path& folder : {binary.parent_path(), binary.parent_path().parent_path()}) {
      if (std::filesystem::exists(folder / kLibraryName, failed)) {
        return dlopen((folder / kLibraryName).c_str(), RTLD_NOW | RTLD_LOCAL);
      }
    }
  }
  return dlopen(kLibraryName, RTLD_NOW | RTLD_LOCAL);
}

/// Never closed: readers and writers live in it.
template <typename Function>
Function* find_function(const char* name, std::string& error) {
  static void* const library = open_library();
  if (library == nullptr) {
    const char* why = dlerror();
    error = std::string(kLibraryName) + ", which reads and writes HDF5, cannot be loaded" +
            (why != nullptr ? std::string(": ") + why : "");
    return nullptr;
  }
  auto* const function = reinterpret_cast<Function*>(dlsym(library, name));
  if (function == nullptr) {
    error = std::string(kLibraryName) + " is of another version: it has no " + name;
  }
  return function;
}

}  // namespace

std::unique_ptr<Hdf5Writer> Hdf5Writer::open(const std::string& path, std::string& error) {
  auto* const function = find_function<decltype(tectum_open_hdf5_writer)>("tectum_open_hdf5_writer", error);
  return std::unique_ptr<Hdf5Writer>(function != nullptr ? function(path, error) : nullptr);
}

std::unique_ptr<Hdf5Reader> Hdf5Reader::open(const std::string& path, std::string& error) {
  auto* const function = find_function<decltype(tectum_open_hdf5_reader)>("tectum_open_hdf5_reader", error);
  return std::unique_ptr<Hdf5Reader>(function != nullptr ? function(path, error) : nullptr);
}

}  // namespace tectum
