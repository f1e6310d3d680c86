#include "tools/circuit_tests/test_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "compiler/expression/expression.h"
#include "compiler/parse/parse_json.h"

namespace tectum {
namespace {

constexpr int kTestVersion = 1;
constexpr double kSPerMs = 1e-3;
constexpr double kUsualDurationS = 10;
constexpr std::size_t kMostSeeds = 10'000;

bool is_number(const std::string& text, std::uint64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::string TestReader::path_from(const std::string& name) const {
  const std::filesystem::path path(name);
  return path.is_absolute() || folder_.empty() ? name : (std::filesystem::path(folder_) / path).string();
}

double TestReader::number(const ValueDecl& value, std::string_view key, const Dimension& dimension, Limits limits,
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

double TestReader::number(ObjectReader& in, std::string_view key, const Dimension& dimension, Limits limits,
                          double otherwise) {
  const std::optional<ValueDecl> value = in.value(key);
  return value ? number(*value, key, dimension, limits, otherwise) : otherwise;
}

std::size_t TestReader::word(const NameDecl& given, std::string_view what, const std::vector<std::string>& words) {
  const auto found = std::find(words.begin(), words.end(), given.text);
  if (found != words.end() || given.is_poisoned) {
    return found == words.end() ? 0 : static_cast<std::size_t>(found - words.begin());
  }
  std::string list;
  for (const std::string& each : words) {
    list += fmt::format("{}`{}`", list.empty() ? "" : ", ", each);
  }
  diagnostics()
      .add(Code::UnknownWord, given.span, {std::string(what), given.text})
      .help_if(nearest_name(given.text, words), "did you mean `{}`?")
      .help(fmt::format("one of {}", list));
  return 0;
}

ValueDecl TestReader::value_of(JsonId id) const {
  ValueDecl value;
  value.is_number = node(id).kind == JsonKind::Number;
  value.number = node(id).number;
  value.text = node(id).text;
  value.span = inner_span(node(id));
  value.has_exact_offsets = !value.is_number && !node(id).has_escapes;
  return value;
}

void TestReader::report_type(JsonId id, std::string_view what, std::string_view expected) {
  diagnostics().add(Code::WrongType, node(id).span,
                    {fmt::format("`{}`", what), std::string(kind_phrase(node(id).kind)), std::string(expected)});
}

void TestReader::read_scenario(JsonId id, SimulatedWorld& world) {
  ObjectReader in(tree_, id, "`scenario`", diagnostics());
  if (const auto kind = in.name("kind")) {
    world.scenario = world_scenarios()[word(*kind, "scenario", world_scenarios())];
  }
  world.duration_s = kSPerMs * number(in, "duration", kTime, {20, 1e7}, world.duration_s / kSPerMs);
  world.hold_s = kSPerMs * number(in, "hold", kTime, {50, 1e6}, world.hold_s / kSPerMs);
  const std::vector<ValueDecl> to = in.values("to", 2);
  if (to.size() == 2) {
    world.to_deg = {number(to[0], "to", kAngle, {-60, 60}, 0), number(to[1], "to", kAngle, {-60, 60}, 0)};
  }
  world.frame_rate_hz = 1000 * number(in, "frame_rate", kFrequency, {0.001, 1}, world.frame_rate_hz / 1000);
  const auto whole = [&](std::string_view key, Limits limits, double otherwise) {
    const std::optional<ValueDecl> value = in.value(key);
    const double found = value ? number(*value, key, kNumber, limits, otherwise) : otherwise;
    if (found != std::floor(found)) {
      diagnostics().add(Code::NotWhole, value->span, {std::string(key), value->text});
      return otherwise;
    }
    return found;
  };
  world.camera_latency_frames =
      static_cast<std::uint32_t>(whole("camera_latency", {0, 15}, world.camera_latency_frames));
  world.resolution_px = static_cast<int>(whole("resolution", {32, 2160}, world.resolution_px));
  world.noise = number(in, "noise", kNumber, {0, 64}, world.noise);
  const JsonId clutter = in.child("clutter");
  if (clutter != JsonId::None) {
    if (node(clutter).kind == JsonKind::Boolean) {
      world.clutter = node(clutter).boolean;
    } else {
      report_type(clutter, "clutter", "true or false");
    }
  }
  if (const auto dot = in.name("dot")) {
    const std::vector<std::string> colours = {"red", "green", "blue"};
    world.dot = colours[word(*dot, "colour", colours)];
  }
  in.finish();
}

std::vector<std::uint64_t> TestReader::seed_values(JsonId id) {
  std::vector<std::uint64_t> values;
  if (node(id).kind == JsonKind::Array) {
    for (JsonId each = node(id).first_child; each != JsonId::None; each = node(each).next_sibling) {
      const std::vector<std::uint64_t> found = seed_values(each);
      values.insert(values.end(), found.begin(), found.end());
    }
    return values;
  }
  const std::string& text = node(id).text;
  const std::size_t dots = text.find("..");
  std::uint64_t first = 0, last = 0;
  if (node(id).kind != JsonKind::Number && node(id).kind != JsonKind::String) {
    report_type(id, "seeds", "a number, a list, or a range like \"1..5\"");
  } else if (is_number(text, first)) {
    values.push_back(first);
  } else if (dots != std::string::npos && is_number(text.substr(0, dots), first) &&
             is_number(text.substr(dots + 2), last) && first <= last && last - first < kMostSeeds) {
    for (std::uint64_t seed = first; seed <= last; ++seed) {
      values.push_back(seed);
    }
  } else {
    diagnostics()
        .add(Code::UnexpectedToken, inner_span(node(id)), {"seeds", fmt::format("`{}`", text)})
        .help(R"(write 1, [1, 2, 3] or "1..5")");
  }
  return values;
}

void TestReader::read_seeds(JsonId id, Seeds& seeds) {
  JsonId values = id;
  if (node(id).kind == JsonKind::Object) {
    static const std::vector<std::pair<const char*, Quantifier>> kWords = {
        {"every", Quantifier::Every}, {"most", Quantifier::Most}, {"mean", Quantifier::Mean}};
    ObjectReader in(tree_, id, "`seeds`", diagnostics());
    values = JsonId::None;
    for (const auto& [key, quantifier] : kWords) {
      const JsonId found = in.child(key);
      if (found == JsonId::None) {
        continue;
      }
      if (values != JsonId::None) {
        diagnostics().add(Code::KeysExclude, node(found).key_span, {node(values).key, key});
      }
      values = found;
      seeds.quantifier = quantifier;
    }
    if (values == JsonId::None) {
      in.report_missing("every");
    }
    in.finish();
  }
  if (values != JsonId::None) {
    const std::vector<std::uint64_t> found = seed_values(values);
    if (found.empty() && !diagnostics().has_errors()) {
      diagnostics().add(Code::EmptyList, node(values).span, {"`seeds`"});
    }
    seeds.values = found.empty() ? seeds.values : found;
  }
}

void TestReader::read_setting(ObjectReader& in, CircuitTest& test) {
  if (const auto circuit = in.name("circuit")) {
    test.circuit = path_from(circuit->text);
    test.circuit_span = circuit->span;
  }
  if (in.has("lesions")) {
    test.lesions.clear();
    const JsonId lesions = in.child("lesions");
    const bool is_none = node(lesions).kind == JsonKind::Array && node(lesions).first_child == JsonId::None;
    for (const NameDecl& lesion : is_none ? std::vector<NameDecl>{} : in.names("lesions")) {
      test.lesions.push_back(lesion.text);
    }
  }
  const JsonId parameters = in.child("parameters");
  if (parameters != JsonId::None) {
    ObjectReader values(tree_, parameters, "`parameters`", diagnostics());
    for (const KeyedValue& each : values.rest()) {
      if (each.is_list || each.values.empty()) {
        diagnostics().add(Code::WrongType, each.span, {fmt::format("`{}`", each.key.text), "a list", "a value"});
        continue;
      }
      const std::string prefix = each.key.text + "=";
      std::erase_if(test.parameters, [&](const std::string& other) { return other.starts_with(prefix); });
      test.parameters.push_back(prefix + each.values.front().text);
    }
  }
  if (const JsonId scenario = in.child("scenario"); scenario != JsonId::None) {
    read_scenario(scenario, test.world);
  }
  if (const JsonId seeds = in.child("seeds"); seeds != JsonId::None) {
    read_seeds(seeds, test.seeds);
  }
  test.settle_s = kSPerMs * number(in, "settle", kTime, {0, 1e7}, test.settle_s / kSPerMs);
}

void TestReader::read_test(JsonId id, CircuitTest test, std::vector<CircuitTest>& tests) {
  test.name = node(id).key;
  test.span = {node(id).key_span.file, node(id).key_span.begin + 1, node(id).key_span.end - 1};
  ObjectReader in(tree_, id, fmt::format("test `{}`", test.name), diagnostics());
  (void)in.text("about");
  read_setting(in, test);
  if (test.circuit.empty() && !in.has("circuit")) {
    in.report_missing("circuit");
  }
  const JsonId expect = in.child("expect");
  if (expect == JsonId::None) {
    in.report_missing("expect");
  } else {
    read_expectations(expect, test);
  }
  in.finish();
  tests.push_back(std::move(test));
}

std::vector<CircuitTest> TestReader::read() {
  std::vector<CircuitTest> tests;
  ObjectReader in(tree_, tree_.root(), "the test file", diagnostics());
  if (!in.is_object()) {
    return tests;
  }
  (void)in.text("$schema");
  (void)in.text("about");
  const std::optional<ValueDecl> version = in.value("tectum_test");
  if (version) {
    (void)number(*version, "tectum_test", kNumber, {kTestVersion, kTestVersion}, kTestVersion);
  } else {
    in.report_missing("tectum_test");
  }
  CircuitTest usual;
  usual.world.duration_s = kUsualDurationS;
  read_setting(in, usual);
  const JsonId list = in.child("tests");
  if (list == JsonId::None) {
    in.report_missing("tests");
  } else if (node(list).kind != JsonKind::Object) {
    report_type(list, "tests", "an object with a name for each test");
  } else {
    for (JsonId each = node(list).first_child; each != JsonId::None; each = node(each).next_sibling) {
      read_test(each, usual, tests);
    }
    if (tests.empty()) {
      diagnostics().add(Code::EmptyList, node(list).span, {"`tests`"});
    }
  }
  in.finish();
  return tests;
}

TestFile read_test_text(const std::string& path, const std::string& bytes) {
  TestFile file;
  file.path = path;
  const FileId id = file.sources.add({path, bytes});
  if (const std::optional<JsonTree> tree = parse_json(file.sources, id, file.diagnostics)) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    file.tests = TestReader(*tree, folder, file.diagnostics).read();
  }
  file.diagnostics.sort();
  return file;
}

TestFile read_test_file(const std::string& path) {
  ReadSource source = read_source(path);
  if (!source.ok) {
    TestFile file;
    file.path = path;
    file.error = source.error;
    return file;
  }
  return read_test_text(path, source.file.bytes);
}

}  // namespace tectum
