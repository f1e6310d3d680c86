#include "tools/report/connectome_layout.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace tectum {
namespace {

constexpr double kMarginPx = 12;
constexpr double kGapPx = 14;  // between boxes of a row
constexpr double kRowPx = 66;
constexpr double kBoxHeightPx = 34;
constexpr double kBandPadPx = 12;
constexpr double kBandTitlePx = 18;
constexpr double kBandGapPx = 16;
constexpr double kPanelTitlePx = 34;
constexpr double kPanelGapPx = 26;
constexpr double kLegendPx = 30;
constexpr std::size_t kFar = std::numeric_limits<std::size_t>::max();

struct SplitName {
  std::string base, side;
};

SplitName split_name(const std::string& name) {
  const std::size_t point = name.rfind('.');
  return point == std::string::npos ? SplitName{name, ""} : SplitName{name.substr(0, point), name.substr(point + 1)};
}

/// A population with all its sides, as far as one panel shows them.
struct Family {
  std::string base;
  std::string nucleus;
  std::vector<std::string> sides;  // in order of appearance; one empty one without sides
  std::vector<std::size_t> nodes;  // one a side
  bool is_pair = false;            // its sides are a panel's
  std::size_t rank = kFar;         // fewest synapses from an input
  std::size_t to_output = kFar;    // fewest synapses to what moves a joint
  /// 0 at the inputs, 1 at the motoneurons.
  [[nodiscard]] double depth() const {
    const auto in = static_cast<double>(rank);
    return to_output == kFar ? 0.5 : to_output == 0 ? 1 : in / (in + static_cast<double>(to_output));
  }
};

enum class Place { First, Second, Middle };

struct Item {  // what stands in a row
  std::size_t node = 0;
  std::size_t family = 0;
  std::string label;
  Place place = Place::Middle;
  bool is_guest = false;
};

std::vector<Family> families_of(const Connectome& c) {
  std::vector<Family> families;
  std::map<std::string, std::size_t> known;
  for (std::size_t n = 0; n < c.nodes.size(); ++n) {
    const SplitName name = split_name(c.nodes[n].name);
    const auto [at, is_new] = known.emplace(name.base, families.size());
    if (is_new) {
      families.push_back({name.base, c.nodes[n].nucleus, {}, {}});
    }
    families[at->second].sides.push_back(name.side);
    families[at->second].nodes.push_back(n);
  }
  return families;
}

using Neighbours = std::vector<std::set<std::size_t>>;

/// Breadth first over `next` from those of `sources` that have no distance yet.
void spread(const Neighbours& next, const std::vector<std::size_t>& sources, std::vector<std::size_t>& distance) {
  std::deque<std::size_t> queue;
  for (const std::size_t f : sources) {
    if (distance[f] == kFar) {
      distance[f] = 0;
      queue.push_back(f);
    }
  }
  while (!queue.empty()) {
    const std::size_t f = queue.front();
    queue.pop_front();
    for (const std::size_t g : next[f]) {
      if (distance[g] == kFar) {
        distance[g] = distance[f] + 1;
        queue.push_back(g);
      }
    }
  }
}

/// From the inputs; where those do not lead, from what nothing drives.
void rank_families(const Connectome& c, const std::vector<std::size_t>& family_of, std::vector<Family>& families) {
  Neighbours after(families.size());
  Neighbours before(families.size());
  for (const ConnectomeEdge& edge : c.edges) {
    if (family_of[edge.pre] != family_of[edge.post]) {
      after[family_of[edge.pre]].insert(family_of[edge.post]);
      before[family_of[edge.post]].insert(family_of[edge.pre]);
    }
  }
  std::vector<std::size_t> inputs, undriven, all, motor;
  for (std::size_t f = 0; f < families.size(); ++f) {
    all.push_back(f);
    if (c.nodes[families[f].nodes[0]].is_input) {
      inputs.push_back(f);
    }
    if (before[f].empty()) {
      undriven.push_back(f);
    }
  }
  for (const ConnectomeOutput& output : c.outputs) {
    motor.push_back(family_of[output.node]);
  }
  std::vector<std::size_t> from_input(families.size(), kFar);
  for (const auto& sources : {inputs, undriven, all}) {
    spread(after, sources, from_input);
  }
  std::vector<std::size_t> to_output(families.size(), kFar);
  spread(before, motor, to_output);
  for (std::size_t f = 0; f < families.size(); ++f) {
    families[f].rank = from_input[f];
    families[f].to_output = to_output[f];
  }
}

/// The pairs of sides that populations have, each a panel; one without sides when no population has two.
/// A module's populations are named like sides ("gate.open", "gate.shut"): a pair that one name has is no axis.
std::vector<std::pair<std::string, std::string>> panel_sides(const std::vector<Family>& families) {
  std::vector<std::pair<std::string, std::string>> pairs;
  std::map<std::pair<std::string, std::string>, int> uses;
  for (const Family& family : families) {
    if (family.sides.size() == 2 && ++uses[{family.sides[0], family.sides[1]}] == 2) {
      pairs.emplace_back(family.sides[0], family.sides[1]);
    }
  }
  if (pairs.empty()) {
    pairs.emplace_back();
  }
  return pairs;
}

class PanelLayout {
 public:
  PanelLayout(const Connectome& connectome, const std::vector<Family>& families,
              const std::vector<std::size_t>& family_of, double width)
      : connectome_(connectome), families_(families), family_of_(family_of), width_(width) {
    // Two boxes on each side of the middle one are the least that shows a nucleus as one; a phone has room for one.
    box_width_ = width < 600 ? (width - 2 * kMarginPx - 4 * kGapPx) / 3 : 104;
    half_slots_ = std::max<std::size_t>(
        1, static_cast<std::size_t>((half_width() - kBandPadPx + kGapPx) / (box_width_ + kGapPx)));
  }

