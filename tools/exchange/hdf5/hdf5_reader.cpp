#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tools/exchange/hdf5/handle.h"
#include "tools/exchange/hdf5_file.h"

namespace tectum {
namespace {

// A damaged file can name any extent; what one array may hold is bounded by what a machine could.
constexpr hssize_t kMaxValues = hssize_t{1} << 32;

class FileReader final : public Hdf5Reader {
 public:
  explicit FileReader(hid_t file) : file_(file, H5Fclose) {}

  std::vector<Hdf5Entry> list(const std::string& group) override {
    std::vector<Hdf5Entry> entries;
    const Hdf5Handle opened(has(group) ? H5Gopen2(file_.id(), group.c_str(), H5P_DEFAULT) : -1, H5Gclose);
    if (!opened.is_open()) {
      return entries;
    }
    const auto add = [](hid_t where, const char* name, const H5L_info_t*, void* to) -> herr_t {
      const Hdf5Handle object(H5Oopen(where, name, H5P_DEFAULT), H5Oclose);
      if (object.is_open()) {
        static_cast<std::vector<Hdf5Entry>*>(to)->push_back({name, H5Iget_type(object.id()) == H5I_GROUP});
      }
      return 0;
    };
    H5Literate(opened.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &entries);
    return entries;
  }

  bool has(const std::string& path) override {
    // Every step of the way must be there before the next may be asked for.
    for (std::size_t end = path.find('/', 1); !path.empty() && path != "/"; end = path.find('/', end + 1)) {
      if (H5Lexists(file_.id(), path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) {
        return false;
      }
      if (end == std::string::npos) {
        return H5Oexists_by_name(file_.id(), path.c_str(), H5P_DEFAULT) > 0;
      }
    }
    return path == "/";
  }

  std::optional<std::vector<std::size_t>> shape(const std::string& path) override {
    const Hdf5Handle dataset = open_dataset(path);
    if (!dataset.is_open()) {
      return std::nullopt;
    }
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    std::vector<hsize_t> extents(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space.id()))));
    H5Sget_simple_extent_dims(space.id(), extents.data(), nullptr);
    return std::vector<std::size_t>(extents.begin(), extents.end());
  }

  std::optional<std::vector<double>> numbers(const std::string& path) override {
    return read<double>(path, H5T_NATIVE_DOUBLE);
  }
  std::optional<std::vector<std::int64_t>> integers(const std::string& path) override {
    return read<std::int64_t>(path, H5T_NATIVE_INT64);
  }

  std::optional<std::vector<std::string>> texts(const std::string& path) override {
    const Hdf5Handle dataset = open_dataset(path);
    if (!dataset.is_open()) {
      return std::nullopt;
    }
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    return texts_of(type.id(), space.id(), [&](hid_t memory_type, void* to) {
      return H5Dread(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to) >= 0;
    });
  }

  std::optional<std::string> text_attribute(const std::string& path, const std::string& name) override {
    if (!has(path) || H5Aexists_by_name(file_.id(), path.c_str(), name.c_str(), H5P_DEFAULT) <= 0) {
      return std::nullopt;
    }
    const Hdf5Handle attribute(H5Aopen_by_name(file_.id(), path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
    const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
    const auto read = texts_of(type.id(), space.id(), [&](hid_t memory_type, void* to) {
      return H5Aread(attribute.id(), memory_type, to) >= 0;
    });
    return read && read->size() == 1 ? std::optional(read->front()) : std::nullopt;
  }

 private:
  Hdf5Handle open_dataset(const std::string& path) {
    return {has(path) ? H5Dopen2(file_.id(), path.c_str(), H5P_DEFAULT) : -1, H5Dclose};
  }

  template <typename Number>
  std::optional<std::vector<Number>> read(const std::string& path, hid_t memory_type) {
    const Hdf5Handle dataset = open_dataset(path);
    if (!dataset.is_open()) {
      return std::nullopt;
    }
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    const H5T_class_t kind = H5Tget_class(type.id());
    if (count < 0 || count > kMaxValues || (kind != H5T_INTEGER && kind != H5T_FLOAT && kind != H5T_ENUM)) {
      return std::nullopt;
    }
    std::vector<Number> values(static_cast<std::size_t>(count));
    if (H5Dread(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
      return std::nullopt;
    }
    return values;
  }

  template <typename Read>
  static std::optional<std::vector<std::string>> texts_of(hid_t type, hid_t space, const Read& read) {
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (H5Tget_class(type) != H5T_STRING || count < 0 || count > kMaxValues) {
      return std::nullopt;
    }
    std::vector<std::string> result;
    if (H5Tis_variable_str(type) > 0) {
      std::vector<char*> pointers(static_cast<std::size_t>(count), nullptr);
      if (!read(type, static_cast<void*>(pointers.data()))) {
        return std::nullopt;
      }
      for (const char* text : pointers) {
        result.emplace_back(text != nullptr ? text : "");
      }
      H5Dvlen_reclaim(type, space, H5P_DEFAULT, static_cast<void*>(pointers.data()));
      return result;
    }
    const std::size_t length = H5Tget_size(type);
    std::vector<char> bytes(static_cast<std::size_t>(count) * length);
    if (!read(type, bytes.data())) {
      return std::nullopt;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const char* const begin = bytes.data() + i * length;
      result.emplace_back(begin, strnlen(begin, length));
    }
    return result;
  }

  Hdf5Handle file_;
};

}  // namespace

extern "C" Hdf5Reader* tectum_open_hdf5_reader(const std::string& path, std::string& error) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // every failure is told by us
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    error = path + ": " + std::strerror(errno);
    return nullptr;
  }
  if (S_ISDIR(status.st_mode)) {
    error = path + ": is a directory, not an HDF5 file";
    return nullptr;
  }
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) {
    error = path + ": is no HDF5 file, or a damaged one";
    return nullptr;
  }
  return new FileReader(file);
}

}  // namespace tectum
