// The page of a comparison holds what was found, and needs nothing beside itself.
#include <doctest/doctest.h>

#include <string>

#include "tests/diff/edited_circuit.h"
#include "tools/diff/diff_report.h"

using namespace tectum;

namespace {

DiffSubject subject_of(const std::string& path, const std::string& text) {
  DiffSubject subject;
  subject.path = path;
  subject.view = compiled_view(text);
  subject.has_circuit = true;
  return subject;
}

bool holds(const std::string& page, const std::string& part) { return page.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a comparison's page names the edit, draws both circuits' eyes and spikes, and loads nothing") {
  const std::string text = small_eye_text();
  DiffSubject a = subject_of("first.json", text);
  DiffSubject b = subject_of("second.json", edited(text, R"("g": { "value": "0.9 nA")", R"("g": { "value": "0.7 nA")"));
  const StructureDiff structure = compare_structure(a, b);
  BehaviourOptions options;
  options.plan = {"a target that rests", false, {}, 0.4, 1};
  options.plan.head.scenario.kind = ScenarioKind::Hold;
  options.seeds = 2;
  const Behaviour behaviour = compare_subjects(a, b, structure, options);
  const std::string page = diff_report_html(a, b, structure, &behaviour, {.command_line = "tectum diff <a> <b>"});
  for (const char* part :
       {"first.json and second.json", "g is 0.7 nA instead of 0.9 nA", "seen_relay", "Where they part", "fixation RMSE",
        "Left eye, horizontal", "Spikes over each other", "The connectome", "tectum diff &lt;a&gt; &lt;b&gt;"}) {
    CAPTURE(part);
    CHECK(holds(page, part));
  }
  for (const char* part : {"src=", "href=", "@import"}) {
    CAPTURE(part);
    CHECK_FALSE(holds(page, part));
  }
}

TEST_CASE("the page of two circuits that are the same says so") {
  DiffSubject a = subject_of("first.json", small_eye_text()), b = subject_of("second.json", small_eye_text());
  const StructureDiff structure = compare_structure(a, b);
  const std::string page = diff_report_html(a, b, structure, nullptr, {});
  CHECK(holds(page, "the two circuits are the same"));
  CHECK_FALSE(holds(page, "Where they part"));
}
