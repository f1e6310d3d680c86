#include <cassert>
#include <cstring>

#include "runtime/image/checksum.h"
#include "runtime/image/image_contents.h"
#include "runtime/image/section_table.h"

namespace tectum {
namespace {

std::size_t align_up(std::size_t bytes) {
  return (bytes + kSectionAlignBytes - 1) / kSectionAlignBytes * kSectionAlignBytes;
}

}  // namespace

std::uint32_t ImageContents::add_string(std::string_view text) {
  const auto offset = static_cast<std::uint32_t>(strings.size());
  strings.insert(strings.end(), text.begin(), text.end());
  strings.push_back('\0');
  return offset;
}

std::vector<std::byte> write_image(const ImageContents& contents) {
  const bool learns = !contents.plasticity.empty();
  const auto for_each = [&](const auto& visit) {
    for_each_section(contents, visit);
    if (learns) {
      for_each_plastic_section(contents, visit);
    }
  };
  std::vector<SectionEntry> entries;
  entries.reserve(section_count(learns));
  std::size_t end = align_up(sizeof(FileHeader) + section_count(learns) * sizeof(SectionEntry));
  for_each([&](SectionKind kind, const auto& array) {
    constexpr std::size_t element_bytes = sizeof(array[0]);
    entries.push_back({kind, static_cast<std::uint32_t>(element_bytes), end, array.size()});
    end = align_up(end + array.size() * element_bytes);
  });
  assert(entries.size() == section_count(learns));

  // The vector's zeroes are the padding between sections.
  std::vector<std::byte> file(end);
  std::size_t next = 0;
  for_each([&](SectionKind, const auto& array) {
    const SectionEntry& entry = entries[next++];
    if (!array.empty()) {
      std::memcpy(file.data() + entry.offset_bytes, array.data(), array.size() * sizeof(array[0]));
    }
  });
  std::memcpy(file.data() + sizeof(FileHeader), entries.data(), entries.size() * sizeof(SectionEntry));

  FileHeader header{};
  header.magic = kImageMagic;
  header.version = kImageVersion;
  header.section_count = section_count(learns);
  header.file_bytes = file.size();
  header.tick_ns = contents.tick_ns;
  header.seed = contents.seed;
  header.circuit_name = contents.circuit_name;
  header.neuron_count = contents.neuron_count;
  header.slot_count = contents.slot_count;
  header.max_delay_ticks = contents.max_delay_ticks;
  std::memcpy(file.data(), &header, sizeof(header));
  header.checksum = image_checksum(file);
  std::memcpy(file.data(), &header, sizeof(header));
  return file;
}

}  // namespace tectum
