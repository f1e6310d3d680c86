// The sections of an image, listed once: what write_image lays out and load_image maps.
#pragma once

#include <cstdint>

#include "runtime/image/spike_image.h"

namespace tectum {

/// Calls visit(SectionKind, member) for each array of `arrays`, an ImageContents or a SpikeImage,
/// in the order of the file.
template <typename Arrays, typename Visit>
void for_each_section(Arrays& arrays, Visit&& visit) {
  visit(SectionKind::Strings, arrays.strings);
  visit(SectionKind::Populations, arrays.populations);
  visit(SectionKind::Groups, arrays.groups);
  visit(SectionKind::Receptors, arrays.receptors);
  visit(SectionKind::Parameters, arrays.parameters);
  visit(SectionKind::Columns, arrays.columns);
  visit(SectionKind::Tables, arrays.tables);
  visit(SectionKind::RowBegin, arrays.row_begin);
  visit(SectionKind::Segments, arrays.segments);
  visit(SectionKind::Targets, arrays.targets);
  visit(SectionKind::Weights, arrays.weights);
  visit(SectionKind::Projections, arrays.projections);
  visit(SectionKind::Retinas, arrays.retinas);
  visit(SectionKind::Fields, arrays.fields);
  visit(SectionKind::Outputs, arrays.outputs);
  visit(SectionKind::OutputTerms, arrays.output_terms);
  visit(SectionKind::Joints, arrays.joints);
  visit(SectionKind::Programs, arrays.programs);
  visit(SectionKind::SourceSpikes, arrays.source_spikes);
}

inline constexpr std::uint32_t kSectionKindCount = 19;

/// The sections that only an image that learns has, after the others.
template <typename Arrays, typename Visit>
void for_each_plastic_section(Arrays& arrays, Visit&& visit) {
  visit(SectionKind::Plasticity, arrays.plasticity);
  visit(SectionKind::PlasticSynapses, arrays.plastic_synapses);
  visit(SectionKind::Decays, arrays.decays);
}

inline constexpr std::uint32_t kPlasticSectionKindCount = 3;

/// Sections of an image, by whether it learns.
[[nodiscard]] constexpr std::uint32_t section_count(bool learns) {
  return kSectionKindCount + (learns ? kPlasticSectionKindCount : 0);
}

}  // namespace tectum
