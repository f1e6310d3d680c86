// Reading a spike image: from memory, or mapped from a file. A hostile file is refused with a
// reason and never crashes.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/image/plasticity.h"
#include "runtime/image/spike_image.h"

namespace tectum {

/// A verified image. Spans point into `storage`, which keeps the bytes (or the mapping) alive.
/// Every index in every array has been checked by verify_image, so readers check nothing.
struct SpikeImage {
  FileHeader header{};
  std::span<const char> strings;
  std::span<const PopulationRecord> populations;
  std::span<const GroupRecord> groups;
  std::span<const ReceptorRecord> receptors;
  std::span<const double> parameters;
  std::span<const double> columns;
  std::span<const float> tables;
  std::span<const std::uint32_t> row_begin;
  std::span<const SegmentRecord> segments;
  std::span<const std::uint32_t> targets;
  std::span<const std::int32_t> weights;
  std::span<const ProjectionRecord> projections;
  std::span<const RetinaRecord> retinas;
  std::span<const FieldRecord> fields;
  std::span<const OutputRecord> outputs;
  std::span<const OutputTermRecord> output_terms;
  std::span<const JointRecord> joints;
  std::span<const std::uint32_t> programs;
  std::span<const std::uint32_t> source_spikes;
  std::span<const PlasticityRecord> plasticity;  // this and the next two: empty when it does not learn
  std::span<const PlasticSynapseRecord> plastic_synapses;
  std::span<const double> decays;
  std::shared_ptr<const void> storage;

  /// The NUL-terminated name at `offset`; empty for kNoString.
  [[nodiscard]] std::string_view name(std::uint32_t offset) const;
  [[nodiscard]] std::optional<std::uint32_t> find_population(std::string_view name) const;
};

/// Either an image or one line that says why not.
struct LoadedImage {
  std::optional<SpikeImage> image;
  std::string error;
};

/// Takes the bytes over. Checks the checksum and every index.
[[nodiscard]] LoadedImage load_image(std::vector<std::byte> bytes);
/// Maps the file; pages are read once, by the checksum.
[[nodiscard]] LoadedImage load_image_file(const std::string& path);

/// True when the file starts with the image's magic, so that commands can take either kind of file.
[[nodiscard]] bool looks_like_image(std::span<const std::byte> first_bytes);

}  // namespace tectum
