#include "tools/report/connectome_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "tools/report/chart.h"
#include "tools/report/connectome_layout.h"
#include "tools/report/svg.h"

namespace tectum {
namespace {

constexpr double kTipPx = 6;
constexpr const char* kExcitatoryInk = "c0";
constexpr const char* kInhibitoryInk = "c1";

/// A box's side where curves begin and end.
enum class Edge { Top, Bottom, Outer };

struct Port {
  std::size_t box = 0;
  Edge edge = Edge::Top;
  double x = 0, y = 0;
};

/// A curve from a box to another, of a projection or to a joint.
struct Link {
  std::size_t pre_box = 0, post_box = 0;
  Port from, to;
  bool is_inhibitory = false;
  double width_px = 1;
  std::string ink;   // empty: that of its sign
  std::string note;  // tooltip
};

std::string sentence(const ConnectomeEdge& edge, const Connectome& c) {
  std::string text = fmt::format("{}: {} \u2192 {}\n{}, {} {}", edge.name, c.nodes[edge.pre].name,
                                 c.nodes[edge.post].name, edge.is_inhibitory ? "inhibitory" : "excitatory",
                                 count_text(edge.synapses), edge.synapses == 1 ? "synapse" : "synapses");
  return edge.note.empty() ? text : text + "\n" + edge.note;
}

std::string sentence(const ConnectomeNode& node) {
  std::string text =
      fmt::format("{}: {} {}{}{}", node.name, count_text(node.size), node.size == 1 ? "neuron" : "neurons",
                  node.is_input ? ", retinal input" : ", ", node.is_input ? "" : node.model);
  text += node.nucleus.empty() ? "" : "\n" + node.nucleus;
  return node.note.empty() ? text : text + "\n" + node.note;
}

class PanelPicture {
 public:
  PanelPicture(const Connectome& connectome, const Panel& panel, SvgBody& body)
      : connectome_(connectome), panel_(panel), body_(body) {
    for (const PlacedNode& node : panel.nodes) {
      boxes_.push_back(node.box);
      for (const std::size_t side : node.nodes) {
        box_of_[side] = boxes_.size() - 1;
      }
    }
    for (const PlacedJoint& joint : panel.joints) {
      boxes_.push_back(joint.box);
    }
    const auto is_set_off = [](const auto& part) { return !part.ink.empty(); };
    has_set_off_ = std::any_of(connectome.nodes.begin(), connectome.nodes.end(), is_set_off) ||
                   std::any_of(connectome.edges.begin(), connectome.edges.end(), is_set_off);
  }

  void draw(double width) {
    for (const PlacedBand& band : panel_.bands) {
      if (!band.nucleus.empty()) {
        body_.raw(fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"8\" class=\"f-panel\"/>",
                              coordinate(band.box.x), coordinate(band.box.y), coordinate(band.box.width),
                              coordinate(band.box.height)));
      }
    }
    if (!panel_.first_side.empty()) {
      body_.text(width * 0.25, panel_.top + 20, panel_.first_side, "b mid f-fg");
      body_.text(width * 0.75, panel_.top + 20, panel_.second_side, "b mid f-fg");
    }
    collect_links();
    spread_ports();
    for (const bool is_set_off : {false, true}) {
      for (const Link& link : links_) {
        if (!link.ink.empty() == is_set_off) {
          draw_link(link);
        }
      }
    }
    for (const PlacedBand& band : panel_.bands) {
      if (!band.nucleus.empty()) {
        body_.rect({band.box.x + 7, band.box.y + 5, text_width_px(band.nucleus, 10.5) + 6, 15}, "f-panel", 0.85);
        body_.text(band.box.x + 10, band.box.y + 16, band.nucleus, "small f-muted");
      }
    }
    for (const PlacedNode& node : panel_.nodes) {
      draw_node(node);
    }
    for (const PlacedJoint& joint : panel_.joints) {
      std::string label = joint.joint;
      std::replace(label.begin(), label.end(), '_', ' ');
      draw_box(joint.box, 13, "f-bg s-fg", "", label, "", joint.joint);
    }
    if (has_set_off_) {
      shine_through();
    }
  }

 private:
  void collect_links() {
    for (const ConnectomeEdge& edge : connectome_.edges) {
      const auto pre = box_of_.find(edge.pre);
      const auto post = box_of_.find(edge.post);
      if (pre == box_of_.end() || post == box_of_.end() || panel_.nodes[post->second].is_guest) {
        continue;
      }
      const double width = 0.7 + 0.42 * std::log10(static_cast<double>(std::max<std::size_t>(edge.synapses, 1)));
      add_link({pre->second, post->second, {}, {}, edge.is_inhibitory, width, edge.ink, sentence(edge, connectome_)});
    }
    for (const ConnectomeOutput& output : connectome_.outputs) {
      const auto pre = box_of_.find(output.node);
      for (std::size_t j = 0; j < panel_.joints.size(); ++j) {
        if (pre != box_of_.end() && panel_.joints[j].joint == output.joint) {
          add_link({pre->second,
                    panel_.nodes.size() + j,
                    {},
                    {},
                    output.is_negative,
                    1.2,
                    "",
                    fmt::format("{} {} {}", connectome_.nodes[output.node].name,
                                output.is_negative ? "lowers" : "raises", output.joint)});
        }
      }
    }
  }

