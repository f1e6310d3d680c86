// RetinaSheet inputs: eye, frame, what is lit, and the tiling of receptive fields.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "compiler/validate/retina_geometry.h"
#include "compiler/validate/validation.h"

namespace tectum {
namespace {

constexpr std::uint64_t kMaxFrameEdge = 8192;
constexpr std::uint64_t kMaxFieldsPerSide = 512;
constexpr double kPixelTolerance = 1e-6;

struct ChannelSpelling {
  const char* text;  // without blanks
  LitChannel channel;
};
constexpr ChannelSpelling kChannels[] = {
    {"red", LitChannel::Red},
    {"green", LitChannel::Green},
    {"blue", LitChannel::Blue},
    {"luma", LitChannel::Luma},
    {"max(red,green,blue)", LitChannel::Brightest},
    {"brightest", LitChannel::Brightest},
    {"red-max(green,blue)", LitChannel::RedOverGreenBlue},
    {"red-max(blue,green)", LitChannel::RedOverGreenBlue},
    {"green-max(red,blue)", LitChannel::GreenOverRedBlue},
    {"green-max(blue,red)", LitChannel::GreenOverRedBlue},
    {"blue-max(red,green)", LitChannel::BlueOverRedGreen},
    {"blue-max(green,red)", LitChannel::BlueOverRedGreen},
};

std::string without_blanks(std::string_view text) {
  std::string result;
  std::copy_if(text.begin(), text.end(), std::back_inserter(result),
               [](unsigned char c) { return std::isspace(c) == 0; });
  return result;
}

void validate_channel(Validation& v, const NameDecl& decl, RetinaSheet& retina) {
  const std::string text = without_blanks(decl.text);
  for (const ChannelSpelling& spelling : kChannels) {
    if (text == spelling.text) {
      retina.lit_channel = spelling.channel;
      return;
    }
  }
  v.diagnostics()
      .add(Code::UnknownWord, decl.span, {"channel", decl.text})
      .help("one of red, green, blue, luma, brightest, or one colour over the others: green - max(red, blue)");
}

/// "any", or "lit >= 5 %".
void validate_fires_when(Validation& v, const NameDecl& decl, RetinaSheet& retina) {
  const std::string text = without_blanks(decl.text);
  if (text == "any") {
    return;
  }
  const std::string prefix = "lit>=";
  if (text.compare(0, prefix.size(), prefix) != 0) {
    v.diagnostics()
        .add(Code::UnknownWord, decl.span, {"condition", decl.text})
        .help("write \"any\" or a share of the field's pixels: \"lit >= 5 %\"");
    return;
  }
  const std::size_t offset = decl.text.find(">=") + 2;
  ValueDecl share;
  share.text = decl.text.substr(offset);
  share.span = {decl.span.file, decl.span.begin + static_cast<std::uint32_t>(offset), decl.span.end};
  share.has_exact_offsets = true;
  if (const auto value = v.scope.constant(share, "lit", kNumber)) {
    if (!(*value > 0 && *value <= 1)) {
      v.diagnostics().add(Code::OutOfRange, share.span, {"lit", shown(*value, kNumber), "0 % to 100 %"});
    }
    retina.lit_share = *value;
  }
}

std::optional<double> pixels(Validation& v, const ValueDecl& value, std::string_view key) {
  const auto quantity = v.scope.quantity(value);
  if (!quantity) {
    return std::nullopt;
  }
  if (!quantity->dimension.is_number() && quantity->dimension != kPixels) {
    v.scope.report_dimension(value, key, kPixels, quantity->dimension);
    return std::nullopt;
  }
  if (!(quantity->value > 0)) {
    v.diagnostics().add(Code::OutOfRange, value.span, {std::string(key), shown(quantity->value, kNumber), "above 0"});
    return std::nullopt;
  }
  return quantity->value;
}

struct Tiler {
  Validation& v;
  RetinaSheet& retina;
  double centre_x;
  double centre_y;

