// The image as growable arrays: what compiler/lower fills and write_image() lays out.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/image/plasticity.h"
#include "runtime/image/spike_image.h"

namespace tectum {

struct ImageContents {
  std::uint64_t tick_ns = 0;
  std::uint64_t seed = 0;
  std::uint32_t circuit_name = kNoString;
  std::uint32_t neuron_count = 0;
  std::uint32_t slot_count = 0;
  std::uint32_t max_delay_ticks = 0;

  std::vector<char> strings;
  std::vector<PopulationRecord> populations;
  std::vector<GroupRecord> groups;
  std::vector<ReceptorRecord> receptors;
  std::vector<double> parameters;
  std::vector<double> columns;
  std::vector<float> tables;
  std::vector<std::uint32_t> row_begin;  // N + 1
  std::vector<SegmentRecord> segments;   // S + 1, the last a sentinel
  std::vector<std::uint32_t> targets;
  std::vector<std::int32_t> weights;
  std::vector<ProjectionRecord> projections;
  std::vector<RetinaRecord> retinas;
  std::vector<FieldRecord> fields;
  std::vector<OutputRecord> outputs;
  std::vector<OutputTermRecord> output_terms;
  std::vector<JointRecord> joints;
  std::vector<std::uint32_t> programs;
  std::vector<std::uint32_t> source_spikes;
  // Empty in an image that does not learn.
  std::vector<PlasticityRecord> plasticity;
  std::vector<PlasticSynapseRecord> plastic_synapses;
  std::vector<double> decays;

  /// Appends `text` with its terminating NUL and returns its offset. Does not deduplicate.
  std::uint32_t add_string(std::string_view text);
};

/// Lays the arrays out as a file. The same contents give the same bytes.
[[nodiscard]] std::vector<std::byte> write_image(const ImageContents& contents);

}  // namespace tectum
