#include "runtime/image/load_image.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "runtime/image/checksum.h"
#include "runtime/image/section_table.h"
#include "runtime/image/verify_image.h"

namespace tectum {
namespace {

std::string read_header(std::span<const std::byte> file, FileHeader& header) {
  if (!looks_like_image(file)) {
    return "not a spike image: the magic bytes are missing";
  }
  if (file.size() < sizeof(FileHeader)) {
    return "truncated: " + std::to_string(file.size()) + " bytes are less than a header";
  }
  std::memcpy(&header, file.data(), sizeof(header));
  if (header.version != kImageVersion) {
    return "image version " + std::to_string(header.version) + ", but this program reads version " +
           std::to_string(kImageVersion) + ": compile the circuit again";
  }
  if (header.file_bytes != file.size()) {
    return "truncated or extended: the header says " + std::to_string(header.file_bytes) + " bytes, the file has " +
           std::to_string(file.size());
  }
  if (header.checksum != image_checksum(file)) {
    return "damaged: the checksum does not match";
  }
  if (header.section_count != section_count(false) && header.section_count != section_count(true)) {
    return "section count is " + std::to_string(header.section_count) + ", not " +
           std::to_string(section_count(false)) + " or " + std::to_string(section_count(true));
  }
  if (file.size() < sizeof(FileHeader) + header.section_count * sizeof(SectionEntry)) {
    return "truncated: no room for the section table";
  }
  return {};
}

std::uint64_t align_up(std::uint64_t bytes) {
  return (bytes + kSectionAlignBytes - 1) / kSectionAlignBytes * kSectionAlignBytes;
}

// Maps each section. All sections are there, in order, each at the first aligned byte after the last.
std::string map_sections(std::span<const std::byte> file, SpikeImage& image) {
  const std::byte* entry_at = file.data() + sizeof(FileHeader);
  std::uint64_t end = sizeof(FileHeader) + image.header.section_count * sizeof(SectionEntry);
  std::string error;
  const auto map_section = [&]<typename T>(SectionKind kind, std::span<const T>& array) {
    SectionEntry entry{};
    std::memcpy(&entry, entry_at, sizeof(entry));
    entry_at += sizeof(entry);
    if (!error.empty()) {
      return;
    }
    const std::string where = "section " + std::to_string(static_cast<std::uint32_t>(kind));
    if (entry.kind != kind || entry.element_bytes != sizeof(T)) {
      error = where + " has kind " + std::to_string(static_cast<std::uint32_t>(entry.kind)) + " and elements of " +
              std::to_string(entry.element_bytes) + " bytes";
    } else if (entry.offset_bytes != align_up(end) || entry.offset_bytes > file.size()) {
      error = where + " starts at byte " + std::to_string(entry.offset_bytes);
    } else if (entry.count > (file.size() - entry.offset_bytes) / sizeof(T)) {
      error = where + " reaches past the end of the file";
    } else {
      end = entry.offset_bytes + entry.count * sizeof(T);
      array = {reinterpret_cast<const T*>(file.data() + entry.offset_bytes), static_cast<std::size_t>(entry.count)};
    }
  };
  for_each_section(image, map_section);
  if (image.header.section_count == section_count(true)) {
    for_each_plastic_section(image, map_section);
    if (error.empty() && image.plasticity.empty()) {
      error = "sections for learning, and nothing that learns";
    }
  }
  return error;
}

LoadedImage read_image(std::span<const std::byte> file, std::shared_ptr<const void> storage) {
  SpikeImage image;
  std::string error = read_header(file, image.header);
  if (error.empty()) {
    error = map_sections(file, image);
  }
  if (error.empty()) {
    error = verify_image(image);
  }
  if (!error.empty()) {
    return {std::nullopt, std::move(error)};
  }
  image.storage = std::move(storage);
  return {std::move(image), {}};
}

std::string system_error(const std::string& path) { return path + ": " + std::strerror(errno); }

struct Mapping {
  void* address = nullptr;
  std::size_t bytes = 0;

  Mapping(void* mapped_address, std::size_t mapped_bytes) : address(mapped_address), bytes(mapped_bytes) {}
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ~Mapping() { ::munmap(address, bytes); }
};

}  // namespace

std::string_view SpikeImage::name(std::uint32_t offset) const {
  return offset == kNoString ? std::string_view{} : std::string_view{strings.data() + offset};
}

std::optional<std::uint32_t> SpikeImage::find_population(std::string_view population_name) const {
  for (std::uint32_t p = 0; p < populations.size(); ++p) {
    if (name(populations[p].name) == population_name) {
      return p;
    }
  }
  return std::nullopt;
}

bool looks_like_image(std::span<const std::byte> first_bytes) {
  return first_bytes.size() >= kImageMagic.size() &&
         std::memcmp(first_bytes.data(), kImageMagic.data(), kImageMagic.size()) == 0;
}

LoadedImage load_image(std::vector<std::byte> bytes) {
  // operator new aligns to 16 bytes, which suffices for every element type.
  auto storage = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  const std::span<const std::byte> file = *storage;
  return read_image(file, std::move(storage));
}

LoadedImage load_image_file(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return {std::nullopt, system_error(path)};
  }
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) {
    LoadedImage failed{std::nullopt, system_error(path)};
    ::close(descriptor);
    return failed;
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(descriptor);
    return {std::nullopt, path + ": not a regular file"};
  }
  if (status.st_size == 0) {
    ::close(descriptor);
    return {std::nullopt, path + ": empty file"};
  }
  const auto bytes = static_cast<std::size_t>(status.st_size);
  void* address = ::mmap(nullptr, bytes, PROT_READ, MAP_PRIVATE, descriptor, 0);
  ::close(descriptor);
  if (address == MAP_FAILED) {
    return {std::nullopt, system_error(path)};
  }
  auto mapping = std::make_shared<const Mapping>(address, bytes);
  ::madvise(address, bytes, MADV_WILLNEED);
  LoadedImage loaded = read_image({static_cast<const std::byte*>(address), bytes}, std::move(mapping));
  if (!loaded.image) {
    loaded.error = path + ": " + loaded.error;
  }
  return loaded;
}

}  // namespace tectum
