#include <bit>
#include <cmath>

#include "runtime/image/models.h"
#include "runtime/image/verify_parts.h"

namespace tectum {
namespace {

std::string number(std::uint64_t value) { return std::to_string(value); }

bool is_range(std::uint64_t first, std::uint64_t count, std::uint64_t limit) {
  return first <= limit && count <= limit - first;
}

bool drives_field_sources(const SpikeImage& image, std::uint32_t first_neuron, std::uint32_t count) {
  for (const GroupRecord& group : image.groups) {
    if (group.model == ModelKind::FieldSource && first_neuron >= group.first_neuron &&
        is_range(first_neuron - group.first_neuron, count, group.size)) {
      return true;
    }
  }
  return count == 0;
}

std::string verify_retina(const SpikeImage& image, const RetinaRecord& retina) {
  constexpr std::uint32_t kMaxFramePixels = 8192;
  const auto channel = static_cast<std::uint32_t>(retina.lit_channel);
  if (retina.name >= image.strings.size()) {
    return "name outside the strings";
  }
  if (static_cast<std::uint32_t>(retina.eye) >= kEyeCount) {
    return "eye " + number(static_cast<std::uint32_t>(retina.eye));
  }
  if (retina.frame_width == 0 || retina.frame_height == 0 || retina.frame_width > kMaxFramePixels ||
      retina.frame_height > kMaxFramePixels) {
    return "frame of " + number(retina.frame_width) + " x " + number(retina.frame_height);
  }
  if (!(retina.field_of_view_deg > 0 && retina.field_of_view_deg < 180)) {
    return "field of view of " + std::to_string(retina.field_of_view_deg) + " deg";
  }
  if (channel < static_cast<std::uint32_t>(LitChannel::Red) ||
      channel > static_cast<std::uint32_t>(LitChannel::Brightest) || retina.lit_above > 255) {
    return "lit channel " + number(channel) + " above " + number(retina.lit_above);
  }
  if (!(retina.lit_share >= 0 && retina.lit_share <= 1)) {
    return "lit share of " + std::to_string(retina.lit_share);
  }
  if (!is_range(retina.first_field, retina.field_count, image.fields.size()) ||
      !drives_field_sources(image, retina.first_neuron, retina.field_count)) {
    return "fields outside their section or that drive no field source";
  }
  const auto width = static_cast<float>(retina.frame_width);
  const auto height = static_cast<float>(retina.frame_height);
  for (const FieldRecord& field : image.fields.subspan(retina.first_field, retina.field_count)) {
    // Written so that a NaN fails.
    if (!(field.x0 >= 0 && field.x0 < field.x1 && field.x1 <= width && field.y0 >= 0 && field.y0 < field.y1 &&
          field.y1 <= height)) {
      return "a field reaches outside the frame";
    }
  }
  return {};
}

std::string verify_output(const SpikeImage& image, const OutputRecord& output) {
  const auto kind = static_cast<std::uint32_t>(output.kind);
  if (output.name >= image.strings.size()) {
    return "name outside the strings";
  }
  if (output.kind != OutputKind::Position && output.kind != OutputKind::Velocity) {
    return "kind " + number(kind);
  }
  if ((output.joint_mask >> kJointCount) != 0) {
    return "joint mask " + number(output.joint_mask);
  }
  if (output.window_ticks == 0 || output.window_ticks > kMaxDelayTicks) {
    return "window of " + number(output.window_ticks) + " ticks";
  }
  if (!std::isfinite(output.offset_deg)) {
    return "offset is no number";
  }
  if (!is_range(output.first_term, output.term_count, image.output_terms.size())) {
    return "terms outside their section";
  }
  for (const OutputTermRecord& term : image.output_terms.subspan(output.first_term, output.term_count)) {
    if (term.size == 0 || !is_range(term.first_neuron, term.size, image.header.neuron_count) ||
        !std::isfinite(term.gain)) {
      return "a term counts neurons that do not exist or has no gain";
    }
  }
  return {};
}

std::string verify_joints(const SpikeImage& image) {
  std::uint32_t seen = 0;
  for (std::size_t j = 0; j < image.joints.size(); ++j) {
    const JointRecord& record = image.joints[j];
    const auto joint = static_cast<std::uint32_t>(record.joint);
    if (joint >= kJointCount || ((seen >> joint) & 1U) != 0) {
      return "joint record " + number(j) + " names joint " + number(joint) + ", which does not exist or was named";
    }
    seen |= 1U << joint;
    if (!(std::isfinite(record.min_deg) && std::isfinite(record.max_deg) && record.min_deg <= record.max_deg &&
          std::isfinite(record.max_speed_deg_s) && record.max_speed_deg_s >= 0)) {
      return "joint record " + number(j) + " has limits that are none";
    }
  }
  return {};
}

}  // namespace

std::string verify_ports(const SpikeImage& image) {
  for (std::size_t r = 0; r < image.retinas.size(); ++r) {
    const std::string error = verify_retina(image, image.retinas[r]);
    if (!error.empty()) {
      return "retina " + number(r) + ": " + error;
    }
  }
  for (std::size_t o = 0; o < image.outputs.size(); ++o) {
    const std::string error = verify_output(image, image.outputs[o]);
    if (!error.empty()) {
      return "output " + number(o) + ": " + error;
    }
  }
  return verify_joints(image);
}

}  // namespace tectum
