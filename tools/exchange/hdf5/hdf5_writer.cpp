#include <cerrno>
#include <cstring>

#include "tools/exchange/hdf5/handle.h"
#include "tools/exchange/hdf5_file.h"

namespace tectum {
namespace {

/// Variable-length UTF-8, which h5py reads as str.
Hdf5Handle text_type() {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), H5T_VARIABLE);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

Hdf5Handle space_of(std::span<const std::size_t> shape) {
  if (shape.empty()) {
    return {H5Screate(H5S_SCALAR), H5Sclose};
  }
  const std::vector<hsize_t> extents(shape.begin(), shape.end());
  return {H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), H5Sclose};
}

class FileWriter final : public Hdf5Writer {
 public:
  FileWriter(std::string path, hid_t file) : path_(std::move(path)), file_(file, H5Fclose) {}

  void group(const std::string& path) override {
    const Hdf5Handle links = parents();
    const Hdf5Handle made(H5Gcreate2(file_.id(), path.c_str(), links.id(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    check(made.is_open());
  }

  void write(const std::string& path, std::span<const double> values, std::span<const std::size_t> shape) override {
    dataset(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, shape, values.data());
  }
  void write(const std::string& path, std::span<const std::uint64_t> values) override {
    const std::size_t count = values.size();
    dataset(path, H5T_STD_U64LE, H5T_NATIVE_UINT64, std::span(&count, 1), values.data());
  }
  void write(const std::string& path, std::span<const std::uint32_t> values) override {
    const std::size_t count = values.size();
    dataset(path, H5T_STD_U32LE, H5T_NATIVE_UINT32, std::span(&count, 1), values.data());
  }
  void write(const std::string& path, std::span<const std::int64_t> values) override {
    const std::size_t count = values.size();
    dataset(path, H5T_STD_I64LE, H5T_NATIVE_INT64, std::span(&count, 1), values.data());
  }
  void write_text(const std::string& path, const std::string& value) override { write_texts(path, {value}, {}); }
  void write_texts(const std::string& path, const std::vector<std::string>& values,
                   std::span<const std::size_t> shape) override {
    std::vector<const char*> pointers;
    for (const std::string& value : values) {
      pointers.push_back(value.c_str());
    }
    const Hdf5Handle type = text_type();
    dataset(path, type.id(), type.id(), shape, pointers.data());
  }

  void attribute(const std::string& path, const std::string& name, const std::string& value) override {
    const Hdf5Handle type = text_type();
    const Hdf5Handle space = space_of({});
    const char* const pointer = value.c_str();
    attribute(path, name, type.id(), type.id(), space.id(), static_cast<const void*>(&pointer));
  }
  void attribute(const std::string& path, const std::string& name, std::span<const std::uint32_t> values) override {
    const std::size_t count = values.size();
    const Hdf5Handle space = count == 1 ? space_of({}) : space_of(std::span(&count, 1));
    attribute(path, name, H5T_STD_U32LE, H5T_NATIVE_UINT32, space.id(), values.data());
  }

  std::string close() override {
    check(file_.close());
    return has_failed_ ? "cannot write " + path_ : "";
  }

 private:
  static Hdf5Handle parents() {
    Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links.id(), 1);
    return links;
  }

  void dataset(const std::string& path, hid_t file_type, hid_t memory_type, std::span<const std::size_t> shape,
               const void* values) {
    const Hdf5Handle space = space_of(shape);
    const Hdf5Handle links = parents();
    const Hdf5Handle made(
        H5Dcreate2(file_.id(), path.c_str(), file_type, space.id(), links.id(), H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    check(made.is_open());
    const bool is_empty = H5Sget_simple_extent_npoints(space.id()) == 0;
    check(is_empty || (made.is_open() && H5Dwrite(made.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0));
  }

  void attribute(const std::string& path, const std::string& name, hid_t file_type, hid_t memory_type, hid_t space,
                 const void* values) {
    const Hdf5Handle made(H5Acreate_by_name(file_.id(), path.c_str(), name.c_str(), file_type, space, H5P_DEFAULT,
                                            H5P_DEFAULT, H5P_DEFAULT),
                          H5Aclose);
    check(made.is_open() && H5Awrite(made.id(), memory_type, values) >= 0);
  }

  void check(bool is_well) { has_failed_ = has_failed_ || !is_well; }

  std::string path_;
  Hdf5Handle file_;
  bool has_failed_ = false;
};

}  // namespace

extern "C" Hdf5Writer* tectum_open_hdf5_writer(const std::string& path, std::string& error) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // every failure is told by us
  errno = 0;
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (file < 0) {
    error = "cannot write " + path + (errno != 0 ? std::string(": ") + std::strerror(errno) : "");
    return nullptr;
  }
  return new FileWriter(path, file);
}

}  // namespace tectum
