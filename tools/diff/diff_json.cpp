#include "tools/diff/diff_json.h"

#include <nlohmann/json.hpp>

namespace tectum {

std::string diff_json(const CircuitView& a, const CircuitView& b, const StructureDiff& structure) {
  nlohmann::ordered_json json;
  json["first"] = a.path;
  json["second"] = b.path;
  json["same"] = structure.is_same();
  json["changes"] = nlohmann::ordered_json::array();
  for (const Change& change : structure.changes) {
    json["changes"].push_back({{"kind", change_name(change.kind)},
                               {"element", element_name(change.element)},
                               {"name", change.name},
                               {"where", change.where},
                               {"property", change.property},
                               {"before", change.before},
                               {"after", change.after},
                               {"detail", change.detail},
                               {"group", change.group},
                               {"place", change.place},
                               {"because", change.because}});
  }
  return json.dump(2);
}

}  // namespace tectum
