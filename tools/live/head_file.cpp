#include "tools/live/head_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "compiler/diagnostics/counted.h"
#include "compiler/diagnostics/render.h"
#include "compiler/expression/expression.h"
#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_json.h"
#include "compiler/validate/scope.h"

namespace tectum {
namespace {

constexpr double kNsPerMs = 1e6;

/// The last whole unit from home, down or up, that does not go beyond `limit_deg`.
std::uint16_t furthest_unit(const ServoJoint& joint, int step, double limit_deg) {
  const double way = step * joint.direction;  // the angle's on this side
  const auto home = static_cast<int>(std::lround(joint.home_units));
  int units = home;
  const auto is_inside = [&](int next) {
    return next >= 0 && next <= ax12::kHighestPosition && (deg_of(joint, next) - limit_deg) * way <= 1e-9;
  };
  while (is_inside(units + step)) {
    units += step;
  }
  return static_cast<std::uint16_t>(std::clamp(units, 0, int{ax12::kHighestPosition}));
}

class HeadReader {
 public:
  HeadReader(const JsonTree& tree, Diagnostics& diagnostics) : tree_(tree), scope_(diagnostics) {}

  HeadFile read();

 private:
  [[nodiscard]] Diagnostics& diagnostics() { return scope_.diagnostics(); }

  void read_link(JsonId id);
  void read_joints(JsonId id);
  void read_joint(JsonId id, const std::string& name, ServoJoint& joint, double& neutral_deg);
  void read_limits(ObjectReader& in, ServoJoint& joint);
  void read_bend(ObjectReader& in, ServoJoint& joint);
  void read_cameras(JsonId id);
  void read_camera(JsonId id, const std::string& name, HeadCamera& camera);
  void read_crop(ObjectReader& in, CropPx& crop);
  void read_geometry(JsonId id);

  /// The words' position in the list, reported when it is none of them.
  std::optional<std::size_t> word(ObjectReader& in, std::string_view key, std::string_view what,
                                  const std::vector<std::string>& words, bool is_required);
  /// A constant in [low, high]; `otherwise` when it is absent or wrong.
  double number(ObjectReader& in, std::string_view key, const Dimension& dimension, double low, double high,
                double otherwise);
  double number(const ValueDecl& value, std::string_view key, const Dimension& dimension, double low, double high,
                double otherwise);
  int whole(ObjectReader& in, std::string_view key, int low, int high, int otherwise);

