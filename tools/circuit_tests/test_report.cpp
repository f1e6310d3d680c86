#include "tools/circuit_tests/test_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/report/svg.h"

namespace tectum {
namespace {

struct Place {
  std::string path;
  Position at;
};

Place place_of(const TestFile& file, const Span& span) {
  const SourceFile& source = file.sources.file(span.file);
  return {source.name, position_of(source.bytes, span.begin)};
}

/// The line with the span underlined, as diagnostics show it.
std::string excerpt(const TestFile& file, const Span& span) {
  const SourceFile& source = file.sources.file(span.file);
  const Position begin = position_of(source.bytes, span.begin);
  const Position end = position_of(source.bytes, span.end);
  const std::string number = std::to_string(begin.line);
  const std::size_t width = end.line == begin.line && end.column > begin.column ? end.column - begin.column : 1;
  return fmt::format("        {} | {}\n        {} | {}{}\n", number, line_around(source.bytes, span.begin),
                     std::string(number.size(), ' '), std::string(begin.column - 1, ' '), std::string(width, '^'));
}

/// " (seed 3; 2 of 5 seeds miss)"; a golden raster is one seed's.
std::string seeds_text(const CircuitTest& test, const Expectation& expectation, const ExpectationResult& result) {
  if (result.seeds.size() <= 1 || expectation.kind == ExpectationKind::Raster) {
    return "";
  }
  if (test.seeds.quantifier == Quantifier::Mean) {
    return fmt::format(" (mean of {} seeds)", result.seeds.size());
  }
  const auto failed =
      std::count_if(result.seeds.begin(), result.seeds.end(), [](const SeedOutcome& seed) { return !seed.passes; });
  return fmt::format(" (seed {}; {} of {} seeds miss{})", result.shown_seed, failed, result.seeds.size(),
                     test.seeds.quantifier == Quantifier::Most ? ", most have to hold" : "");
}

std::string failure_text(const TestFile& file, const CircuitTest& test, const Expectation& expectation,
                         const ExpectationResult& result) {
  const Place place = place_of(file, expectation.span);
  std::string text = fmt::format("      {}:{}:{}: {}\n", place.path, place.at.line, place.at.column, expectation.what);
  text += excerpt(file, expectation.span);
  const bool is_bound = expectation.kind != ExpectationKind::Raster && !expectation.bound.text.empty();
  text += is_bound ? fmt::format("        expected {}, seen {}{}\n", expectation.bound.text, result.seen,
                                 seeds_text(test, expectation, result))
                   : fmt::format("        {}{}\n", result.seen, seeds_text(test, expectation, result));
  return text;
}

const char* word_of(TestStatus status) {
  return status == TestStatus::Passed ? "pass" : status == TestStatus::Failed ? "FAIL" : "BROKEN";
}

std::string indented(const std::string& text, const std::string& by) {
  std::string out;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    out += by + text.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return out;
}

std::uint64_t seed_to_look_at(const TestResult& test) {
  for (const ExpectationResult& result : test.expectations) {
    if (!result.passes) {
      return result.shown_seed;
    }
  }
  return test.test->seeds.values.front();
}

std::string test_block(const FileResult& file, const TestResult& test) {
  std::string text = fmt::format("  {:<6}  {:<64} {:>6.1f} s\n", word_of(test.status), test.test->name, test.seconds);
  text += indented(test.problem, "      ");
  for (std::size_t e = 0; e < test.expectations.size(); ++e) {
    if (!test.expectations[e].passes) {
      text += failure_text(*file.file, *test.test, test.test->expectations[e], test.expectations[e]);
    }
  }
  if (test.status == TestStatus::Failed) {
    text += fmt::format("      look: {}\n", look_command(*test.test, seed_to_look_at(test)));
  }
  return text;
}

}  // namespace

TestTotals totals_of(const std::vector<FileResult>& files) {
  TestTotals totals;
  for (const FileResult& file : files) {
    totals.is_trouble = totals.is_trouble || file.is_unreadable || !file.problem.empty();
    for (const TestResult& test : file.tests) {
      totals.passed += test.status == TestStatus::Passed ? 1U : 0U;
      totals.failed += test.status == TestStatus::Failed ? 1U : 0U;
      totals.broken += test.status == TestStatus::Broken ? 1U : 0U;
    }
  }
  return totals;
}

std::string test_text(const std::vector<FileResult>& files, double seconds) {
  std::string text;
  for (const FileResult& file : files) {
    if (file.tests.empty() && file.problem.empty() && file.notes.empty()) {
      continue;
    }
    text += file.file->path + "\n" + indented(file.problem, "  ");
    for (const TestResult& test : file.tests) {
      text += test_block(file, test);
    }
    for (const std::string& note : file.notes) {
      text += fmt::format("  golden {}\n", note);
    }
  }
  const TestTotals totals = totals_of(files);
  text += fmt::format("{}{} of {} test{} pass", text.empty() ? "" : "\n", totals.passed, totals.all(),
                      totals.all() == 1 ? "" : "s");
  text += totals.failed > 0 ? fmt::format(", {} fail", totals.failed) : "";
  text += totals.broken > 0 ? fmt::format(", {} cannot run", totals.broken) : "";
  return text + fmt::format(" ({:.1f} s)\n", seconds);
}

std::string test_json(const std::vector<FileResult>& files) {
  using Json = nlohmann::ordered_json;
  Json all;
  all["files"] = Json::array();
  for (const FileResult& file : files) {
    Json in_file = {{"path", file.file->path}};
    if (!file.problem.empty()) {
      in_file["problem"] = file.problem;
    }
    if (!file.notes.empty()) {
      in_file["goldens"] = file.notes;
    }
    in_file["tests"] = Json::array();
    for (const TestResult& test : file.tests) {
      Json one = {{"name", test.test->name}, {"status", word_of(test.status)}};
      std::transform(one["status"].get_ref<std::string&>().begin(), one["status"].get_ref<std::string&>().end(),
                     one["status"].get_ref<std::string&>().begin(), [](unsigned char c) { return std::tolower(c); });
      one["seconds"] = test.seconds;
      if (!test.problem.empty()) {
        one["problem"] = test.problem;
      }
      one["look"] = look_command(*test.test, seed_to_look_at(test));
      one["expectations"] = Json::array();
      for (std::size_t e = 0; e < test.expectations.size(); ++e) {
        const Expectation& expectation = test.test->expectations[e];
        const Place place = place_of(*file.file, expectation.span);
        Json result = {{"what", expectation.what},          {"line", place.at.line},
                       {"column", place.at.column},         {"expected", expectation.bound.text},
                       {"seen", test.expectations[e].seen}, {"passes", test.expectations[e].passes}};
        result["seeds"] = Json::array();
        for (const SeedOutcome& seed : test.expectations[e].seeds) {
          result["seeds"].push_back({{"seed", seed.seed}, {"seen", seed.seen}, {"passes", seed.passes}});
        }
        one["expectations"].push_back(std::move(result));
      }
      in_file["tests"].push_back(std::move(one));
    }
    all["files"].push_back(std::move(in_file));
  }
  const TestTotals totals = totals_of(files);
  all["passed"] = totals.passed;
  all["failed"] = totals.failed;
  all["broken"] = totals.broken;
  return all.dump(2);
}

std::string junit_xml(const std::vector<FileResult>& files) {
  const TestTotals totals = totals_of(files);
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites tests=\"{}\" failures=\"{}\" errors=\"{}\">\n",
      totals.all(), totals.failed, totals.broken);
  for (const FileResult& file : files) {
    const TestTotals of_file = totals_of({file});
    const bool is_unread = !file.problem.empty();
    text += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\">\n",
                        xml_escape(file.file->path), of_file.all() + (is_unread ? 1 : 0), of_file.failed,
                        of_file.broken + (is_unread ? 1 : 0));
    if (is_unread) {
      text += fmt::format("    <testcase name=\"the file\"><error message=\"cannot be read\">{}</error></testcase>\n",
                          xml_escape(file.problem));
    }
    for (const TestResult& test : file.tests) {
      text += fmt::format("    <testcase name=\"{}\" classname=\"{}\" time=\"{:.3f}\"", xml_escape(test.test->name),
                          xml_escape(file.file->path), test.seconds);
      if (test.status == TestStatus::Passed) {
        text += "/>\n";
        continue;
      }
      const char* const kind = test.status == TestStatus::Failed ? "failure" : "error";
      const auto first = std::find_if(test.expectations.begin(), test.expectations.end(),
                                      [](const ExpectationResult& result) { return !result.passes; });
      const std::string message =
          first == test.expectations.end()
              ? "cannot run"
              : test.test->expectations[static_cast<std::size_t>(first - test.expectations.begin())].what + ": " +
                    first->seen;
      text += fmt::format("><{} message=\"{}\">{}</{}></testcase>\n", kind, xml_escape(message),
                          xml_escape(test_block(file, test)), kind);
    }
    text += "  </testsuite>\n";
  }
  return text + "</testsuites>\n";
}

}  // namespace tectum