  Panel lay_out(const std::pair<std::string, std::string>& sides, bool is_first, double top) {
    Panel panel;
    panel.first_side = sides.first;
    panel.second_side = sides.second;
    panel.top = top;
    has_sides_ = !sides.first.empty() || !sides.second.empty();
    const std::vector<Item> items = items_of(sides, is_first);
    double y = top + (has_sides_ ? kPanelTitlePx : 0);
    for (const std::string& nucleus : nuclei_in_order(items)) {
      y = place_band(nucleus, items, y, panel) + kBandGapPx;
    }
    y = place_joints(items, y, panel);
    panel.bottom = y;
    return panel;
  }

 private:
  [[nodiscard]] std::size_t full_slots() const {
    const double width = width_ - 2 * kMarginPx - 2 * kBandPadPx + kGapPx;
    return std::max<std::size_t>(1, static_cast<std::size_t>(width / (box_width_ + kGapPx)));
  }
  [[nodiscard]] double half_width() const { return width_ / 2 - kMarginPx - box_width_ / 2 - kGapPx; }

  std::vector<Item> items_of(const std::pair<std::string, std::string>& sides, bool is_first) {
    std::set<std::size_t> own;
    std::vector<Item> items;
    for (std::size_t f = 0; f < families_.size(); ++f) {
      const Family& family = families_[f];
      if (has_sides_ && family.is_pair && std::pair(family.sides[0], family.sides[1]) == sides) {
        items.push_back({family.nodes[0], f, family.base, Place::First, false});
        items.push_back({family.nodes[1], f, family.base, Place::Second, false});
        own.insert(f);
      }
    }
    // Those without a pair of sides go where what they are connected with is, else into the first panel.
    for (std::size_t f = 0; f < families_.size(); ++f) {
      if (!families_[f].is_pair && (is_connected(f, own) || (is_first && !is_connected_anywhere(f)))) {
        for (const std::size_t node : families_[f].nodes) {
          items.push_back({node, f, connectome_.nodes[node].name, Place::Middle, false});
        }
      }
    }
    // What other panels send here.
    std::set<std::size_t> here;
    for (const Item& item : items) {
      here.insert(item.node);
    }
    std::set<std::size_t> guests;
    for (const ConnectomeEdge& edge : connectome_.edges) {
      if (own.count(family_of_[edge.post]) != 0 && here.count(edge.pre) == 0) {
        guests.insert(family_of_[edge.pre]);
      }
    }
    for (const std::size_t f : guests) {
      items.push_back({families_[f].nodes[0], f, families_[f].base, Place::Middle, true});
    }
    return items;
  }

