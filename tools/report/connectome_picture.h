// A circuit as a wiring diagram: populations by nucleus and side, from the retina down to the joints.
//
// One panel for each pair of sides (left and right, up and down), mirrored about its midline; populations without a
// side stand on it. Within a panel a nucleus is a band, and rows go by the fewest synapses from an input.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tectum {

/// One side of a population. An input has no model.
struct ConnectomeNode {
  std::string name;  // "EBN.left": what follows the last point is the side, when another has the same two
  std::string nucleus;
  std::string model;
  std::size_t size = 0;  // neurons
  bool is_input = false;
  std::string ink;   // a role of tools/report/theme.h that sets it off, or empty
  std::string note;  // more for the tooltip, lines; may be empty
};

/// What leads from one population side to another, of one sign.
struct ConnectomeEdge {
  std::size_t pre = 0, post = 0;  // nodes
  bool is_inhibitory = false;
  std::size_t synapses = 0;
  std::string name;  // of the projection
  std::string ink;   // sets it off, or empty
  std::string note;
};

/// What the rate of a population does to a joint.
struct ConnectomeOutput {
  std::string joint;
  std::size_t node = 0;
  bool is_negative = false;
};

struct Connectome {
  std::string name;
  std::vector<ConnectomeNode> nodes;
  std::vector<ConnectomeEdge> edges;
  std::vector<ConnectomeOutput> outputs;
};

/// A whole SVG file, light. `width_px` >= 320 decides how many populations stand side by side; the height follows.
[[nodiscard]] std::string connectome_svg(const Connectome&, double width_px = 1000);

/// Two <svg> elements of which a page with chart_css() and page rules shows the one that suits its width.
[[nodiscard]] std::string responsive_connectome(const Connectome&);

}  // namespace tectum
