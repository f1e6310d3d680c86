#include "tools/diff/picture_tap.h"

#include <algorithm>
#include <string_view>
#include <tuple>

namespace tectum {
namespace {

bool is_same_sheet(const SpikeImage& a, const RetinaRecord& x, const SpikeImage& b, const RetinaRecord& y) {
  const auto head = [](const RetinaRecord& r) {
    return std::tie(r.eye, r.frame_width, r.frame_height, r.field_of_view_deg, r.lit_channel, r.lit_above, r.lit_share);
  };
  const auto left = a.fields.subspan(x.first_field, x.field_count);
  const auto right = b.fields.subspan(y.first_field, y.field_count);
  return head(x) == head(y) && std::equal(left.begin(), left.end(), right.begin(), right.end(),
                                          [](const FieldRecord& f, const FieldRecord& g) {
                                            return std::tie(f.x0, f.y0, f.x1, f.y1) == std::tie(g.x0, g.y0, g.x1, g.y1);
                                          });
}

std::uint32_t retina_of_name(const SpikeImage& image, std::string_view name) {
  for (std::uint32_t r = 0; r < image.retinas.size(); ++r) {
    if (image.name(image.retinas[r].name) == name) {
      return r;
    }
  }
  return kNoRetina;
}

/// Fields of retina r that are lit in a frame: RecordedFrame counts the fields of all retinas of an eye on end.
std::vector<std::uint32_t> lit_fields(const SpikeImage& image, std::uint32_t r, const RecordedFrame& frame) {
  const RetinaRecord& retina = image.retinas[r];
  std::uint32_t first = 0;
  for (std::uint32_t other = 0; other < r; ++other) {
    first += image.retinas[other].eye == retina.eye ? image.retinas[other].field_count : 0;
  }
  std::vector<std::uint32_t> lit;
  for (const std::uint32_t field : frame.active_fields[static_cast<std::size_t>(retina.eye)]) {
    if (field >= first && field - first < retina.field_count) {
      lit.push_back(field - first);
    }
  }
  return lit;
}

}  // namespace

std::vector<std::uint32_t> same_retinas(const SpikeImage& a, const SpikeImage& b) {
  std::vector<std::uint32_t> twin(b.retinas.size(), kNoRetina);
  for (std::uint32_t r = 0; r < b.retinas.size(); ++r) {
    const std::uint32_t named = retina_of_name(a, b.name(b.retinas[r].name));
    if (named != kNoRetina && is_same_sheet(a, a.retinas[named], b, b.retinas[r])) {
      twin[r] = named;
    }
  }
  return twin;
}

PictureTap::PictureTap(const SpikeImage& a, const SpikeImage& b)
    : a_(a), b_(b), twin_(same_retinas(a, b)), is_prepared_(b.retinas.size(), false), seen_(b.retinas.size()) {
  for (std::uint32_t r = 0; r < b.retinas.size(); ++r) {
    retinas_.emplace_back(b, r);
  }
}

bool PictureTap::needs_pictures() const { return std::find(twin_.begin(), twin_.end(), kNoRetina) != twin_.end(); }

void PictureTap::see(std::size_t frame, const Frame& left, const Frame& right) {
  for (std::uint32_t r = 0; r < retinas_.size(); ++r) {
    const Frame& picture = b_.retinas[r].eye == Eye::Left ? left : right;
    if (twin_[r] != kNoRetina) {
      continue;
    }
    if (!is_prepared_[r]) {
      is_prepared_[r] = retinas_[r].prepare(picture.width_px, picture.height_px);
    }
    seen_[r].resize(frame + 1);
    if (is_prepared_[r] && retinas_[r].encode(picture)) {
      const auto active = retinas_[r].active();
      seen_[r][frame].assign(active.begin(), active.end());
    }
  }
}

LitNeurons PictureTap::lit_neurons(const Recording& recording_a) const {
  LitNeurons lit(recording_a.frames.size());
  for (std::uint32_t r = 0; r < b_.retinas.size(); ++r) {
    const RetinaRecord& retina = b_.retinas[r];
    const bool has_pictures = !seen_[r].empty();
    const std::uint32_t named = twin_[r] != kNoRetina ? twin_[r] : retina_of_name(a_, b_.name(retina.name));
    for (std::size_t k = 0; k < lit.size(); ++k) {
      std::vector<std::uint32_t> fields;
      if (has_pictures) {
        fields = k < seen_[r].size() ? seen_[r][k] : std::vector<std::uint32_t>{};
      } else if (named != kNoRetina) {
        fields = lit_fields(a_, named, recording_a.frames[k]);
      }
      for (const std::uint32_t field : fields) {
        if (field < retina.field_count) {
          lit[k].push_back(retina.first_neuron + field);
        }
      }
    }
  }
  for (std::vector<std::uint32_t>& neurons : lit) {
    std::sort(neurons.begin(), neurons.end());
  }
  return lit;
}

std::vector<std::uint32_t> lit_in(const SpikeImage& a, const RecordedFrame& frame) {
  std::vector<std::uint32_t> neurons;
  for (std::uint32_t r = 0; r < a.retinas.size(); ++r) {
    for (const std::uint32_t field : lit_fields(a, r, frame)) {
      neurons.push_back(a.retinas[r].first_neuron + field);
    }
  }
  std::sort(neurons.begin(), neurons.end());
  return neurons;
}

std::array<std::vector<std::uint32_t>, kEyeCount> fields_of(const SpikeImage& image,
                                                            const std::vector<std::uint32_t>& lit) {
  std::array<std::vector<std::uint32_t>, kEyeCount> fields;
  std::array<std::uint32_t, kEyeCount> first{};
  for (const RetinaRecord& retina : image.retinas) {
    const auto e = static_cast<std::size_t>(retina.eye);
    for (const std::uint32_t neuron : lit) {
      if (neuron >= retina.first_neuron && neuron - retina.first_neuron < retina.field_count) {
        fields[e].push_back(first[e] + neuron - retina.first_neuron);
      }
    }
    first[e] += retina.field_count;
  }
  return fields;
}

}  // namespace tectum
