#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/report/well_formed.h"
#include "tools/report/connectome_layout.h"
#include "tools/report/connectome_picture.h"

using namespace tectum;

namespace {

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

/// Two axes, nuclei, a population on the midline, one that sends to another panel, loops, joints.
Connectome small_brain() {
  Connectome c;
  c.name = "small brain";
  const auto add = [&](const std::string& name, const std::string& nucleus, bool is_input = false) {
    c.nodes.push_back({name, nucleus, "lif_exp", 40, is_input, "", ""});
    return c.nodes.size() - 1;
  };
  const auto link = [&](std::size_t pre, std::size_t post, bool is_inhibitory = false) {
    c.edges.push_back({pre, post, is_inhibitory, 1600, "p" + std::to_string(c.edges.size()), "", ""});
  };
  const std::size_t retina = add("SC", "superior colliculus", true);
  const std::size_t opn = add("OPN", "raphe");
  std::map<std::string, std::vector<std::size_t>> sides;
  for (const std::string base : {"LLBN", "EBN", "IBN", "IFN", "TN", "MN"}) {
    for (const std::string side : {"left", "right"}) {
      sides[base].push_back(add(base + "." + side, base == "MN" ? "abducens" : base == "TN" ? "" : "PPRF"));
    }
  }
  const std::size_t up = add("EBN_v.up", "riMLF");
  const std::size_t down = add("EBN_v.down", "riMLF");
  link(up, add("MN_v.up", "oculomotor"));
  link(down, add("MN_v.down", "oculomotor"));
  for (std::size_t s = 0; s < 2; ++s) {
    link(retina, sides["LLBN"][s]);
    link(sides["LLBN"][s], sides["EBN"][s]);
    link(sides["EBN"][s], sides["IFN"][s]);
    link(sides["IFN"][s], sides["LLBN"][s], true);
    link(sides["EBN"][s], sides["IBN"][s]);
    link(sides["IBN"][s], sides["EBN"][1 - s], true);
    link(sides["EBN"][s], sides["TN"][s]);
    link(sides["TN"][s], sides["TN"][s]);
    link(sides["TN"][s], sides["MN"][s]);
    link(opn, sides["EBN"][s], true);
    link(sides["IBN"][s], up, true);
    c.outputs.push_back({"left_eye_pan", sides["MN"][s], s == 0});
  }
  link(retina, up);
  link(retina, down);
  link(opn, up, true);
  link(opn, down, true);
  c.outputs.push_back({"left_eye_tilt", up, false});
  return c;
}

bool overlap(const Box& a, const Box& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

const PlacedNode* find(const Panel& panel, const Connectome& c, const std::string& name) {
  const auto at = std::find_if(panel.nodes.begin(), panel.nodes.end(),
                               [&](const PlacedNode& node) { return c.nodes[node.node].name == name; });
  return at == panel.nodes.end() ? nullptr : &*at;
}

}  // namespace

TEST_CASE("a wiring diagram has a panel for each pair of sides, mirrored, and boxes that do not overlap") {
  const Connectome c = small_brain();
  for (const double width : {320.0, 400.0, 700.0, 1000.0, 2400.0}) {
    CAPTURE(width);
    const ConnectomeLayout layout = lay_out_connectome(c, width);
    REQUIRE(layout.panels.size() == 2);
    CHECK(layout.panels[0].first_side == "left");
    CHECK(layout.panels[1].second_side == "down");
    std::set<std::size_t> placed;
    for (const Panel& panel : layout.panels) {
      std::vector<Box> boxes;
      for (const PlacedNode& node : panel.nodes) {
        placed.insert(node.nodes.begin(), node.nodes.end());
        boxes.push_back(node.box);
      }
      for (const PlacedJoint& joint : panel.joints) {
        boxes.push_back(joint.box);
      }
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        CHECK(boxes[i].x >= 0);
        CHECK(boxes[i].x + boxes[i].width <= width);
        CHECK(boxes[i].y + boxes[i].height <= layout.height);
        for (std::size_t j = 0; j < i; ++j) {
          CHECK_FALSE(overlap(boxes[i], boxes[j]));
        }
      }
    }
    CHECK(placed.size() == c.nodes.size());
    const Panel& horizontal = layout.panels[0];
    for (const std::string base : {"LLBN", "EBN", "IBN", "IFN", "TN", "MN"}) {
      const PlacedNode* left = find(horizontal, c, base + ".left");
      const PlacedNode* right = find(horizontal, c, base + ".right");
      REQUIRE(left != nullptr);
      REQUIRE(right != nullptr);
      CHECK(left->box.y == right->box.y);
      CHECK(left->box.x + right->box.x + left->box.width == doctest::Approx(width));
      CHECK(left->label == base);
    }
  }
}