  void ring(const RingDecl& decl, double outer_px, double inner_px, Span next_span) {
    if (!decl.block.empty()) {
      const auto columns = v.scope.whole(decl.block[0], "block", 1, kMaxFieldsPerSide);
      const auto rows = v.scope.whole(decl.block[1], "block", 1, kMaxFieldsPerSide);
      if (inner_px > 0) {
        v.diagnostics()
            .add(Code::RingsDoNotMeet, next_span, {"0", fmt::format("{}", inner_px)})
            .label(decl.span, "this block fills the middle");
      } else if (columns && rows) {
        tile_block(centre_x, centre_y, outer_px, static_cast<std::uint32_t>(*columns),
                   static_cast<std::uint32_t>(*rows), retina.fields);
      }
      return;
    }
    if (!decl.fields_per_side) {
      return;
    }
    const auto count = v.scope.whole(*decl.fields_per_side, "fields_per_side", 1, kMaxFieldsPerSide);
    if (!count) {
      return;
    }
    // The hole must fall on the edges of fields: a whole number of them from the outer edge.
    const double field_px = 2 * outer_px / static_cast<double>(*count);
    const double layers = (outer_px - inner_px) / field_px;
    const double nearest = std::max(1.0, std::round(layers));
    if (inner_px > 0 && std::abs(layers - nearest) * field_px > kPixelTolerance) {
      v.diagnostics()
          .add(Code::RingsDoNotMeet, next_span,
               {fmt::format("{:g}", std::max(0.0, outer_px - nearest * field_px)), fmt::format("{:g}", inner_px)})
          .label(decl.span, fmt::format("its fields are {:g} px wide", field_px))
          .help("let a ring end where the next begins: outer * (1 - 2 * layers / fields_per_side)");
      return;
    }
    tile_ring(centre_x, centre_y, outer_px, inner_px, static_cast<std::uint32_t>(*count), retina.fields);
  }

  void rings(const std::vector<RingDecl>& decls) {
    std::vector<std::optional<double>> outer;
    for (const RingDecl& decl : decls) {
      outer.push_back(pixels(v, decl.outer, "outer"));
    }
    const double half_frame = std::min(retina.frame_width, retina.frame_height) / 2.0;
    for (std::size_t i = 0; i < decls.size(); ++i) {
      const std::optional<double> inner = i + 1 < decls.size() ? outer[i + 1] : std::optional<double>(0.0);
      if (!outer[i] || !inner) {
        continue;
      }
      const bool is_out_of_order = i > 0 && outer[i - 1] && *outer[i] >= *outer[i - 1];
      if (is_out_of_order) {
        continue;  // reported with the ring before
      }
      if (*outer[i] > half_frame) {
        v.diagnostics().add(
            Code::OutOfRange, decls[i].outer.span,
            {"outer", fmt::format("{:g} px", *outer[i]), fmt::format("at most the frame's {:g} px", half_frame)});
      } else if (*inner >= *outer[i]) {
        v.diagnostics()
            .add(Code::RangeReversed, decls[i + 1].outer.span,
                 {"the list of rings", fmt::format("{:g} px", *outer[i]), fmt::format("{:g} px", *inner)})
            .help("list the rings from the outside in");
      } else {
        ring(decls[i], *outer[i], *inner, i + 1 < decls.size() ? decls[i + 1].outer.span : decls[i].outer.span);
      }
    }
  }