  void add_link(Link link) {
    const Box& pre = boxes_[link.pre_box];
    const Box& post = boxes_[link.post_box];
    link.from = {link.pre_box, post.y > pre.y ? Edge::Bottom : Edge::Top, 0, 0};
    link.to = {link.post_box, post.y >= pre.y ? Edge::Top : Edge::Bottom, 0, 0};
    if (link.pre_box == link.post_box) {
      link.from.edge = link.to.edge = Edge::Outer;
    }
    links_.push_back(std::move(link));
  }

  /// Curves share a box's edge evenly, in the order of where they lead, so that they do not cross at the box.
  void spread_ports() {
    std::map<std::pair<std::size_t, Edge>, std::vector<std::pair<double, Port*>>> ports;
    for (Link& link : links_) {
      const auto middle = [&](std::size_t box) { return boxes_[box].x + boxes_[box].width / 2; };
      ports[{link.from.box, link.from.edge}].emplace_back(middle(link.post_box), &link.from);
      ports[{link.to.box, link.to.edge}].emplace_back(middle(link.pre_box), &link.to);
    }
    for (auto& [place, list] : ports) {
      const Box& box = boxes_[place.first];
      std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
      for (std::size_t k = 0; k < list.size(); ++k) {
        const double share = (static_cast<double>(k) + 1) / (static_cast<double>(list.size()) + 1);
        Port& port = *list[k].second;
        if (place.second == Edge::Outer) {
          const bool is_left = box.x + box.width / 2 < width_of_panel() / 2;
          port.x = is_left ? box.x : box.x + box.width;
          port.y = box.y + box.height * share;
        } else {
          port.x = box.x + box.width * share;
          port.y = place.second == Edge::Top ? box.y : box.y + box.height;
        }
      }
    }
  }

  [[nodiscard]] double width_of_panel() const {
    return panel_.bands.empty() ? 0 : 2 * panel_.bands[0].box.x + panel_.bands[0].box.width;
  }

  /// The unit vector from the target's edge outwards.
  [[nodiscard]] std::array<double, 2> away_from_target(const Link& link) const {
    if (link.from.edge == Edge::Outer) {
      return {link.to.x < width_of_panel() / 2 ? -1.0 : 1.0, 0};
    }
    return {0, link.to.edge == Edge::Top ? -1.0 : 1.0};
  }

  void draw_curve(const Link& link) {
    const auto [away_x, away_y] = away_from_target(link);
    std::string curve;
    if (link.from.edge == Edge::Outer) {
      curve = fmt::format("M{} {}C{} {} {} {} {} {}", coordinate(link.from.x), coordinate(link.from.y - 3),
                          coordinate(link.from.x + away_x * 26), coordinate(link.from.y - 14),
                          coordinate(link.to.x + away_x * 26), coordinate(link.to.y + 3),
                          coordinate(link.to.x + away_x * kTipPx), coordinate(link.to.y));
    } else {
      const double out = link.from.edge == Edge::Bottom ? 1 : -1;
      const double dy = std::abs(link.to.y - link.from.y);
      const double dx = std::abs(link.to.x - link.from.x);
      const double bend = dy < 1 ? 14 + 0.07 * dx : std::max(20.0, std::min(0.5 * dy, 90.0));
      curve = fmt::format("M{} {}C{} {} {} {} {} {}", coordinate(link.from.x), coordinate(link.from.y),
                          coordinate(link.from.x), coordinate(link.from.y + out * bend), coordinate(link.to.x),
                          coordinate(link.to.y + away_y * (bend + kTipPx)), coordinate(link.to.x),
                          coordinate(link.to.y + away_y * kTipPx));
    }
    body_.path(curve, "ln s-" + ink_of(link),
               fmt::format("stroke-width=\"{}\"", coordinate(link.ink.empty() ? link.width_px : link.width_px + 1.6)));
  }

  static std::string ink_of(const Link& link) {
    return !link.ink.empty() ? link.ink : link.is_inhibitory ? kInhibitoryInk : kExcitatoryInk;
  }

  /// What is set off can be followed also where it passes behind a box.
  void shine_through() {
    body_.raw("<g opacity=\"0.3\" pointer-events=\"none\">");
    for (const Link& link : links_) {
      if (!link.ink.empty()) {
        draw_curve(link);
      }
    }
    body_.raw("</g>");
  }

