#include "tools/report/run_report.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/report/synthetic_recording.h"
#include "tests/report/well_formed.h"
#include "tools/report/run_text.h"
#include "tools/report/svg.h"

namespace tectum {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) {
    ++found;
  }
  return found;
}

/// Nothing that a browser would fetch.
void check_self_contained(const std::string& page) {
  CHECK(count(page, "http://") == count(page, "xmlns=\"http://www.w3.org/2000/svg\""));
  CHECK(count(page, "https://") == count(page, "https://doi.org/"));
  CHECK(count(page, " src=") == 0);
  CHECK(count(page, "@import") == 0);
  CHECK(count(page, "url(") == 0);
  CHECK(count(page, "<link") == 0);
}

TEST_CASE("the markup checker sees what it is there to see") {
  CHECK(first_markup_error("<a b=\"x > y\"><c/>&amp;</a>").empty());
  CHECK_FALSE(first_markup_error("<a><b></a></b>").empty());
  CHECK_FALSE(first_markup_error("<a>").empty());
  CHECK_FALSE(first_markup_error("<a>x & y</a>").empty());
  CHECK_FALSE(first_markup_error("<a <b/>").empty());
}

TEST_CASE("a report is well-formed, needs no network and holds every section") {
  RunReportOptions options;
  options.command_line = "tectum run \"a & b.json\" <x>";
  options.times_real_time = 31;
  options.notes = {"a note"};
  const std::string page = run_report_html(synthetic_recording({20, 3, true}), options);
  CHECK(first_markup_error(page) == "");
  check_self_contained(page);
  for (const char* section : {"Target, eyes and neck", "Error", "Path on the wall", "Main sequence", "Latency",
                              "left eye pan", "neck tilt", "Raster", "EBN.left", "RMSE", "a &amp; b.json", "a note"}) {
    CAPTURE(section);
    CHECK(count(page, section) > 0);
  }
}

TEST_CASE("the page's numbers are those of the summary") {
  const Recording recording = synthetic_recording({20, 3, true});
  const RunSummary summary = summarize_run(recording);
  const std::string page = run_report_html(recording);
  for (const EyeMetrics& eye : summary.tracking.eye) {
    CHECK(count(page, "<td>" + number_text(eye.pan.all.rmse_deg, 2) + "°</td>") > 0);
    CHECK(count(page, "<td>" + number_text(eye.tilt.all.p90_abs_deg, 2) + "°</td>") > 0);
  }
  CHECK(count(page, count_text(recording.spikes.size())) > 0);
}

TEST_CASE("a run without truth shows what the eyes saw and claims no error") {
  const std::string page = run_report_html(synthetic_recording({10, 2, false}));
  CHECK(first_markup_error(page) == "");
  CHECK(count(page, "What the eyes saw") == 1);
  CHECK(count(page, "RMSE") == 0);
  CHECK(count(page, "Path on the wall") == 0);
}

TEST_CASE("recordings of no frame and of one frame give a page and a picture") {
  Recording one = synthetic_recording({1, 1, true});
  one.frames.resize(1);
  Recording bare;
  bare.frames.resize(1);
  for (const Recording& recording : {Recording{}, one, bare}) {
    CHECK(first_markup_error(run_report_html(recording)) == "");
    CHECK(first_markup_error(tracking_svg(recording)) == "");
    CHECK_FALSE(run_table_text(summarize_run(recording)).empty());
  }
}

TEST_CASE("names from a file cannot break out of the page") {
  Recording recording = synthetic_recording({2, 1, true});
  recording.circuit_name = "</title><script>alert(1)</script>";
  recording.populations[3].name = "<b>&\"'\x01";
  recording.populations[3].nucleus = "a\"><svg onload=x>";
  const std::string page = run_report_html(recording);
  CHECK(first_markup_error(page) == "");
  CHECK(count(page, "<script>alert") == 0);
  CHECK(count(page, "<svg onload") == 0);
}

TEST_CASE("a long, busy run stays light enough to open") {
  const Recording recording = synthetic_recording({120, 5, true});
  REQUIRE(recording.spikes.size() > 500'000);
  CHECK(run_report_html(recording).size() < 4'000'000);
  CHECK(tracking_svg(recording).size() < 1'000'000);
}

TEST_CASE("the picture stands alone, with its colours written out") {
  const std::string svg = tracking_svg(synthetic_recording({20, 3, true}));
  CHECK(first_markup_error(svg) == "");
  check_self_contained(svg);
  CHECK(count(svg, "var(--") == 0);
  CHECK(count(svg, "#0072b2") > 0);
}

TEST_CASE("the same recording gives the same bytes") {
  const Recording recording = synthetic_recording({5, 3, true});
  CHECK(run_report_html(recording) == run_report_html(recording));
  CHECK(tracking_svg(recording) == tracking_svg(recording));
}

TEST_CASE("the terminal table has a row for each eye and axis, all columns aligned") {
  const std::string table = run_table_text(summarize_run(synthetic_recording({20, 3, true})));
  CHECK(count(table, "\nleft   horizontal") == 1);
  CHECK(count(table, "\nright  vertical") == 1);
  CHECK(table.find("neck travel") != std::string::npos);
  const std::size_t header = table.find('\n');
  const std::size_t row = table.find("\nleft   horizontal") + 1;
  CHECK(table.find('\n', row) - row == header);
}

TEST_CASE("the JSON summary parses and agrees with the metrics") {
  const Recording recording = synthetic_recording({10, 3, true});
  const RunSummary summary = summarize_run(recording);
  const nlohmann::json json = nlohmann::json::parse(run_summary_json(recording, summary));
  CHECK(json["eyes"]["left"]["horizontal"]["all"]["rmse_deg"].get<double>() ==
        doctest::Approx(summary.tracking.eye[0].pan.all.rmse_deg));
  CHECK(json["eyes"]["right"]["saccades"]["count"] == summary.saccades[1].saccades.size());
  CHECK(json["populations"].size() == recording.populations.size());
}

TEST_CASE("a name that is not UTF-8 does not stop the JSON summary") {
  Recording recording = synthetic_recording({1, 1, true});
  recording.populations[0].name = "\xff\xfe";
  CHECK_FALSE(nlohmann::json::parse(run_summary_json(recording, summarize_run(recording))).is_discarded());
}

}  // namespace
}  // namespace tectum