  void foveated(const FoveatedDecl& decl) {
    const auto outer = pixels(v, decl.outer, "outer");
    const auto inner = pixels(v, decl.inner, "inner");
    const auto count = v.scope.whole(decl.fields_per_side, "fields_per_side", 3, kMaxFieldsPerSide);
    const auto fovea = pixels(v, decl.fovea_px, "fovea_px");
    if (!outer || !inner || !count || !fovea) {
      return;
    }
    const double half_frame = std::min(retina.frame_width, retina.frame_height) / 2.0;
    if (*outer > half_frame) {
      v.diagnostics().add(
          Code::OutOfRange, decl.outer.span,
          {"outer", fmt::format("{:g} px", *outer), fmt::format("at most the frame's {:g} px", half_frame)});
      return;
    }
    if (*inner >= *outer) {
      v.diagnostics().add(Code::RangeReversed, decl.inner.span,
                          {"`foveated`", fmt::format("{:g} px", *outer), fmt::format("{:g} px", *inner)});
      return;
    }
    const double per_side = 2 * *inner / *fovea;
    if (per_side > static_cast<double>(kMaxFieldsPerSide)) {
      v.diagnostics().add(
          Code::OutOfRange, decl.fovea_px.span,
          {"fovea_px", fmt::format("{:g} px", *fovea), fmt::format("at most {} fields a side", kMaxFieldsPerSide)});
      return;
    }
    // The natural ring is as thick as its fields are wide, which shrinks the square by 1 - 2/n; the whole number
    // of rings nearest to that is then stretched to meet the inner square.
    const double natural = std::log(1.0 - 2.0 / static_cast<double>(*count));
    const double ring_count = std::max(1.0, std::round(std::log(*inner / *outer) / natural));
    for (double k = 0; k < ring_count; k += 1) {
      const auto half_width = [&](double i) { return *outer * std::pow(*inner / *outer, i / ring_count); };
      tile_strip(centre_x, centre_y, half_width(k), k + 1 < ring_count ? half_width(k + 1) : *inner,
                 static_cast<std::uint32_t>(*count), retina.fields);
    }
    const auto block = static_cast<std::uint32_t>(std::max(1.0, std::round(per_side)));
    tile_block(centre_x, centre_y, *inner, block, block, retina.fields);
  }
};

void validate_retina(Validation& v, const RetinaDecl& decl, RetinaSheet& retina) {
  retina.name = decl.name.text;
  if (decl.eye.text == "left" || decl.eye.text == "right") {
    retina.eye = decl.eye.text == "left" ? Eye::Left : Eye::Right;
  } else if (!decl.eye.is_poisoned) {
    v.diagnostics().add(Code::UnknownWord, decl.eye.span, {"eye", decl.eye.text}).help("an eye is `left` or `right`");
  }
  if (decl.frame.size() == 2) {
    retina.frame_width =
        static_cast<std::uint32_t>(v.scope.whole(decl.frame[0], "frame", 1, kMaxFrameEdge).value_or(0));
    retina.frame_height =
        static_cast<std::uint32_t>(v.scope.whole(decl.frame[1], "frame", 1, kMaxFrameEdge).value_or(0));
  }
  if (const auto angle = v.scope.constant(decl.field_of_view, "field_of_view", kAngle)) {
    retina.field_of_view_deg = *angle;
    if (!(*angle > 0 && *angle < 179)) {
      v.diagnostics().add(Code::OutOfRange, decl.field_of_view.span,
                          {"field_of_view", shown(*angle, kAngle), "0 deg to 179 deg"});
    }
  }
  if (decl.lit_channel && !decl.lit_channel->is_poisoned) {
    validate_channel(v, *decl.lit_channel, retina);
  }
  if (decl.lit_above) {
    retina.lit_above = static_cast<std::uint32_t>(v.scope.whole(*decl.lit_above, "above", 0, 255).value_or(0));
  }
  if (decl.fires_when && !decl.fires_when->is_poisoned) {
    validate_fires_when(v, *decl.fires_when, retina);
  }
  if (retina.frame_width == 0 || retina.frame_height == 0) {
    return;
  }
  Tiler tiler{v, retina, retina.frame_width / 2.0, retina.frame_height / 2.0};
  if (decl.foveated) {
    tiler.foveated(*decl.foveated);
  } else {
    tiler.rings(decl.rings);
  }
}

}  // namespace

void validate_retinas(Validation& v) {
  for (const RetinaDecl& decl : v.decl.retinas) {
    v.retina_of.emplace(decl.name.text, static_cast<std::uint32_t>(v.circuit.retinas.size()));
    const std::size_t trouble_before = v.scope.trouble_count();
    validate_retina(v, decl, v.circuit.retinas.emplace_back());
    v.is_sound_retina.push_back(!decl.is_poisoned && v.scope.trouble_count() == trouble_before);
  }
}

}  // namespace tectum
