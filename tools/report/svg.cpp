#include "tools/report/svg.h"

#include <fmt/format.h>

#include <cmath>

#include "tools/report/theme.h"

namespace tectum {
namespace {

constexpr double kMeanGlyphWidth = 0.56;  // of the font size, measured on DejaVu Sans and Segoe UI labels

bool is_continuation_byte(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

std::string opacity_attribute(double opacity) {
  return opacity < 1 ? fmt::format(" opacity=\"{}\"", coordinate(opacity)) : std::string();
}

}  // namespace

std::string xml_escape(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') {
          escaped += c;
        }
    }
  }
  return escaped;
}

std::string coordinate(double value) {
  if (!std::isfinite(value)) {
    return "0";
  }
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') {
    text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string number_text(double value, int decimals) {
  if (!std::isfinite(value)) {
    return "–";
  }
  std::string text = fmt::format("{:.{}f}", std::abs(value), decimals);
  const bool is_zero = text.find_first_not_of("0.") == std::string::npos;
  return value < 0 && !is_zero ? "−" + text : text;
}

std::string count_text(std::size_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (std::size_t k = 0; k < digits.size(); ++k) {
    if (k > 0 && (digits.size() - k) % 3 == 0) {
      text += "\u2009";
    }
    text += digits[k];
  }
  return text;
}

double text_width_px(std::string_view text, double font_px) {
  double glyphs = 0;
  for (const char c : text) {
    glyphs += is_continuation_byte(c) ? 0 : 1;
  }
  return glyphs * kMeanGlyphWidth * font_px;
}

std::string fit_text(std::string_view text, double width_px, double font_px) {
  if (text_width_px(text, font_px) <= width_px) {
    return std::string(text);
  }
  while (!text.empty() && text_width_px(text, font_px) + font_px > width_px) {
    do {
      const bool is_start = !is_continuation_byte(text.back());
      text.remove_suffix(1);
      if (is_start) {
        break;
      }
    } while (!text.empty());
  }
  return std::string(text) + "…";
}

void SvgBody::line(double x0, double y0, double x1, double y1, std::string_view css) {
  elements_ += fmt::format("<path class=\"{}\" d=\"M{} {}L{} {}\"/>", css, coordinate(x0), coordinate(y0),
                           coordinate(x1), coordinate(y1));
}

void SvgBody::rect(const Box& box, std::string_view css, double opacity) {
  elements_ +=
      fmt::format("<rect class=\"{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>", css, coordinate(box.x),
                  coordinate(box.y), coordinate(box.width), coordinate(box.height), opacity_attribute(opacity));
}

void SvgBody::text(double x, double y, std::string_view content, std::string_view css) {
  elements_ += fmt::format("<text class=\"{}\" x=\"{}\" y=\"{}\">{}</text>", css, coordinate(x), coordinate(y),
                           xml_escape(content));
}

void SvgBody::path(std::string_view commands, std::string_view css, std::string_view attributes) {
  if (!commands.empty()) {
    elements_ +=
        fmt::format("<path class=\"{}\" d=\"{}\"{}{}/>", css, commands, attributes.empty() ? "" : " ", attributes);
  }
}

void SvgBody::circle(double x, double y, double radius, std::string_view css, double opacity) {
  elements_ += fmt::format("<circle class=\"{}\" cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>", css, coordinate(x), coordinate(y),
                           coordinate(radius), opacity_attribute(opacity));
}

void SvgBody::begin_clip(const Box& box) {
  // A nested viewport clips without an id, which two pictures on one page could share by accident.
  elements_ += fmt::format("<svg x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" viewBox=\"{0} {1} {2} {3}\">",
                           coordinate(box.x), coordinate(box.y), coordinate(box.width), coordinate(box.height));
}

void SvgBody::end_clip() { elements_ += "</svg>"; }

std::string inline_svg(const SvgBody& body, double width, double height, std::string_view css,
                       std::string_view description) {
  return fmt::format("<svg class=\"{}\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg>", css,
                     coordinate(width), coordinate(height), xml_escape(description), body.elements());
}

std::string standalone_svg(const SvgBody& body, double width, double height, std::string_view description) {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
      "aria-label=\"{2}\">\n<style>\n{3}</style>\n<rect class=\"f-bg\" width=\"{0}\" height=\"{1}\"/>\n{4}\n</svg>\n",
      coordinate(width), coordinate(height), xml_escape(description), standalone_chart_css(), body.elements());
}

}  // namespace tectum
