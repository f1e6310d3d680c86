#include "tools/diff/ports_diff.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "runtime/image/models.h"

namespace tectum {
namespace {

class PortsDiffer {
 public:
  PortsDiffer(const CircuitView& a, const CircuitView& b, const Correspondence& match) : a_(a), b_(b), match_(match) {}

  std::vector<Change> run() {
    retinas();
    outputs();
    joints();
    return std::move(changes_);
  }

 private:
  void changed(Element element, const std::string& name, const std::string& property, const std::string& before,
               const std::string& after) {
    if (before != after) {
      Change change;
      change.element = element;
      change.name = name;
      change.property = property;
      change.before = before;
      change.after = after;
      changes_.push_back(std::move(change));
    }
  }
  void came_or_went(ChangeKind kind, Element element, const std::string& name) {
    Change change;
    change.kind = kind;
    change.element = element;
    change.name = name;
    changes_.push_back(std::move(change));
  }

  void retinas() {
    std::map<std::string, std::pair<const RetinaRecord*, const RetinaRecord*>> both;
    for (const RetinaRecord& retina : a_.image.retinas) {
      both[std::string(a_.image.name(retina.name))].first = &retina;
    }
    for (const RetinaRecord& retina : b_.image.retinas) {
      both[std::string(b_.image.name(retina.name))].second = &retina;
    }
    for (const auto& [name, pair] : both) {
      if (pair.first == nullptr || pair.second == nullptr) {
        came_or_went(pair.first == nullptr ? ChangeKind::Added : ChangeKind::Removed, Element::Retina, name);
        continue;
      }
      retina_pair(name, *pair.first, *pair.second);
    }
  }
  void retina_pair(const std::string& name, const RetinaRecord& a, const RetinaRecord& b) {
    const auto frame = [](const RetinaRecord& r) { return fmt::format("{} x {} px", r.frame_width, r.frame_height); };
    const auto property = [&](const std::string& what, const std::string& before, const std::string& after) {
      changed(Element::Retina, name, what, before, after);
    };
    const auto eye = [](const RetinaRecord& r) { return r.eye == Eye::Left ? "left" : "right"; };
    property("eye", eye(a), eye(b));
    property("frame", frame(a), frame(b));
    property("field of view", quantity_text(a.field_of_view_deg, "deg"), quantity_text(b.field_of_view_deg, "deg"));
    property("number of fields", std::to_string(a.field_count), std::to_string(b.field_count));
    property("lit channel", std::string(lit_channel_name(a.lit_channel)), std::string(lit_channel_name(b.lit_channel)));
    property("lit threshold", std::to_string(a.lit_above), std::to_string(b.lit_above));
    property("lit share", quantity_text(a.lit_share, ""), quantity_text(b.lit_share, ""));
    if (a.field_count == b.field_count && !same_fields(a, b)) {
      property("fields", "some places", "other places");
    }
  }
  bool same_fields(const RetinaRecord& a, const RetinaRecord& b) const {
    const auto left = a_.image.fields.subspan(a.first_field, a.field_count);
    const auto right = b_.image.fields.subspan(b.first_field, b.field_count);
    return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                      [](const FieldRecord& x, const FieldRecord& y) {
                        return std::tie(x.x0, x.y0, x.x1, x.y1) == std::tie(y.x0, y.y0, y.x1, y.y1);
                      });
  }

  void outputs() {
    std::map<std::string, std::pair<const OutputView*, const OutputView*>> both;
    for (const OutputView& output : a_.outputs) {
      both[output.name].first = &output;
    }
    for (const OutputView& output : b_.outputs) {
      both[output.name].second = &output;
    }
    for (const auto& [name, pair] : both) {
      if (pair.first == nullptr || pair.second == nullptr) {
        came_or_went(pair.first == nullptr ? ChangeKind::Added : ChangeKind::Removed, Element::Output, name);
        continue;
      }
      const OutputView &x = *pair.first, &y = *pair.second;
      changed(Element::Output, name, "window", quantity_text(x.window_ms, "ms"), quantity_text(y.window_ms, "ms"));
      changed(Element::Output, name, "offset", quantity_text(x.offset_deg, "deg"), quantity_text(y.offset_deg, "deg"));
      changed(Element::Output, name, "joints", std::to_string(x.joint_mask), std::to_string(y.joint_mask));
      terms(name, x, y);
    }
  }
  void terms(const std::string& name, const OutputView& x, const OutputView& y) {
    std::map<std::uint32_t, std::pair<double, double>> gains;  // by b's population
    for (const OutputView::Term& term : x.terms) {
      gains[match_.population_of_a[term.population]].first += term.gain;
    }
    for (const OutputView::Term& term : y.terms) {
      gains[term.population].second += term.gain;
    }
    const char* unit = y.kind == OutputKind::Position ? "deg/Hz" : "deg/s/Hz";
    for (const auto& [population, gain] : gains) {
      const std::string of = population == kNoMatch ? "" : " of " + b_.populations[population].name;
      changed(Element::Output, name, "gain" + of, quantity_text(gain.first, unit), quantity_text(gain.second, unit));
    }
  }

  void joints() {
    std::map<int, std::pair<std::string, std::string>> both;
    const auto text = [](const JointRecord& joint) {
      return fmt::format("{:.6g} to {:.6g} deg{}", joint.min_deg, joint.max_deg,
                         joint.max_speed_deg_s > 0 ? fmt::format(", {:.6g} deg/s", joint.max_speed_deg_s) : "");
    };
    for (const JointRecord& joint : a_.image.joints) {
      both[static_cast<int>(joint.joint)].first = text(joint);
    }
    for (const JointRecord& joint : b_.image.joints) {
      both[static_cast<int>(joint.joint)].second = text(joint);
    }
    for (const auto& [joint, pair] : both) {
      changed(Element::Joint, kJointNames[static_cast<std::size_t>(joint)], "limits", pair.first, pair.second);
    }
  }

  const CircuitView& a_;
  const CircuitView& b_;
  const Correspondence& match_;
  std::vector<Change> changes_;
};

}  // namespace

std::vector<Change> diff_ports(const CircuitView& a, const CircuitView& b, const Correspondence& match) {
  return PortsDiffer(a, b, match).run();
}

}  // namespace tectum