  void draw_link(const Link& link) {
    const std::string ink = ink_of(link);
    const double opacity = !link.ink.empty() ? 1 : has_set_off_ ? 0.22 : 0.6;
    const auto [away_x, away_y] = away_from_target(link);
    body_.raw(fmt::format("<g opacity=\"{}\"><title>{}</title>", coordinate(opacity), xml_escape(link.note)));
    draw_curve(link);
    if (link.is_inhibitory) {
      body_.circle(link.to.x + 3 * away_x, link.to.y + 3 * away_y, 3, "f-" + ink);
    } else {
      const double base_x = link.to.x + kTipPx * away_x;
      const double base_y = link.to.y + kTipPx * away_y;
      body_.path(fmt::format("M{} {}L{} {}L{} {}Z", coordinate(link.to.x), coordinate(link.to.y),
                             coordinate(base_x - 3.4 * away_y), coordinate(base_y - 3.4 * away_x),
                             coordinate(base_x + 3.4 * away_y), coordinate(base_y + 3.4 * away_x)),
                 "f-" + ink);
    }
    body_.raw("</g>");
  }

  void draw_node(const PlacedNode& placed) {
    const ConnectomeNode& node = connectome_.nodes[placed.node];
    const bool is_set_off = !node.ink.empty();
    const std::string css = fmt::format("f-bg s-{}{}", is_set_off ? node.ink : "muted", placed.is_guest ? " dash" : "");
    draw_box(placed.box, node.is_input ? 17 : 4, css, is_set_off ? "stroke-width=\"3\"" : "", placed.label,
             count_text(node.size), sentence(node));
  }

  void draw_box(const Box& box, double radius, const std::string& css, const std::string& attributes,
                const std::string& label, const std::string& below, const std::string& note) {
    body_.raw(fmt::format(
        "<g><title>{}</title><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\" class=\"{}\" {}/>",
        xml_escape(note), coordinate(box.x), coordinate(box.y), coordinate(box.width), coordinate(box.height),
        coordinate(radius), css, attributes));
    const double middle = box.x + box.width / 2;
    body_.text(middle, box.y + (below.empty() ? box.height / 2 + 4 : 15), fit_text(label, box.width - 6, 12),
               "mid f-fg");
    if (!below.empty()) {
      body_.text(middle, box.y + 28, below, "small mid f-muted");
    }
    body_.raw("</g>");
  }

  const Connectome& connectome_;
  const Panel& panel_;
  SvgBody& body_;
  std::vector<Box> boxes_;  // of the nodes, then of the joints
  std::map<std::size_t, std::size_t> box_of_;
  std::vector<Link> links_;
  bool has_set_off_ = false;
};

void draw_legend(double width, SvgBody& body) {
  double x = 14;
  const double y = 16;
  const auto entry = [&](const char* ink, bool is_inhibitory, const char* text) {
    body.line(x, y, x + 22, y, std::string("ln s-") + ink);
    if (is_inhibitory) {
      body.circle(x + 24, y, 3, std::string("f-") + ink);
    } else {
      body.path(fmt::format("M{} {}L{} {}L{} {}Z", coordinate(x + 28), y, coordinate(x + 21), y - 3.5,
                            coordinate(x + 21), y + 3.5),
                std::string("f-") + ink);
    }
    body.text(x + 33, y + 4, text, "small f-fg");
    x += 33 + text_width_px(text, 10.5) + 18;
  };
  entry(kExcitatoryInk, false, "excitatory");
  entry(kInhibitoryInk, true, "inhibitory");
  if (width >= 600) {
    body.text(x, y + 4, "in a box: population, neurons; wider line: more synapses (10 times as many: 0.4 px)",
              "small f-muted");
  }
}

struct Drawn {
  SvgBody body;
  double width = 0, height = 0;
};

Drawn draw(const Connectome& connectome, double width_px) {
  const ConnectomeLayout layout = lay_out_connectome(connectome, width_px);
  Drawn drawn;
  drawn.width = layout.width;
  drawn.height = layout.height;
  draw_legend(layout.width, drawn.body);
  for (const Panel& panel : layout.panels) {
    PanelPicture(connectome, panel, drawn.body).draw(layout.width);
  }
  return drawn;
}

std::string description(const Connectome& connectome) {
  return fmt::format("wiring of {}: {} populations, {} pathways", connectome.name, connectome.nodes.size(),
                     connectome.edges.size());
}

}  // namespace

std::string connectome_svg(const Connectome& connectome, double width_px) {
  const Drawn drawn = draw(connectome, width_px);
  return standalone_svg(drawn.body, drawn.width, drawn.height, description(connectome));
}

std::string responsive_connectome(const Connectome& connectome) {
  const Drawn wide = draw(connectome, kWidePx);
  const Drawn narrow = draw(connectome, kNarrowPx);
  return inline_svg(wide.body, wide.width, wide.height, "wide", description(connectome)) +
         inline_svg(narrow.body, narrow.width, narrow.height, "narrow", description(connectome));
}

}  // namespace tectum