  [[nodiscard]] bool is_connected(std::size_t f, const std::set<std::size_t>& own) const {
    return std::any_of(connectome_.edges.begin(), connectome_.edges.end(), [&](const ConnectomeEdge& edge) {
      const std::size_t pre = family_of_[edge.pre];
      const std::size_t post = family_of_[edge.post];
      return (pre == f && own.count(post) != 0) || (post == f && own.count(pre) != 0);
    });
  }

  /// Whether some panel with sides has it.
  [[nodiscard]] bool is_connected_anywhere(std::size_t f) const {
    std::set<std::size_t> sided;
    for (std::size_t g = 0; g < families_.size(); ++g) {
      if (families_[g].is_pair) {
        sided.insert(g);
      }
    }
    return is_connected(f, sided);
  }

  /// A nucleus stands where its populations are on average; what has none makes a band of its own for each rank.
  [[nodiscard]] std::string band_of(const Item& item) const {
    const Family& family = families_[item.family];
    return family.nucleus.empty() ? std::string("\n") + std::to_string(family.rank) : family.nucleus;
  }

  [[nodiscard]] std::vector<std::string> nuclei_in_order(const std::vector<Item>& items) const {
    std::vector<std::string> names;
    std::map<std::string, std::pair<double, double>> sums;
    for (const Item& item : items) {
      const std::string band = band_of(item);
      if (sums.count(band) == 0) {
        names.push_back(band);
      }
      sums[band].first += families_[item.family].depth();
      sums[band].second += 1;
    }
    std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
      return sums[a].first / sums[a].second < sums[b].first / sums[b].second;
    });
    return names;
  }

  double place_band(const std::string& band, const std::vector<Item>& items, double y, Panel& panel) {
    const bool is_named = band[0] != '\n';
    std::map<std::size_t, std::vector<const Item*>> by_rank;
    for (const Item& item : items) {
      if (band_of(item) == band) {
        by_rank[families_[item.family].rank].push_back(&item);
      }
    }
    const double top = y;
    y += is_named ? kBandTitlePx + kBandPadPx : 0;
    for (const auto& [rank, row] : by_rank) {
      y = place_rows(row, y, panel);
    }
    y += is_named ? kBandPadPx - (kRowPx - kBoxHeightPx) : -kBandGapPx;
    panel.bands.push_back({is_named ? band : "", {kMarginPx, top, width_ - 2 * kMarginPx, y - top}});
    return y;
  }

  /// Rows from y on; both halves and the middle are filled from the midline outwards.
  double place_rows(const std::vector<const Item*>& row, double y, Panel& panel) {
    std::vector<const Item*> first, middle;
    std::map<std::size_t, const Item*> mirror;  // of a family, its second side
    for (const Item* item : row) {
      if (item->place == Place::Second) {
        mirror[item->family] = item;
      } else {
        (item->place == Place::First ? first : middle).push_back(item);
      }
    }
    const auto rows_for = [](std::size_t count, std::size_t slots) { return (count + slots - 1) / slots; };
    const std::size_t side_rows = rows_for(first.size(), half_slots_);
    const std::size_t middle_slots = first.empty() ? full_slots() : 1;
    const std::size_t rows = std::max(side_rows, rows_for(middle.size(), middle_slots));
    const double middle_x = width_ / 2;
    for (std::size_t k = 0; k < first.size(); ++k) {
      // Rows that are equally full look better than a full one and a rest.
      const std::size_t a_row = rows_for(first.size(), side_rows);
      const double row_y = y + static_cast<double>(k / a_row) * kRowPx;
      const std::size_t in_row = std::min(a_row, first.size() - k / a_row * a_row);
      const double step = std::max(half_width() / static_cast<double>(in_row), box_width_ + kGapPx);
      // One below the other would hide what passes between them.
      const double slot =
          in_row == 1 && half_slots_ > 1 ? (is_outside_ ? 0.68 : 0.32) : static_cast<double>(k % a_row) + 0.5;
      is_outside_ = in_row == 1 ? !is_outside_ : is_outside_;
      const double away = box_width_ / 2 + kGapPx + step * slot;
      place(*first[k], middle_x - away, row_y, panel);
      place(*mirror.at(first[k]->family), middle_x + away, row_y, panel);
    }
    for (std::size_t k = 0; k < middle.size(); ++k) {
      const std::size_t line = k / middle_slots;
      const std::size_t in_line = std::min(middle_slots, middle.size() - line * middle_slots);
      const double x = middle_x + (static_cast<double>(k % middle_slots) - static_cast<double>(in_line - 1) / 2) *
                                      (box_width_ + kGapPx);
      place(*middle[k], x, y + static_cast<double>(line) * kRowPx, panel);
    }
    return y + static_cast<double>(rows) * kRowPx;
  }

  void place(const Item& item, double x, double y, Panel& panel) const {
    const std::vector<std::size_t> one = {item.node};
    panel.nodes.push_back({item.node,
                           item.is_guest ? families_[item.family].nodes : one,
                           item.label,
                           {x - box_width_ / 2, y, box_width_, kBoxHeightPx},
                           item.is_guest});
  }

  double place_joints(const std::vector<Item>& items, double y, Panel& panel) const {
    std::vector<std::string> joints;
    for (const ConnectomeOutput& output : connectome_.outputs) {
      const bool is_here = std::any_of(items.begin(), items.end(),
                                       [&](const Item& item) { return item.node == output.node && !item.is_guest; });
      if (is_here && std::find(joints.begin(), joints.end(), output.joint) == joints.end()) {
        joints.push_back(output.joint);
      }
    }
    const double step = (width_ - 2 * kMarginPx) / static_cast<double>(std::max<std::size_t>(1, joints.size()));
    const double box_width = std::min(116.0, step - 6);
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const double x = kMarginPx + step * (static_cast<double>(k) + 0.5);
      panel.joints.push_back({joints[k], {x - box_width / 2, y + kBandGapPx, box_width, 26}});
    }
    return joints.empty() ? y - kBandGapPx : y + kBandGapPx + 26;
  }

  const Connectome& connectome_;
  const std::vector<Family>& families_;
  const std::vector<std::size_t>& family_of_;
  double width_;
  double box_width_ = 0;
  std::size_t half_slots_ = 1;
  bool has_sides_ = false;
  bool is_outside_ = false;  // where the next population stands that has its row to itself
};

}  // namespace

ConnectomeLayout lay_out_connectome(const Connectome& connectome, double width_px) {
  std::vector<Family> families = families_of(connectome);
  std::vector<std::size_t> family_of(connectome.nodes.size());
  for (std::size_t f = 0; f < families.size(); ++f) {
    for (const std::size_t node : families[f].nodes) {
      family_of[node] = f;
    }
  }
  rank_families(connectome, family_of, families);
  const auto pairs = panel_sides(families);
  for (Family& family : families) {
    family.is_pair = family.sides.size() == 2 &&
                     std::find(pairs.begin(), pairs.end(), std::pair(family.sides[0], family.sides[1])) != pairs.end();
  }
  ConnectomeLayout layout;
  layout.width = std::max(320.0, width_px);
  double y = kLegendPx;
  for (const auto& sides : pairs) {
    PanelLayout panel(connectome, families, family_of, layout.width);
    layout.panels.push_back(panel.lay_out(sides, layout.panels.empty(), y));
    y = layout.panels.back().bottom + kPanelGapPx;
  }
  layout.height = y;
  return layout;
}

}  // namespace tectum
