#include "tools/evaluate/protocol.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compiler/diagnostics/render.h"
#include "compiler/expression/expression.h"
#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_json.h"
#include "compiler/validate/scope.h"

namespace tectum {
namespace {

constexpr int kProtocolVersion = 1;
constexpr double kSPerMs = 1e-3;

class ProtocolReader {
 public:
  ProtocolReader(const JsonTree& tree, Diagnostics& diagnostics) : tree_(tree), scope_(diagnostics) {}
  Protocol read();

 private:
  [[nodiscard]] Diagnostics& diagnostics() { return scope_.diagnostics(); }

  struct Limits {
    double low, high;
  };
  double number(const ValueDecl& value, std::string_view key, const Dimension& dimension, Limits limits,
                double otherwise);
  double number(ObjectReader& in, std::string_view key, const Dimension& dimension, Limits limits, double otherwise);
  int whole(ObjectReader& in, std::string_view key, Limits limits, int otherwise);
  std::vector<double> numbers(ObjectReader& in, std::string_view key, const Dimension& dimension, Limits limits,
                              std::vector<double> otherwise);
  std::size_t word(ObjectReader& in, std::string_view key, const std::vector<std::string>& words);
  std::optional<double> angle_if_given(ObjectReader& in, std::string_view key);
  /// The members of a list; reports what is none.
  std::vector<JsonId> list(JsonId id, std::string_view what);

  void read_trials(ObjectReader& in);
  void read_movement(ObjectReader& in);
  void read_target(JsonId id);
  void read_pid(JsonId id);
  void read_tuning(JsonId id);
  void read_published(JsonId id);
  void read_learning(JsonId id);

