// The `expect` of a test.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/expression/expression.h"
#include "tools/circuit_tests/measures.h"
#include "tools/circuit_tests/test_reader.h"
#include "tools/evaluate/tracking_evaluation.h"

namespace tectum {
namespace {

constexpr double kStillDeg = 1;
constexpr double kMsPerS = 1000;

std::optional<std::size_t> measure_named(std::string_view section, std::string_view key) {
  for (std::size_t m = 0; m < measures().size(); ++m) {
    if (section == measures()[m].section && key == measures()[m].key) {
      return m;
    }
  }
  return std::nullopt;
}

std::vector<std::string> keys_of(std::string_view section) {
  std::vector<std::string> keys;
  for (const Measure& measure : measures()) {
    if (section == measure.section) {
      keys.emplace_back(measure.key);
    }
  }
  return keys;
}

/// "settled rmse"
std::string readable(std::string_view key) {
  std::string text(key);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

Span key_span(const JsonNode& node) { return {node.key_span.file, node.key_span.begin + 1, node.key_span.end - 1}; }

}  // namespace

void TestReader::add_bound(JsonId id, Expectation expectation, CircuitTest& test) {
  if (node(id).kind != JsonKind::String && node(id).kind != JsonKind::Number) {
    report_type(id, node(id).key, "a bound like \"< 10\"");
    return;
  }
  const ValueDecl value = value_of(id);
  const std::optional<Bound> bound = read_bound(value, node(id).key, expectation.dimension, scope_);
  if (bound) {
    expectation.bound = *bound;
    expectation.span = value.span;
    test.expectations.push_back(std::move(expectation));
  }
}

void TestReader::read_measure(JsonId id, std::string_view section, std::size_t measure, CircuitTest& test) {
  const Measure& what = measures()[measure];
  Expectation expectation;
  expectation.measure = measure;
  expectation.dimension = what.dimension;
  expectation.is_share = what.is_share;
  expectation.what = section.empty() ? readable(what.key) : fmt::format("{} {}", section, readable(what.key));
  if (!what.has_channels || node(id).kind != JsonKind::Object) {
    add_bound(id, std::move(expectation), test);
    return;
  }
  const std::vector<std::string> channels(kChannelNames.begin(), kChannelNames.end());
  for (JsonId each = node(id).first_child; each != JsonId::None; each = node(each).next_sibling) {
    expectation.channel = word({node(each).key, key_span(node(each))}, "eye and direction", channels);
    Expectation of_channel = expectation;
    of_channel.what += fmt::format(", {}", channels[*expectation.channel]);
    add_bound(each, std::move(of_channel), test);
  }
}

void TestReader::read_saccade(JsonId id, CircuitTest& test) {
  ObjectReader in(tree_, id, "`saccade`", diagnostics());
  for (const std::string& key : keys_of("saccade")) {
    if (const JsonId found = in.child(key); found != JsonId::None) {
      read_measure(found, "saccade", *measure_named("saccade", key), test);
    }
  }
  in.finish();
}

void TestReader::read_rates(JsonId id, CircuitTest& test) {
  if (node(id).kind != JsonKind::Object) {
    report_type(id, "rate", "an object like {\"OPN during fixation\": \"100 Hz ± 30\"}");
    return;
  }
  static constexpr std::string_view kDuring = " during ";
  static const std::vector<std::string> kTimes = {"fixation", "saccades"};
  for (JsonId each = node(id).first_child; each != JsonId::None; each = node(each).next_sibling) {
    Expectation expectation;
    expectation.kind = ExpectationKind::Rate;
    expectation.dimension = kFrequency;
    const std::string& key = node(each).key;
    expectation.what = fmt::format("rate of {}", key);
    const std::size_t during = key.find(kDuring);
    expectation.population = key.substr(0, during);
    expectation.name_span = key_span(node(each));
    expectation.name_span.end = expectation.name_span.begin + static_cast<std::uint32_t>(expectation.population.size());
    if (during != std::string::npos) {
      const std::string time = key.substr(during + kDuring.size());
      const Span span = key_span(node(each));
      const auto begin = static_cast<std::uint32_t>(during + kDuring.size());
      expectation.time =
          static_cast<RateTime>(1 + word({time, {span.file, span.begin + begin, span.end}}, "time", kTimes));
    }
    add_bound(each, std::move(expectation), test);
  }
}

void TestReader::read_eyes(JsonId id, CircuitTest& test) {
  if (node(id).kind != JsonKind::String) {
    report_type(id, "eyes", "\"still\" or \"run away\"");
    return;
  }
  Expectation expectation;
  expectation.span = inner_span(node(id));
  if (word({node(id).text, expectation.span}, "behaviour of the eyes", {"still", "run away"}) == 1) {
    expectation.kind = ExpectationKind::RunAway;
    expectation.what = "the eyes' course";
  } else {
    expectation.measure = *measure_named("", "eye_travel");
    expectation.dimension = kAngle;
    expectation.what = "eye travel";
    expectation.bound.high = kStillDeg;
    expectation.bound.text = fmt::format("still (within {} deg)", kStillDeg);
  }
  test.expectations.push_back(std::move(expectation));
}

void TestReader::read_raster(JsonId id, CircuitTest& test) {
  Expectation expectation;
  expectation.kind = ExpectationKind::Raster;
  expectation.what = "raster";
  if (node(id).kind == JsonKind::String) {
    expectation.path = path_from(node(id).text);
    expectation.span = inner_span(node(id));
    test.expectations.push_back(std::move(expectation));
    return;
  }
  ObjectReader in(tree_, id, "`raster`", diagnostics());
  if (!in.is_object()) {
    return;
  }
  const NameDecl file = in.required_name("file");
  expectation.path = path_from(file.text);
  expectation.span = file.span;
  expectation.name_span = file.span;
  for (const NameDecl& name : in.names("populations")) {
    expectation.name_span = name.span;
    expectation.populations.push_back(name.text);
  }
  expectation.begin_s = number(in, "from", kTime, {0, 1e7}, 0) / kMsPerS;
  expectation.end_s = number(in, "to", kTime, {0, 1e7}, 0) / kMsPerS;
  in.finish();
  if (!file.is_poisoned) {
    test.expectations.push_back(std::move(expectation));
  }
}

void TestReader::read_same_as(JsonId id, CircuitTest& test) {
  if (node(id).kind != JsonKind::String) {
    report_type(id, "same_as", "a text like \"oculomotor.json within 0.2 deg\"");
    return;
  }
  static constexpr std::string_view kWithin = " within ";
  const std::string& text = node(id).text;
  const std::size_t within = text.find(kWithin);
  Expectation expectation;
  expectation.kind = ExpectationKind::SameAs;
  expectation.span = inner_span(node(id));
  expectation.dimension = kAngle;
  expectation.path = path_from(text.substr(0, within));
  expectation.what = fmt::format("difference from {}", text.substr(0, within));
  expectation.is_exact = within == std::string::npos;
  if (!expectation.is_exact) {
    ValueDecl tolerance = value_of(id);
    std::string number_text = text.substr(within + kWithin.size());
    expectation.is_rms = number_text.ends_with(" rms");
    number_text.resize(number_text.size() - (expectation.is_rms ? 4 : 0));
    tolerance.text = number_text;
    tolerance.span.begin += static_cast<std::uint32_t>(within + kWithin.size());
    tolerance.span.end = tolerance.span.begin + static_cast<std::uint32_t>(number_text.size());
    expectation.bound.high = number(tolerance, "same_as", kAngle, {0, 360}, 0);
    expectation.bound.text = text.substr(within + 1);
  }
  test.expectations.push_back(std::move(expectation));
}

void TestReader::read_expectations(JsonId id, CircuitTest& test) {
  ObjectReader in(tree_, id, "`expect`", diagnostics());
  for (const std::string& key : keys_of("")) {
    if (const JsonId found = in.child(key); found != JsonId::None) {
      read_measure(found, "", *measure_named("", key), test);
    }
  }
  using Read = void (TestReader::*)(JsonId, CircuitTest&);
  for (const auto& [key, read] : {std::pair<const char*, Read>{"saccade", &TestReader::read_saccade},
                                  {"rate", &TestReader::read_rates},
                                  {"eyes", &TestReader::read_eyes},
                                  {"raster", &TestReader::read_raster},
                                  {"same_as", &TestReader::read_same_as}}) {
    if (const JsonId found = in.child(key); found != JsonId::None) {
      (this->*read)(found, test);
    }
  }
  for (const NameDecl& name : in.names("silent")) {
    Expectation expectation;
    expectation.kind = ExpectationKind::Silent;
    expectation.span = name.span;
    expectation.name_span = name.span;
    expectation.what = fmt::format("spikes of {}", name.text);
    expectation.population = name.text;
    expectation.bound.text = "none";
    test.expectations.push_back(std::move(expectation));
  }
  in.finish();
  std::stable_sort(test.expectations.begin(), test.expectations.end(),
                   [](const Expectation& a, const Expectation& b) { return a.span.begin < b.span.begin; });
  if (test.expectations.empty() && !diagnostics().has_errors()) {
    diagnostics().add(Code::EmptyList, node(id).span, {"`expect`"});
  }
}

}  // namespace tectum
