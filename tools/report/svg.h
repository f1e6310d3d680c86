// SVG elements as text. Charts: tools/report/chart.h.
#pragma once

#include <string>
#include <string_view>

namespace tectum {

/// Replaces & < > " so that text can stand in an element or an attribute; drops control characters, which XML has no
/// way to write.
[[nodiscard]] std::string xml_escape(std::string_view text);

/// At most two decimals, no trailing zeros, "-" sign; for coordinates. Not finite: "0".
[[nodiscard]] std::string coordinate(double value);

/// Fixed decimals with a real minus sign (U+2212), for people. Not finite: an en dash.
[[nodiscard]] std::string number_text(double value, int decimals);

/// 1234567 as "1 234 567" with thin spaces.
[[nodiscard]] std::string count_text(std::size_t value);

/// Width of a text in 12 px type, near enough to lay out legends and margins.
[[nodiscard]] double text_width_px(std::string_view text, double font_px = 12);

/// Cuts a text to a width and ends it in an ellipsis if it had to.
[[nodiscard]] std::string fit_text(std::string_view text, double width_px, double font_px = 12);

/// Where a picture's part goes, in pixels, y down.
struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};

/// Collects elements. Classes are those of tools/report/theme.h.
class SvgBody {
 public:
  void line(double x0, double y0, double x1, double y1, std::string_view css);
  void rect(const Box&, std::string_view css, double opacity = 1);
  void text(double x, double y, std::string_view content, std::string_view css);
  /// `attributes` are written as they are.
  void path(std::string_view commands, std::string_view css, std::string_view attributes = {});
  void circle(double x, double y, double radius, std::string_view css, double opacity = 1);
  /// Everything until end_clip() is cut to the box; coordinates stay those of the picture.
  void begin_clip(const Box&);
  void end_clip();
  void raw(std::string_view elements) { elements_ += elements; }
  [[nodiscard]] const std::string& elements() const { return elements_; }

 private:
  std::string elements_;
};

/// An <svg> element for a page; its classes are styled by the page.
[[nodiscard]] std::string inline_svg(const SvgBody&, double width, double height, std::string_view css,
                                     std::string_view description);

/// A whole file: XML declaration, light background, style sheet.
[[nodiscard]] std::string standalone_svg(const SvgBody&, double width, double height, std::string_view description);

}  // namespace tectum
