// Where the parts of a wiring diagram go. The picture: tools/report/connectome_picture.h.
#pragma once

#include <string>
#include <vector>

#include "tools/report/connectome_picture.h"
#include "tools/report/svg.h"

namespace tectum {

/// A population side in a panel; a guest stands for all sides of its population.
struct PlacedNode {
  std::size_t node = 0;  // a guest's first
  std::vector<std::size_t> nodes;
  std::string label;  // without the side where the panel's halves say it
  Box box;
  bool is_guest = false;  // of another panel, drawn for what it sends here
};

/// A nucleus: a band across the panel. A nucleus without a name has no frame.
struct PlacedBand {
  std::string nucleus;
  Box box;
};

struct PlacedJoint {
  std::string joint;
  Box box;
};

struct Panel {
  std::string first_side, second_side;  // left half and right half; empty: nothing in it has a side
  std::vector<PlacedNode> nodes;
  std::vector<PlacedBand> bands;
  std::vector<PlacedJoint> joints;
  double top = 0, bottom = 0;
};

struct ConnectomeLayout {
  std::vector<Panel> panels;
  double width = 0, height = 0;
};

[[nodiscard]] ConnectomeLayout lay_out_connectome(const Connectome&, double width_px);

}  // namespace tectum
