#include <cstring>

#include "runtime/image/image_contents.h"
#include "runtime/image/section_table.h"
#include "runtime/record/recording_file.h"

namespace tectum {
namespace {

/// The file that the image was read from: a loaded image keeps its arrays, and the same arrays give the same bytes.
std::vector<std::byte> image_bytes(const SpikeImage& image) {
  ImageContents contents;
  contents.tick_ns = image.header.tick_ns;
  contents.seed = image.header.seed;
  contents.circuit_name = image.header.circuit_name;
  contents.neuron_count = image.header.neuron_count;
  contents.slot_count = image.header.slot_count;
  contents.max_delay_ticks = image.header.max_delay_ticks;
  std::vector<std::span<const std::byte>> sections;
  const auto keep = [&](SectionKind, const auto& section) { sections.push_back(std::as_bytes(section)); };
  for_each_section(image, keep);
  for_each_plastic_section(image, keep);
  std::size_t next = 0;
  const auto fill = [&](SectionKind, auto& section) {
    const std::span<const std::byte> bytes = sections[next++];
    section.resize(bytes.size() / sizeof(section[0]));
    if (!bytes.empty()) {
      std::memcpy(section.data(), bytes.data(), bytes.size());
    }
  };
  for_each_section(contents, fill);
  for_each_plastic_section(contents, fill);
  return write_image(contents);
}

}  // namespace

void describe_guard(const GuardOptions& options, Recording& run) {
  run.guard = {.neutral_deg = options.neutral_deg,
               .approach_speed_deg_s = options.approach_speed_deg_s,
               .ease_speed_deg_s = options.ease_speed_deg_s,
               .hold_after_ns = options.hold_after_ns,
               .ease_after_ns = options.ease_after_ns,
               .servo_lost_after_ns = options.servo_lost_after_ns,
               .max_step_ns = options.max_step_ns};
}

Recording describe_run(const SpikeImage& image) {
  Recording run;
  run.circuit_name = image.name(image.header.circuit_name);
  run.seed = image.header.seed;
  run.image_checksum = image.header.checksum;
  run.tick_ns = image.header.tick_ns;
  run.image = image_bytes(image);
  describe_guard({}, run);
  for (const PopulationRecord& population : image.populations) {
    run.populations.push_back({.name = std::string(image.name(population.name)),
                               .nucleus = std::string(image.name(population.nucleus)),
                               .first_neuron = population.first_neuron,
                               .size = population.size});
  }
  for (const RetinaRecord& retina : image.retinas) {
    const auto fields = image.fields.subspan(retina.first_field, retina.field_count);
    run.retinas.push_back({.name = std::string(image.name(retina.name)),
                           .eye = retina.eye,
                           .field_of_view_deg = retina.field_of_view_deg,
                           .frame_width = retina.frame_width,
                           .frame_height = retina.frame_height,
                           .fields = {fields.begin(), fields.end()}});
  }
  return run;
}

}  // namespace tectum