  const JsonTree& tree_;
  Scope scope_;
  HeadFile head_;
};

std::optional<std::size_t> HeadReader::word(ObjectReader& in, std::string_view key, std::string_view what,
                                            const std::vector<std::string>& words, bool is_required) {
  const std::optional<NameDecl> given = in.name(key);
  if (!given) {
    if (is_required && !in.has(key)) {
      in.report_missing(key);
    }
    return std::nullopt;
  }
  const auto found = std::find(words.begin(), words.end(), given->text);
  if (found != words.end()) {
    return static_cast<std::size_t>(found - words.begin());
  }
  std::string list;
  for (const std::string& each : words) {
    list += fmt::format("{}`{}`", list.empty() ? "" : ", ", each);
  }
  diagnostics()
      .add(Code::UnknownWord, given->span, {std::string(what), given->text})
      .help_if(nearest_name(given->text, words), "did you mean `{}`?")
      .help(fmt::format("one of {}", list));
  return std::nullopt;
}

double HeadReader::number(const ValueDecl& value, std::string_view key, const Dimension& dimension, double low,
                          double high, double otherwise) {
  const std::optional<double> found = scope_.constant(value, key, dimension);
  if (!found) {
    return otherwise;
  }
  if (*found < low || *found > high) {
    diagnostics().add(Code::OutOfRange, value.span,
                      {std::string(key), shown(*found, dimension),
                       fmt::format("{} to {}", shown(low, dimension), shown(high, dimension))});
    return otherwise;
  }
  return *found;
}

double HeadReader::number(ObjectReader& in, std::string_view key, const Dimension& dimension, double low, double high,
                          double otherwise) {
  const std::optional<ValueDecl> value = in.value(key);
  return value ? number(*value, key, dimension, low, high, otherwise) : otherwise;
}

int HeadReader::whole(ObjectReader& in, std::string_view key, int low, int high, int otherwise) {
  const std::optional<ValueDecl> value = in.value(key);
  if (!value) {
    return otherwise;
  }
  const double found = number(*value, key, kNumber, low, high, otherwise);
  if (found != std::floor(found)) {
    diagnostics().add(Code::NotWhole, value->span, {std::string(key), value->text});
    return otherwise;
  }
  return static_cast<int>(found);
}

void HeadReader::read_link(JsonId id) {
  ObjectReader in(tree_, id, "`link`", diagnostics());
  const std::vector<std::string> kinds = {"emulated", "direct", "arbotix", "arbotix-ascii"};
  const auto kind = word(in, "kind", "link", kinds, true);
  if (kind) {
    head_.is_emulated = *kind == 0;
    head_.link = *kind == 2   ? ServoLinkKind::ArbotixRos
                 : *kind == 3 ? ServoLinkKind::ArbotixAscii
                              : ServoLinkKind::Direct;
  }
  head_.port = in.text("port");
  if (kind && !head_.is_emulated && !in.has("port")) {
    in.report_missing("port");
  }
  head_.baud = static_cast<std::uint32_t>(whole(in, "baud", 300, 4'000'000, 0));
  in.finish();
}

void HeadReader::read_limits(ObjectReader& in, ServoJoint& joint) {
  const std::vector<ValueDecl> limits = in.values("limits", 2);
  if (limits.size() != 2) {
    return;
  }
  const double a_deg = number(limits[0], "limits", kAngle, -180, 180, 0);
  const double b_deg = number(limits[1], "limits", kAngle, -180, 180, 0);
  if (a_deg >= b_deg) {
    diagnostics().add(Code::RangeReversed, limits[0].span, {"`limits`", shown(a_deg, kAngle), shown(b_deg, kAngle)});
    return;
  }
  const int rising = joint.direction;  // of the angle with the units
  joint.min_units = furthest_unit(joint, -1, rising > 0 ? a_deg : b_deg);
  joint.max_units = furthest_unit(joint, 1, rising > 0 ? b_deg : a_deg);
}

void HeadReader::read_bend(ObjectReader& in, ServoJoint& joint) {
  const JsonId id = in.child("bend");
  if (id == JsonId::None) {
    return;
  }
  const std::vector<ValueDecl> bend = in.values("bend", 0);
  if (bend.size() > joint.bend_deg.size()) {
    diagnostics().add(Code::WrongCount, tree_[id].span,
                      {"`bend`", counted(bend.size(), "value"), fmt::format("at most {}", joint.bend_deg.size())});
    return;
  }
  for (std::size_t k = 0; k < bend.size(); ++k) {
    joint.bend_deg[k] = number(bend[k], "bend", kAngle, -100, 100, 0);
  }
}

void HeadReader::read_joint(JsonId id, const std::string& name, ServoJoint& joint, double& neutral_deg) {
  ObjectReader in(tree_, id, fmt::format("joint `{}`", name), diagnostics());
  joint.is_present = true;
  if (!in.has("id")) {
    in.report_missing("id");
  }
  joint.id = static_cast<std::uint8_t>(whole(in, "id", 0, int{dynamixel::kHighestId}, joint.id));
  if (const std::optional<ValueDecl> direction = in.value("direction")) {
    if (direction->is_number && std::abs(direction->number) == 1) {
      joint.direction = static_cast<int>(direction->number);
    } else {
      diagnostics().add(Code::OutOfRange, direction->span, {"direction", direction->text, "1 or -1"});
    }
  }
  joint.home_units = number(in, "home", kNumber, 0, 1023, joint.home_units);
  joint.deg_per_unit = number(in, "deg_per_unit", kAngle, 0.01, 10, joint.deg_per_unit);
  read_bend(in, joint);
  read_limits(in, joint);
  joint.max_speed_deg_s = 1000 * number(in, "speed", kAngularVelocity, 0.0007, 0.700, 0);
  joint.torque_limit = static_cast<std::uint16_t>(std::lround(1023 * number(in, "torque_limit", kNumber, 0.01, 1, 1)));
  neutral_deg = number(in, "neutral", kAngle, -180, 180, 0);
  if (!is_monotonic(joint)) {
    diagnostics()
        .add(Code::OutOfRange, tree_[id].span, {"bend", "such that the angle turns back", "a bend that does not"})
        .help("narrow `limits`, or calibrate with a lower degree");
  }
  in.finish();
}

void HeadReader::read_joints(JsonId id) {
  for (ServoJoint& joint : head_.map.joints) {
    joint.is_present = false;
  }
  ObjectReader in(tree_, id, "`joints`", diagnostics());
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const JsonId child = in.child(kHeadJointNames[j]);
    if (child != JsonId::None) {
      read_joint(child, kHeadJointNames[j], head_.map.joints[j], head_.neutral_deg[j]);
    }
  }
  in.finish();
  for (std::size_t j = 0; j < kJointCount; ++j) {
    for (std::size_t k = 0; k < j; ++k) {
      const ServoJoint &a = head_.map.joints[j], &b = head_.map.joints[k];
      if (a.is_present && b.is_present && a.id == b.id) {
        diagnostics()
            .add(Code::NameClash, tree_[tree_.find(id, kHeadJointNames[j])].span, {fmt::format("servo {}", a.id)})
            .label(tree_[tree_.find(id, kHeadJointNames[k])].span, "and here");
      }
    }
  }
}

void HeadReader::read_crop(ObjectReader& in, CropPx& crop) {
  const std::vector<ValueDecl> box = in.values("crop", 4);
  if (box.size() == 4) {
    const auto px = [&](const ValueDecl& value, int low) {
      return static_cast<int>(number(value, "crop", kPixels, low, 16384, low));
    };
    crop = {px(box[0], 0), px(box[1], 0), px(box[2], 1), px(box[3], 1)};
  }
}

void HeadReader::read_camera(JsonId id, const std::string& name, HeadCamera& camera) {
  ObjectReader in(tree_, id, fmt::format("camera `{}`", name), diagnostics());
  const auto kind = word(in, "kind", "camera", {"simulated", "device", "video"}, true);
  camera.kind = static_cast<CameraKind>(kind.value_or(0));
  const bool is_device = camera.kind == CameraKind::Device;
  camera.path = in.text("path");
  if (camera.kind != CameraKind::Simulated && !in.has("path")) {
    in.report_missing("path");
  }
  camera.width_px = static_cast<int>(number(in, "width", kPixels, 16, 16384, 0));
  camera.height_px = static_cast<int>(number(in, "height", kPixels, 16, 16384, 0));
  camera.rate_hz = in_hz(number(in, "rate", kFrequency, from_hz(1), from_hz(1000), 0));
  camera.exposure = number(in, "exposure", kNumber, 1, 20000, 0);
  camera.pixel_format = in.text("pixel_format");
  read_crop(in, camera.crop);
  // A sensor has noise: two frames of a real camera are never the same, and a lit room is never all black.
  const double frozen_ms = number(in, "frozen_after", kTime, 0, 60'000, is_device ? 500 : 0);
  camera.frozen_after_ns = static_cast<TimeNs>(frozen_ms * kNsPerMs);
  camera.black_below = whole(in, "black_below", 0, 255, is_device ? 4 : 0);
  in.finish();
}

void HeadReader::read_cameras(JsonId id) {
  ObjectReader in(tree_, id, "`cameras`", diagnostics());
  for (const auto& [e, name] : {std::pair<std::size_t, const char*>{0, "left"}, {1, "right"}}) {
    const JsonId child = in.child(name);
    if (child != JsonId::None) {
      read_camera(child, name, head_.cameras[e]);
      if (head_.cameras[e].kind == CameraKind::Simulated && !head_.is_emulated) {
        diagnostics()
            .add(Code::KeysExclude, tree_[child].span, {"simulated", "link"})
            .help("a simulated eye needs the simulated head: `\"kind\": \"emulated\"` in `link`");
      }
    }
  }
  in.finish();
}

void HeadReader::read_geometry(JsonId id) {
  ObjectReader in(tree_, id, "`geometry`", diagnostics());
  HeadGeometry& g = head_.geometry;
  g.wall_distance_m = number(in, "wall_distance", kLength, 0.05, 100, g.wall_distance_m);
  g.eye_half_baseline_m = number(in, "eye_half_baseline", kLength, 0, 1, g.eye_half_baseline_m);
  g.neck_tilt_to_eye_forward_m = number(in, "neck_to_eye_forward", kLength, -1, 1, g.neck_tilt_to_eye_forward_m);
  g.neck_tilt_to_eye_tilt_up_m = number(in, "neck_to_eye_up", kLength, -1, 1, g.neck_tilt_to_eye_tilt_up_m);
  g.eye_tilt_to_camera_up_m = number(in, "eye_to_camera_up", kLength, -1, 1, g.eye_tilt_to_camera_up_m);
  in.finish();
}

HeadFile HeadReader::read() {
  ObjectReader in(tree_, tree_.root(), "the head", diagnostics());
  if (!in.is_object()) {
    return head_;
  }
  if (!in.has("tectum_head")) {
    in.report_missing("tectum_head");
  }
  (void)whole(in, "tectum_head", kHeadFileVersion, kHeadFileVersion, kHeadFileVersion);
  head_.name = in.text("name");
  (void)in.text("description");
  using Read = void (HeadReader::*)(JsonId);
  for (const auto& [key, read, is_required] :
       {std::tuple<const char*, Read, bool>{"link", &HeadReader::read_link, true},
        {"joints", &HeadReader::read_joints, true},
        {"cameras", &HeadReader::read_cameras, false},
        {"geometry", &HeadReader::read_geometry, false}}) {
    const JsonId id = in.child(key);
    if (id != JsonId::None) {
      (this->*read)(id);
    } else if (is_required) {
      in.report_missing(key);
    }
  }
  in.finish();
  return head_;
}

}  // namespace

ReadHead read_head_text(const std::string& name, const std::string& bytes) {
  ReadHead read;
  Sources sources;
  Diagnostics diagnostics;
  const FileId file = sources.add({name, bytes});
  if (const std::optional<JsonTree> tree = parse_json(sources, file, diagnostics)) {
    read.head = HeadReader(*tree, diagnostics).read();
  }
  if (!diagnostics.all().empty()) {
    diagnostics.sort();
    read.problems = render_text(diagnostics, sources);
  }
  if (diagnostics.has_errors()) {
    read.head.reset();
  }
  return read;
}

ReadHead read_head_file(const std::string& path) {
  ReadSource source = read_source(path);
  if (!source.ok) {
    ReadHead read;
    read.error = source.error;
    return read;
  }
  return read_head_text(source.file.name, source.file.bytes);
}

namespace {

/// The joints section's value.
std::string joints_json(const ServoMap& map, const std::array<double, kJointCount>& neutral_deg) {
  std::string text = "{\n";
  bool is_first = true;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const ServoJoint& joint = map.joints[j];
    if (!joint.is_present) {
      continue;
    }
    std::size_t bends = joint.bend_deg.size();
    while (bends > 0 && joint.bend_deg[bends - 1] == 0) {
      --bends;
    }
    std::string bend;
    for (std::size_t k = 0; k < bends; ++k) {
      bend += fmt::format("{}\"{:.9g} deg\"", k == 0 ? "" : ", ", joint.bend_deg[k]);
    }
    const double ends_deg[] = {deg_of(joint, joint.min_units), deg_of(joint, joint.max_units)};
    text += fmt::format(
        "{}    \"{}\": {{\"id\": {}, \"direction\": {}, \"home\": {}, \"deg_per_unit\": \"{:.9g} deg\"{},\n"
        "      \"limits\": [\"{:.4f} deg\", \"{:.4f} deg\"]",
        is_first ? "" : ",\n", kHeadJointNames[j], joint.id, joint.direction, joint.home_units, joint.deg_per_unit,
        bends == 0 ? "" : fmt::format(", \"bend\": [{}]", bend), std::min(ends_deg[0], ends_deg[1]),
        std::max(ends_deg[0], ends_deg[1]));
    text += joint.max_speed_deg_s > 0 ? fmt::format(", \"speed\": \"{} deg/s\"", joint.max_speed_deg_s) : "";
    text += joint.torque_limit < 1023 ? fmt::format(", \"torque_limit\": {:.4f}", joint.torque_limit / 1023.0) : "";
    text += neutral_deg[j] != 0 ? fmt::format(", \"neutral\": \"{} deg\"", neutral_deg[j]) : "";
    text += "}";
    is_first = false;
  }
  return text + "\n  }";
}

}  // namespace

std::optional<std::string> with_joints(const std::string& text, const ServoMap& map,
                                       const std::array<double, kJointCount>& neutral_deg) {
  Sources sources;
  Diagnostics ignored;
  const FileId file = sources.add({"head", text});
  const std::optional<JsonTree> tree = parse_json(sources, file, ignored);
  if (!tree || (*tree)[tree->root()].kind != JsonKind::Object) {
    return std::nullopt;
  }
  const JsonId joints = tree->find(tree->root(), "joints");
  if (joints == JsonId::None) {
    return std::nullopt;
  }
  const Span span = (*tree)[joints].span;
  return text.substr(0, span.begin) + joints_json(map, neutral_deg) + text.substr(span.end);
}

}  // namespace tectum
