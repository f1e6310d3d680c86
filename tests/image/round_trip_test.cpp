#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "runtime/image/checksum.h"
#include "runtime/image/image_contents.h"
#include "runtime/image/load_image.h"
#include "runtime/image/section_table.h"
#include "tests/support/example_contents.h"

namespace tectum {
namespace {

struct TemporaryFile {
  std::string path;
  explicit TemporaryFile(std::span<const std::byte> bytes)
      : path((std::filesystem::temp_directory_path() / ("tectum-image-test-" + std::to_string(::getpid()))).string()) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { std::remove(path.c_str()); }
};

// The bytes of each section, in order.
template <typename Arrays>
std::vector<std::string> section_bytes(const Arrays& arrays) {
  std::vector<std::string> sections;
  for_each_section(arrays, [&](SectionKind, const auto& array) {
    sections.emplace_back(reinterpret_cast<const char*>(array.data()), array.size() * sizeof(array[0]));
  });
  return sections;
}

TEST_CASE("an image that is written and loaded holds the same arrays") {
  const ImageContents contents = test::example_contents();
  const LoadedImage loaded = load_image(write_image(contents));
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  CHECK(section_bytes(*loaded.image) == section_bytes(contents));
  CHECK(loaded.image->header.tick_ns == 100'000);
  CHECK(loaded.image->header.seed == 7);
  CHECK(loaded.image->name(loaded.image->header.circuit_name) == "test");
  CHECK(loaded.image->find_population("lif") == 2);
  CHECK(!loaded.image->find_population("lfi"));
  CHECK(loaded.image->name(kNoString).empty());
}

TEST_CASE("the same contents give the same bytes") {
  CHECK(write_image(test::example_contents()) == write_image(test::example_contents()));
}

TEST_CASE("a mapped file holds what a loaded one does") {
  const std::vector<std::byte> bytes = write_image(test::example_contents());
  const TemporaryFile file(bytes);
  const LoadedImage mapped = load_image_file(file.path);
  REQUIRE_MESSAGE(mapped.image.has_value(), mapped.error);
  CHECK(section_bytes(*mapped.image) == section_bytes(*load_image(bytes).image));
}

TEST_CASE("the image outlives the loader's own handle on its bytes") {
  SpikeImage copy;
  {
    const LoadedImage loaded = load_image(write_image(test::example_contents()));
    copy = loaded.image.value();
  }
  CHECK(copy.find_population("gate") == 3);
}

TEST_CASE("an image cut at any length is refused with a reason") {
  const std::vector<std::byte> bytes = write_image(test::example_contents());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    CAPTURE(length);
    const LoadedImage loaded = load_image({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)});
    REQUIRE(!loaded.image.has_value());
    REQUIRE(!loaded.error.empty());
    REQUIRE(loaded.error.find('\n') == std::string::npos);
  }
}

TEST_CASE("an image with any one bit flipped is refused") {
  const std::vector<std::byte> bytes = write_image(test::example_contents());
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    CAPTURE(bit);
    std::vector<std::byte> damaged = bytes;
    damaged[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    REQUIRE(!load_image(std::move(damaged)).image.has_value());
  }
}

TEST_CASE("bytes after the end are refused") {
  std::vector<std::byte> bytes = write_image(test::example_contents());
  bytes.resize(bytes.size() + 64);
  CHECK(load_image(bytes).error.find("truncated or extended") == 0);
}

TEST_CASE("a file that cannot be an image gets one clear line") {
  CHECK(load_image_file("/nonexistent/circuit.image").error.find("No such file") != std::string::npos);
  CHECK(load_image_file("/").error.find("not a regular file") != std::string::npos);
  const TemporaryFile empty({});
  CHECK(load_image_file(empty.path).error.find("empty file") != std::string::npos);
  CHECK(load_image({}).error == "not a spike image: the magic bytes are missing");
}

TEST_CASE("an image of another version says so") {
  std::vector<std::byte> bytes = write_image(test::example_contents());
  const std::uint32_t version = kImageVersion + 1;
  std::memcpy(bytes.data() + offsetof(FileHeader, version), &version, sizeof(version));
  CHECK(load_image(bytes).error.find("compile the circuit again") != std::string::npos);
}

TEST_CASE("the checksum tells every length of zeroes apart") {
  const std::vector<std::byte> zeroes(300);
  std::vector<std::uint64_t> sums;
  for (std::size_t length = 0; length <= zeroes.size(); ++length) {
    sums.push_back(checksum64(std::span(zeroes).first(length)));
  }
  std::sort(sums.begin(), sums.end());
  CHECK(std::adjacent_find(sums.begin(), sums.end()) == sums.end());
}

}  // namespace
}  // namespace tectum