TEST_CASE("a diagram reads from the retina down to the joints") {
  const Connectome c = small_brain();
  const Panel panel = lay_out_connectome(c, 1000).panels[0];
  const auto y = [&](const char* name) { return find(panel, c, name)->box.y; };
  CHECK(y("SC") < y("LLBN.left"));
  CHECK(y("LLBN.left") < y("MN.left"));
  CHECK(y("EBN.left") < y("TN.left"));
  CHECK(y("MN.left") < panel.joints.at(0).box.y);
}

TEST_CASE("what another panel sends stands there as one guest for both its sides") {
  const Connectome c = small_brain();
  const Panel panel = lay_out_connectome(c, 1000).panels[1];
  const PlacedNode* guest = find(panel, c, "IBN.left");
  REQUIRE(guest != nullptr);
  CHECK(guest->is_guest);
  CHECK(guest->nodes.size() == 2);
  CHECK(guest->label == "IBN");
}

TEST_CASE("the picture has every pathway with its tooltip, in both widths, and is well-formed") {
  Connectome c = small_brain();
  c.nodes[1].note = "a < b & c";
  const std::string svg = connectome_svg(c);
  CHECK(first_markup_error(svg) == "");
  for (const ConnectomeEdge& edge : c.edges) {
    CHECK(svg.find("<title>" + edge.name + ": ") != std::string::npos);
  }
  CHECK(svg.find("lowers left_eye_pan") != std::string::npos);
  CHECK(svg.find("a &lt; b &amp; c") != std::string::npos);
  const std::string both = responsive_connectome(c);
  CHECK(occurrences(both, "<svg") == 2);
  CHECK(occurrences(both, "<title>p0: ") == 2);
}

TEST_CASE("what is set off is drawn in its ink, and the rest steps back") {
  Connectome c = small_brain();
  const std::string plain = connectome_svg(c);
  CHECK(plain.find("s-c3\"") == std::string::npos);
  c.edges[2].ink = "c3";
  const std::string svg = connectome_svg(c);
  CHECK(occurrences(svg, "opacity=\"0.22\"") > 10);
  // Once among the curves, and once faintly over the boxes, some of which it may pass behind.
  CHECK(occurrences(svg, "ln s-c3") == 2);
  const std::size_t over_boxes = svg.find("pointer-events=\"none\"");
  CHECK(svg.find("ln s-c3") < over_boxes);
  CHECK(svg.rfind("ln s-c3") > over_boxes);
  CHECK(plain.find("pointer-events") == std::string::npos);
}

TEST_CASE("two populations of a module are not taken for two sides") {
  Connectome c;
  for (const char* name :
       {"gate.open", "gate.shut", "s1.veto.left", "s1.veto.right", "s2.veto.left", "s2.veto.right"}) {
    c.nodes.push_back({name, "", "threshold", 1, false, "", ""});
  }
  c.edges = {{0, 2, false, 1, "a", "", ""}, {1, 3, false, 1, "b", "", ""}};
  const ConnectomeLayout layout = lay_out_connectome(c, 1000);
  REQUIRE(layout.panels.size() == 1);
  CHECK(layout.panels[0].first_side == "left");
  CHECK(find(layout.panels[0], c, "gate.open")->label == "gate.open");
  CHECK(find(layout.panels[0], c, "s1.veto.left")->label == "s1.veto");
}

TEST_CASE("circuits without sides, inputs, nuclei or neurons are drawn as well") {
  Connectome c;
  CHECK(first_markup_error(connectome_svg(c)) == "");
  c.nodes = {{"a", "", "lif_exp", 3, false, "", ""}, {"b", "", "lif_exp", 4, false, "", ""}};
  c.edges = {{0, 1, false, 12, "ab", "", ""}, {1, 0, true, 12, "ba", "", ""}, {1, 1, true, 9, "bb", "", ""}};
  CHECK(lay_out_connectome(c, 1000).panels.size() == 1);
  const std::string svg = connectome_svg(c);
  CHECK(first_markup_error(svg) == "");
  CHECK(occurrences(svg, "<title>bb: b") == 1);
}
