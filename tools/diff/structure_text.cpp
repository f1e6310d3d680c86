#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tools/diff/structure_diff.h"

namespace tectum {
namespace {

/// "IFN.left -> LLBN.left" without its sides, and with them: "IFN -> LLBN" and "left -> left".
SidedName both_ends(const std::string& where) {
  const std::size_t arrow = where.find(" -> ");
  if (arrow == std::string::npos) {
    return sided_name(where);
  }
  const SidedName pre = sided_name(where.substr(0, arrow)), post = sided_name(where.substr(arrow + 4));
  const std::string sides = pre.side == post.side ? pre.side : pre.side + " to " + post.side;
  return {pre.base + " -> " + post.base, sides};
}

std::string headline(const Change& change, const std::string& name, const std::string& where) {
  const std::string what =
      fmt::format("{} {}{}{}", element_name(change.element), name, where.empty() ? "" : ", ", where);
  const std::string detail = change.detail.empty() ? "" : " (" + change.detail + ")";
  switch (change.kind) {
    case ChangeKind::Added:
      return what + ": only in the second" + detail;
    case ChangeKind::Removed:
      return what + ": only in the first" + detail;
    case ChangeKind::Renamed:
      return what + ": was called " + sided_name(change.before).base;
    case ChangeKind::Changed:
      break;
  }
  return fmt::format("{}: {} {} instead of {}{}", what, change.property, change.after, change.before, detail);
}

}  // namespace

std::string structure_text(const StructureDiff& diff) {
  struct Line {
    std::string text, because, place;
    std::vector<std::string> sides;
  };
  std::vector<std::pair<std::string, std::vector<Line>>> groups;
  std::map<std::string, std::pair<std::size_t, std::size_t>> place_of_line;
  for (const Change& change : diff.changes) {
    const bool has_side = change.element == Element::Population || change.element == Element::Projection;
    const SidedName name = change.element == Element::Population ? sided_name(change.name) : SidedName{change.name, ""};
    const SidedName where = both_ends(change.where);
    Line line{headline(change, name.base, where.base), change.because, change.place, {}};
    const std::string side = change.element == Element::Population ? name.side : where.side;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == change.group; });
    if (group == groups.end()) {
      group = groups.insert(groups.end(), {change.group, {}});
    }
    const std::string key = change.group + "\n" + line.text;
    const auto known = place_of_line.find(key);
    if (known == place_of_line.end()) {
      place_of_line[key] = {static_cast<std::size_t>(group - groups.begin()), group->second.size()};
      group->second.push_back(std::move(line));
      if (has_side && !side.empty()) {
        group->second.back().sides.push_back(side);
      }
    } else if (!side.empty()) {
      groups[known->second.first].second[known->second.second].sides.push_back(side);
    }
  }
  std::string text;
  for (const auto& [group, lines] : groups) {
    text += group.empty() ? "" : group + "\n";
    for (const Line& line : lines) {
      text += (group.empty() ? "" : "  ") + line.text;
      text += line.sides.empty() ? "" : fmt::format(" [{}]", fmt::join(line.sides, ", "));
      text += line.because.empty() ? "" : ", because " + line.because;
      text += line.place.empty() ? "\n" : "  (" + line.place + ")\n";
    }
  }
  return text;
}

}  // namespace tectum