  const JsonTree& tree_;
  Scope scope_;
  Protocol protocol_;
};

double ProtocolReader::number(const ValueDecl& value, std::string_view key, const Dimension& dimension, Limits limits,
                              double otherwise) {
  const std::optional<double> found = scope_.constant(value, key, dimension);
  if (!found) {
    return otherwise;
  }
  if (*found < limits.low || *found > limits.high) {
    diagnostics().add(Code::OutOfRange, value.span,
                      {std::string(key), shown(*found, dimension),
                       fmt::format("{} to {}", shown(limits.low, dimension), shown(limits.high, dimension))});
    return otherwise;
  }
  return *found;
}

double ProtocolReader::number(ObjectReader& in, std::string_view key, const Dimension& dimension, Limits limits,
                              double otherwise) {
  const std::optional<ValueDecl> value = in.value(key);
  return value ? number(*value, key, dimension, limits, otherwise) : otherwise;
}

int ProtocolReader::whole(ObjectReader& in, std::string_view key, Limits limits, int otherwise) {
  const std::optional<ValueDecl> value = in.value(key);
  if (!value) {
    return otherwise;
  }
  const double found = number(*value, key, kNumber, limits, otherwise);
  if (found != std::floor(found)) {
    diagnostics().add(Code::NotWhole, value->span, {std::string(key), value->text});
    return otherwise;
  }
  return static_cast<int>(found);
}

std::vector<double> ProtocolReader::numbers(ObjectReader& in, std::string_view key, const Dimension& dimension,
                                            Limits limits, std::vector<double> otherwise) {
  if (!in.has(key)) {
    return otherwise;
  }
  std::vector<double> found;
  for (const ValueDecl& value : in.values(key, 0)) {
    found.push_back(number(value, key, dimension, limits, limits.low));
  }
  return found.empty() ? otherwise : found;
}

std::size_t ProtocolReader::word(ObjectReader& in, std::string_view key, const std::vector<std::string>& words) {
  const std::optional<NameDecl> given = in.name(key);
  if (!given) {
    return 0;
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
      .add(Code::UnknownWord, given->span, {std::string(key), given->text})
      .help_if(nearest_name(given->text, words), "did you mean `{}`?")
      .help(fmt::format("one of {}", list));
  return 0;
}

std::optional<double> ProtocolReader::angle_if_given(ObjectReader& in, std::string_view key) {
  const std::optional<ValueDecl> value = in.value(key);
  return value ? std::optional<double>(number(*value, key, kAngle, {-180, 180}, 0)) : std::nullopt;
}

std::vector<JsonId> ProtocolReader::list(JsonId id, std::string_view what) {
  std::vector<JsonId> members;
  if (id == JsonId::None) {
    return members;
  }
  if (tree_[id].kind != JsonKind::Array) {
    diagnostics().add(Code::WrongType, tree_[id].span,
                      {std::string(what), std::string(kind_phrase(tree_[id].kind)), "a list"});
    return members;
  }
  for (JsonId each = tree_[id].first_child; each != JsonId::None; each = tree_[each].next_sibling) {
    members.push_back(each);
  }
  return members;
}

void ProtocolReader::read_target(JsonId id) {
  ObjectReader in(tree_, id, "`target`", diagnostics());
  ScenarioParams& target = protocol_.scenario;
  target.kind = static_cast<ScenarioKind>(word(in, "kind", {kScenarioNames.begin(), kScenarioNames.end()}));
  target.random_pan_deg = number(in, "pan", kAngle, {0.1, 60}, target.random_pan_deg);
  target.random_tilt_deg = number(in, "tilt", kAngle, {0.1, 60}, target.random_tilt_deg);
  target.random_jump_deg = number(in, "jump", kAngle, {1, 180}, target.random_jump_deg);
  target.extent_m = number(in, "extent", kLength, {0, 10}, target.extent_m);
  target.step_hold_s = kSPerMs * number(in, "step_hold", kTime, {100, 1e6}, target.step_hold_s / kSPerMs);
  target.circle_period_s = kSPerMs * number(in, "circle_period", kTime, {100, 1e6}, target.circle_period_s / kSPerMs);
  target.chirp_first_period_s =
      kSPerMs * number(in, "chirp_first_period", kTime, {100, 1e6}, target.chirp_first_period_s / kSPerMs);
  target.chirp_shortest_period_s =
      kSPerMs * number(in, "chirp_shortest_period", kTime, {100, 1e6}, target.chirp_shortest_period_s / kSPerMs);
  target.chirp_ratio = number(in, "chirp_ratio", kNumber, {1.01, 10}, target.chirp_ratio);
  in.finish();
}

void ProtocolReader::read_pid(JsonId id) {
  for (const JsonId each : list(id, "`pid`")) {
    ObjectReader in(tree_, each, "gains", diagnostics());
    TunedPid tuned;
    tuned.camera_latency_frames = static_cast<std::uint32_t>(whole(in, "camera_latency", {0, 15}, 1));
    tuned.gains = {number(in, "p", kNumber, {0, 10}, 0), 1000 * number(in, "i", kFrequency, {0, 1}, 0),
                   kSPerMs * number(in, "d", kTime, {0, 1000}, 0)};
    in.finish();
    protocol_.pid.push_back(tuned);
  }
}

void ProtocolReader::read_tuning(JsonId id) {
  ObjectReader in(tree_, id, "`pid_tuning`", diagnostics());
  PidTuning& tuning = protocol_.tuning;
  tuning.first_seed = static_cast<std::uint64_t>(whole(in, "first_seed", {0, 1e9}, 1000));
  tuning.trials = whole(in, "trials", {1, 1000}, tuning.trials);
  tuning.duration_s = kSPerMs * number(in, "duration", kTime, {100, 1e7}, tuning.duration_s / kSPerMs);
  tuning.hold_s = kSPerMs * number(in, "hold", kTime, {50, 1e6}, tuning.hold_s / kSPerMs);
  tuning.p = numbers(in, "p", kNumber, {0, 10}, {});
  tuning.i_hz = numbers(in, "i", kFrequency, {0, 1}, {});
  tuning.d_s = numbers(in, "d", kTime, {0, 1000}, {});
  std::for_each(tuning.i_hz.begin(), tuning.i_hz.end(), [](double& value) { value *= 1000; });
  std::for_each(tuning.d_s.begin(), tuning.d_s.end(), [](double& value) { value *= kSPerMs; });
  in.finish();
}

void ProtocolReader::read_published(JsonId id) {
  ObjectReader in(tree_, id, "`published`", diagnostics());
  protocol_.published_by = in.text("by");
  const JsonId rows = in.child("rows");
  if (rows == JsonId::None) {
    in.report_missing("rows");
  }
  for (const JsonId each : list(rows, "`rows`")) {
    ObjectReader row(tree_, each, "a published row", diagnostics());
    PublishedRow published;
    published.what = row.text("what");
    published.median_deg = angle_if_given(row, "median");
    published.rmse_deg = angle_if_given(row, "rmse");
    published.learned_median_deg = angle_if_given(row, "learned_median");
    published.learned_rmse_deg = angle_if_given(row, "learned_rmse");
    row.finish();
    protocol_.published.push_back(published);
  }
  in.finish();
}

void ProtocolReader::read_learning(JsonId id) {
  ObjectReader in(tree_, id, "`learning`", diagnostics());
  LearningPlan& plan = protocol_.learning;
  plan.perturbed = numbers(in, "perturbed", kNumber, {0, 0.9}, plan.perturbed);
  plan.duration_s = kSPerMs * number(in, "duration", kTime, {100, 1e7}, plan.duration_s / kSPerMs);
  plan.first_seed = static_cast<std::uint64_t>(whole(in, "first_seed", {0, 1e9}, 2000));
  in.finish();
}

void ProtocolReader::read_trials(ObjectReader& in) {
  Protocol& protocol = protocol_;
  protocol.wall_distance_m = number(in, "wall_distance", kLength, {0.1, 10}, protocol.wall_distance_m);
  protocol.servo_speed_deg_s = 1000 * number(in, "servo_speed", kAngularVelocity, {0, 1}, 0);
  protocol.frame_rate_hz = 1000 * number(in, "frame_rate", kFrequency, {0.001, 1}, 0.045);
  protocol.trials = whole(in, "trials", {1, 1000}, protocol.trials);
  protocol.duration_s = kSPerMs * number(in, "duration", kTime, {100, 1e7}, protocol.duration_s / kSPerMs);
  protocol.first_seed = static_cast<std::uint64_t>(whole(in, "first_seed", {0, 1e9}, 0));
  protocol.hold_s = numbers(in, "hold", kTime, {50, 1e6}, {protocol.scenario.random_hold_s / kSPerMs});
  std::for_each(protocol.hold_s.begin(), protocol.hold_s.end(), [](double& value) { value *= kSPerMs; });
  protocol.camera_latency_frames.clear();
  for (const double frames : numbers(in, "camera_latency", kNumber, {0, 15}, {1})) {
    protocol.camera_latency_frames.push_back(static_cast<std::uint32_t>(frames));
  }
}

void ProtocolReader::read_movement(ObjectReader& in) {
  struct List {
    ProtocolKind kind;
    const char* key;
    const Dimension& dimension;
    Limits limits;
    double scale;
    std::vector<double> MovementSizes::*field;
  };
  for (const List& list :
       {List{ProtocolKind::Saccades, "sizes", kAngle, {0.2, 60}, 1, &MovementSizes::sizes_deg},
        List{ProtocolKind::Gaze, "sizes", kAngle, {1, 80}, 1, &MovementSizes::sizes_deg},
        List{ProtocolKind::Pursuit, "speeds", kAngularVelocity, {0.0001, 0.2}, 1000, &MovementSizes::speeds_deg_s},
        List{ProtocolKind::Pursuit, "periods", kTime, {200, 1e5}, kSPerMs, &MovementSizes::periods_s},
        List{ProtocolKind::Vergence, "distances", kLength, {0.15, 10}, 1, &MovementSizes::distances_m},
        List{ProtocolKind::Fixation, "dot_radii", kLength, {1e-4, 0.2}, 1, &MovementSizes::radii_m}}) {
    if (protocol_.kind == list.kind) {
      std::vector<double>& found = protocol_.movement.*list.field;
      found = numbers(in, list.key, list.dimension, list.limits, {});
      std::for_each(found.begin(), found.end(), [&](double& value) { value *= list.scale; });
      if (!in.has(list.key)) {
        in.report_missing(list.key);
      }
    }
  }
  if (protocol_.kind == ProtocolKind::Fixation) {
    protocol_.movement.fovea_deg = number(in, "fovea", kAngle, {0.05, 45}, 0);
  }
}

Protocol ProtocolReader::read() {
  ObjectReader in(tree_, tree_.root(), "the protocol", diagnostics());
  if (!in.is_object()) {
    return protocol_;
  }
  if (!in.has("tectum_protocol")) {
    in.report_missing("tectum_protocol");
  }
  (void)whole(in, "tectum_protocol", {kProtocolVersion, kProtocolVersion}, kProtocolVersion);
  protocol_.name = in.text("name");
  protocol_.about = in.text("about");
  protocol_.kind = static_cast<ProtocolKind>(word(in, "kind",
                                                  {"tracking", "physiology", "learning", "saccades", "pursuit",
                                                   "vergence", "gaze", "fixation", "clinic", "robustness"}));
  read_trials(in);
  read_movement(in);
  using Read = void (ProtocolReader::*)(JsonId);
  for (const auto& [key, read] : {std::pair<const char*, Read>{"target", &ProtocolReader::read_target},
                                  {"pid", &ProtocolReader::read_pid},
                                  {"pid_tuning", &ProtocolReader::read_tuning},
                                  {"published", &ProtocolReader::read_published},
                                  {"learning", &ProtocolReader::read_learning}}) {
    const JsonId id = in.child(key);
    if (id != JsonId::None) {
      (this->*read)(id);
    }
  }
  // Read by clinic_file.cpp and robustness_file.cpp.
  for (const auto& [kind, key] :
       {std::pair{ProtocolKind::Clinic, "clinic"}, std::pair{ProtocolKind::Robustness, "robustness"}}) {
    if (in.child(key) == JsonId::None && protocol_.kind == kind) {
      in.report_missing(key);
    }
  }
  // The movement protocols make their own targets out of their lists.
  if (!in.has("target") && (protocol_.kind == ProtocolKind::Tracking || protocol_.kind == ProtocolKind::Physiology ||
                            protocol_.kind == ProtocolKind::Robustness)) {
    in.report_missing("target");
  }
  in.finish();
  return protocol_;
}

}  // namespace

std::vector<Setting> settings_of(const Protocol& protocol) {
  std::vector<Setting> settings;
  const bool has_holds = protocol.kind != ProtocolKind::Physiology && protocol.scenario.kind == ScenarioKind::Random;
  for (const std::uint32_t latency : protocol.camera_latency_frames) {
    for (const double hold_s : has_holds ? protocol.hold_s : std::vector<double>{0}) {
      settings.push_back({hold_s, latency});
    }
  }
  return settings;
}

PidGains pid_gains(const Protocol& protocol, std::uint32_t camera_latency_frames) {
  const auto distance = [&](const TunedPid& tuned) {
    return std::abs(static_cast<int>(tuned.camera_latency_frames) - static_cast<int>(camera_latency_frames));
  };
  const auto nearest =
      std::min_element(protocol.pid.begin(), protocol.pid.end(),
                       [&](const TunedPid& a, const TunedPid& b) { return distance(a) < distance(b); });
  return nearest == protocol.pid.end() ? PidGains{0.3, 5, 0} : nearest->gains;
}

ReadProtocol read_protocol_text(const std::string& name, const std::string& bytes) {
  ReadProtocol read;
  Sources sources;
  Diagnostics diagnostics;
  const FileId file = sources.add({name, bytes});
  if (const std::optional<JsonTree> tree = parse_json(sources, file, diagnostics)) {
    read.protocol = ProtocolReader(*tree, diagnostics).read();
  }
  if (!diagnostics.all().empty()) {
    diagnostics.sort();
    read.problems = render_text(diagnostics, sources);
  }
  if (diagnostics.has_errors()) {
    read.protocol.reset();
  }
  return read;
}

ReadProtocol read_protocol_file(const std::string& path) {
  ReadSource source = read_source(path);
  if (!source.ok) {
    ReadProtocol read;
    read.error = source.error;
    return read;
  }
  return read_protocol_text(source.file.name, source.file.bytes);
}

}  // namespace tectum
