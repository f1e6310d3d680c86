// HDF5 files as named arrays, through the library libtectum_hdf5.so beside the binary.
//
// HDF5 brings a dozen shared libraries with it that no other command needs, so they are linked into a library of their
// own, which is loaded when the first HDF5 file is opened.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tectum {

/// Makes a file. Groups on the way to a dataset are made as needed. The first failure is kept for close().
class Hdf5Writer {
 public:
  /// Null with one line in `error` when the file or the library cannot be opened.
  [[nodiscard]] static std::unique_ptr<Hdf5Writer> open(const std::string& path, std::string& error);
  Hdf5Writer() = default;
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;
  virtual ~Hdf5Writer() = default;

  virtual void group(const std::string& path) = 0;
  /// Row by row; an empty shape is a single value.
  virtual void write(const std::string& path, std::span<const double> values, std::span<const std::size_t> shape) = 0;
  virtual void write(const std::string& path, std::span<const std::uint64_t> values) = 0;
  virtual void write(const std::string& path, std::span<const std::uint32_t> values) = 0;
  virtual void write(const std::string& path, std::span<const std::int64_t> values) = 0;
  virtual void write_text(const std::string& path, const std::string& value) = 0;
  /// UTF-8 texts of any length, row by row.
  virtual void write_texts(const std::string& path, const std::vector<std::string>& values,
                           std::span<const std::size_t> shape) = 0;
  /// On a group or dataset that is there.
  virtual void attribute(const std::string& path, const std::string& name, const std::string& value) = 0;
  virtual void attribute(const std::string& path, const std::string& name, std::span<const std::uint32_t> values) = 0;
  /// "cannot write PATH", or nothing.
  [[nodiscard]] virtual std::string close() = 0;

  void write(const std::string& path, const std::vector<double>& values) {
    const std::size_t count = values.size();
    write(path, values, std::span(&count, 1));
  }
};

struct Hdf5Entry {
  std::string name;
  bool is_group = false;
};

class Hdf5Reader {
 public:
  /// Null with one line in `error` when the file or the library cannot be opened.
  [[nodiscard]] static std::unique_ptr<Hdf5Reader> open(const std::string& path, std::string& error);
  Hdf5Reader() = default;
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;
  virtual ~Hdf5Reader() = default;

  /// What a group holds, by name; empty when there is no such group.
  [[nodiscard]] virtual std::vector<Hdf5Entry> list(const std::string& group) = 0;
  [[nodiscard]] virtual bool has(const std::string& path) = 0;
  /// Extents of a dataset; nothing when there is none.
  [[nodiscard]] virtual std::optional<std::vector<std::size_t>> shape(const std::string& path) = 0;
  /// All of a dataset, row by row, converted. Nothing when it is missing or of another class.
  [[nodiscard]] virtual std::optional<std::vector<double>> numbers(const std::string& path) = 0;
  [[nodiscard]] virtual std::optional<std::vector<std::int64_t>> integers(const std::string& path) = 0;
  [[nodiscard]] virtual std::optional<std::vector<std::string>> texts(const std::string& path) = 0;
  [[nodiscard]] virtual std::optional<std::string> text_attribute(const std::string& path, const std::string& name) = 0;
};

extern "C" {
Hdf5Writer* tectum_open_hdf5_writer(const std::string& path, std::string& error);
Hdf5Reader* tectum_open_hdf5_reader(const std::string& path, std::string& error);
}

}  // namespace tectum
