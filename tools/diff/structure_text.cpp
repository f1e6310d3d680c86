#include <fmt/format.h>

#include <algorithm>
#include <iterator>

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

std::vector<ChangeLine> change_lines(const StructureDiff& diff) {
  std::vector<std::pair<std::string, std::vector<ChangeLine>>> groups;
  for (const Change& change : diff.changes) {
    const SidedName name = change.element == Element::Population ? sided_name(change.name) : SidedName{change.name, ""};
    const SidedName where = both_ends(change.where);
    const std::string side = change.element == Element::Population ? name.side : where.side;
    ChangeLine line{change.group, headline(change, name.base, where.base), side, change.because, change.place};
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == change.group; });
    if (group == groups.end()) {
      group = groups.insert(groups.end(), {change.group, {}});
    }
    const auto known = std::find_if(group->second.begin(), group->second.end(),
                                    [&](const ChangeLine& other) { return other.text == line.text; });
    if (known == group->second.end()) {
      group->second.push_back(std::move(line));
    } else if (!side.empty()) {
      known->sides += (known->sides.empty() ? "" : ", ") + side;
    }
  }
  std::vector<ChangeLine> lines;
  for (auto& [group, of_group] : groups) {
    std::move(of_group.begin(), of_group.end(), std::back_inserter(lines));
  }
  return lines;
}

std::string structure_text(const StructureDiff& diff) {
  std::string text, group;
  for (const ChangeLine& line : change_lines(diff)) {
    if (line.group != group) {
      group = line.group;
      text += group.empty() ? "" : group + "\n";
    }
    text += (line.group.empty() ? "" : "  ") + line.text;
    text += line.sides.empty() ? "" : fmt::format(" [{}]", line.sides);
    text += line.because.empty() ? "" : ", because " + line.because;
    text += line.place.empty() ? "\n" : "  (" + line.place + ")\n";
  }
  return text;
}

}  // namespace tectum
