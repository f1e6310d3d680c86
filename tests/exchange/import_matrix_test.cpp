#include <doctest/doctest.h>

#include <cstring>

#include "tests/exchange/exchanged_circuit.h"
#include "tools/exchange/array.h"
#include "tools/exchange/import_matrix.h"

namespace tectum {
namespace {

void put(std::string& out, std::uint32_t value, int bytes) {
  for (int b = 0; b < bytes; ++b) {
    out += static_cast<char>(value >> (8 * b) & 0xFFU);
  }
}

/// A .npy of format 1.0.
std::string npy(const std::string& type, const std::string& shape, const std::string& data, bool is_fortran = false) {
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': " + (is_fortran ? "True" : "False") + ", 'shape': " + shape + ", }\n";
  std::string bytes("\x93NUMPY\x01\x00", 8);
  put(bytes, static_cast<std::uint32_t>(header.size()), 2);
  return bytes + header + data;
}

template <typename Number>
std::string bytes_of(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

/// A ZIP archive of stored members.
std::string zip(const std::vector<std::pair<std::string, std::string>>& members) {
  std::string out, directory;
  for (const auto& [name, content] : members) {
    const auto at = static_cast<std::uint32_t>(out.size());
    const auto size = static_cast<std::uint32_t>(content.size());
    const auto name_size = static_cast<std::uint32_t>(name.size());
    std::string fields;
    for (int k = 0; k < 5; ++k) {
      put(fields, 0, 2);  // version, flags, method: stored, time, date
    }
    put(fields, 0, 4);  // the checksum, which readers of arrays may leave alone
    put(fields, size, 4);
    put(fields, size, 4);
    put(fields, name_size, 2);
    put(fields, 0, 2);
    put(out, 0x04034b50U, 4);
    out += fields + name + content;
    put(directory, 0x02014b50U, 4);
    put(directory, 0, 2);
    directory += fields + std::string(10, '\0');
    put(directory, at, 4);
    directory += name;
  }
  const auto directory_at = static_cast<std::uint32_t>(out.size());
  out += directory;
  put(out, 0x06054b50U, 4);
  put(out, 0, 4);
  put(out, static_cast<std::uint32_t>(members.size()), 2);
  put(out, static_cast<std::uint32_t>(members.size()), 2);
  put(out, static_cast<std::uint32_t>(directory.size()), 4);
  put(out, directory_at, 4);
  put(out, 0, 2);
  return out;
}

std::string element(std::uint32_t type, const std::string& data) {
  std::string bytes;
  put(bytes, type, 4);
  put(bytes, static_cast<std::uint32_t>(data.size()), 4);
  return bytes + data + std::string((8 - data.size() % 8) % 8, '\0');
}

std::string mat_file(const std::string& elements) {
  std::string bytes = "MATLAB 5.0 MAT-file";
  bytes.resize(124, ' ');
  return bytes + std::string("\x00\x01IM", 4) + elements;
}

// [[0, 2, 0], [-1, 0, 4], [0, 0.5, 0]]
const std::vector<double> kDense = {0, 2, 0, -1, 0, 4, 0, 0.5, 0};

SparseMatrix read(const std::string& path, const std::string& variable = "") {
  std::string error;
  const auto matrix = read_matrix(path, variable, error);
  REQUIRE_MESSAGE(matrix.has_value(), error);
  return *matrix;
}

void check_is_the_matrix(const SparseMatrix& matrix) {
  CHECK(matrix.rows == 3);
  CHECK(matrix.columns == 3);
  CHECK(matrix.row == std::vector<std::uint32_t>{0, 1, 1, 2});
  CHECK(matrix.column == std::vector<std::uint32_t>{1, 0, 2, 1});
  CHECK(matrix.value == std::vector<double>{2, -1, 4, 0.5});
}

TEST_CASE("a matrix is the same from every file that NumPy, SciPy and MATLAB write of it") {
  const ScratchFolder folder;
  write_text(folder.file("c.npz"), zip({{"W.npy", npy("<f8", "(3, 3)", bytes_of(kDense))}}));
  check_is_the_matrix(read(folder.file("c.npz")));
  write_text(folder.file("f.npy"),
             npy("<f8", "(3, 3)", bytes_of<double>({0, -1, 0, 2, 0, 0.5, 0, 4, 0}), /*is_fortran=*/true));
  check_is_the_matrix(read(folder.file("f.npy")));
  const std::string shape = npy("<i8", "(2,)", bytes_of<std::int64_t>({3, 3}));
  write_text(folder.file("csr.npz"), zip({{"indices.npy", npy("<i4", "(4,)", bytes_of<std::int32_t>({1, 0, 2, 1}))},
                                          {"indptr.npy", npy("<i4", "(4,)", bytes_of<std::int32_t>({0, 1, 3, 4}))},
                                          {"format.npy", npy("|S3", "()", "csr")},
                                          {"shape.npy", shape},
                                          {"data.npy", npy("<f4", "(4,)", bytes_of<float>({2, -1, 4, 0.5}))}}));
  check_is_the_matrix(read(folder.file("csr.npz")));
  write_text(folder.file("csc.npz"), zip({{"indices.npy", npy("<i4", "(4,)", bytes_of<std::int32_t>({1, 0, 2, 1}))},
                                          {"indptr.npy", npy("<i4", "(4,)", bytes_of<std::int32_t>({0, 1, 3, 4}))},
                                          {"format.npy", npy("|S3", "()", "csc")},
                                          {"shape.npy", shape},
                                          {"data.npy", npy("<f8", "(4,)", bytes_of<double>({-1, 2, 0.5, 4}))}}));
  check_is_the_matrix(read(folder.file("csc.npz")));
  write_text(folder.file("coo.npz"), zip({{"row.npy", npy("<i4", "(5,)", bytes_of<std::int32_t>({1, 2, 0, 1, 1}))},
                                          {"col.npy", npy("<i4", "(5,)", bytes_of<std::int32_t>({2, 1, 1, 0, 2}))},
                                          {"format.npy", npy("|S3", "()", "coo")},
                                          {"shape.npy", shape},
                                          {"data.npy", npy("<f8", "(5,)", bytes_of<double>({3, 0.5, 2, -1, 1}))}}));
  check_is_the_matrix(read(folder.file("coo.npz")));  // entries that are given twice are added
}

TEST_CASE("MATLAB's dense and sparse matrices are read, column after column") {
  const ScratchFolder folder;
  const std::string dimensions = element(5, bytes_of<std::int32_t>({3, 3}));
  const std::string dense = element(6, bytes_of<std::uint32_t>({6, 0})) + dimensions + element(1, "W") +
                            element(9, bytes_of<double>({0, -1, 0, 2, 0, 0.5, 0, 4, 0}));
  const std::string sparse = element(6, bytes_of<std::uint32_t>({5, 4})) + dimensions + element(1, "S") +
                             element(5, bytes_of<std::int32_t>({1, 0, 2, 1})) +
                             element(5, bytes_of<std::int32_t>({0, 1, 3, 4})) +
                             element(9, bytes_of<double>({-1, 2, 0.5, 4}));
  write_text(folder.file("a.mat"), mat_file(element(14, dense) + element(14, sparse)));
  check_is_the_matrix(read(folder.file("a.mat"), "W"));
  check_is_the_matrix(read(folder.file("a.mat"), "S"));
  std::string error;
  CHECK_FALSE(read_matrix(folder.file("a.mat"), "", error).has_value());
  CHECK(error.find("name one with --variable: S, W") != std::string::npos);
}

TEST_CASE("no cut-off file crashes the readers, and each is refused") {
  const std::string whole = zip({{"W.npy", npy("<f8", "(3, 3)", bytes_of(kDense))}});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    std::string error;
    CHECK_FALSE(parse_npz(whole.substr(0, size), error).has_value());
  }
  const std::string dense = element(6, bytes_of<std::uint32_t>({6, 0})) + element(5, bytes_of<std::int32_t>({3, 3})) +
                            element(1, "W") + element(9, bytes_of(kDense));
  const std::string mat = mat_file(element(14, dense));
  for (std::size_t size = 129; size < mat.size(); ++size) {
    std::string error;
    CHECK_FALSE(parse_mat(mat.substr(0, size), error).has_value());
  }
}

TEST_CASE("the leading eigenvalue is found where it is known") {
  SparseMatrix matrix;
  matrix.rows = matrix.columns = 2;
  matrix.row = {0, 0, 1, 1};
  matrix.column = {0, 1, 0, 1};
  matrix.value = {2, 1, 1, 2};  // 3 and 1
  CHECK(leading_eigenvalue(matrix) == doctest::Approx(3).epsilon(1e-9));
  matrix.value = {0, -2, 2, 0};  // a rotation: 2i and -2i
  CHECK(leading_eigenvalue(matrix) == doctest::Approx(2).epsilon(1e-9));
  matrix.value = {0, 5, 0, 0};  // no cycle
  CHECK(leading_eigenvalue(matrix) == 0);
}

TEST_CASE("a matrix becomes a circuit that compiles, with its signs, its scale and its input") {
  const ScratchFolder folder;
  write_text(folder.file("w.npz"), zip({{"W.npy", npy("<f8", "(3, 3)", bytes_of(kDense))}}));
  tectum_succeeds({"import", "matrix", folder.file("w.npz"), "--divide-by-input", "--scale", "8", "--drive", "20", "-o",
                   folder.file("w.json")});
  const SpikeImage image = compiled_file(folder.file("w.json"));
  CHECK(image.header.neuron_count == 6);  // three cells and what drives them
  CHECK(image.targets.size() == 7);
  const std::string text = text_of(folder.file("w.json"));
  CHECK(text.find("\"sign\": \"inhibitory\"") != std::string::npos);
  // Cell 1 gets 2 and 0.5: 0.8 and 0.2 of its input, times 8 nA.
  CHECK(text_of(folder.file("w_wiring/excitation.csv")) == "pre,post,weight\n0,1,6.4\n1,2,8\n2,1,1.6\n");
}

TEST_CASE("rows are sources unless they are said to be targets") {
  const ScratchFolder folder;
  write_text(folder.file("w.npz"), zip({{"W.npy", npy("<f8", "(2, 3)", bytes_of<double>({0, 0, 1, 1, 0, 0}))}}));
  tectum_succeeds({"import", "matrix", folder.file("w.npz"), "-o", folder.file("a.json")});
  CHECK(text_of(folder.file("a_wiring/excitation.csv")) == "pre,post\n0,2\n1,0\n");
  tectum_succeeds({"import", "matrix", folder.file("w.npz"), "--rows-are-targets", "-o", folder.file("b.json")});
  CHECK(text_of(folder.file("b_wiring/excitation.csv")) == "pre,post\n2,0\n0,1\n");
  CHECK(compiled_file(folder.file("b.json")).header.neuron_count == 5);
}

}  // namespace
}  // namespace tectum
