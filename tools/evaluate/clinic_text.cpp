// The clinic's results as a table for people and JSON for programs.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/evaluate/clinic_words.h"

namespace tectum {
namespace {

/// A measure's value with its unit, which its name implies.
std::string measured(const std::string& measure, double value) {
  if (measure.find(".peak_velocity") != std::string::npos) {
    return fmt::format("{:.0f} deg/s", value);
  }
  if (measure.find(".saccades") != std::string::npos || measure.ends_with(".lost")) {
    return fmt::format("{:.2f}", value);
  }
  return fmt::format("{:.{}f}{}", value, measure.ends_with(".ripple") ? 2 : 1,
                     measure.ends_with(".drift_time") ? " s" : "°");
}

std::string finding_lines(const FindingResult& finding) {
  std::string text = fmt::format("          {:<4}{}\n", finding.is_there ? "yes" : "NO", finding.says);
  for (const Observation& seen : finding.observed) {
    text += fmt::format("                {}\n", observation_text(seen));
  }
  return text;
}

/// A line a lesion and a column a circuit.
std::string overview(const ClinicPlan& plan, const std::vector<ClinicReport>& reports) {
  std::size_t name_width = 0;
  for (const ClinicLesion& lesion : plan.lesions) {
    name_width = std::max(name_width, lesion.name.size());
  }
  std::string text = fmt::format("{:<{}}", "", name_width);
  for (const ClinicReport& report : reports) {
    text += fmt::format("  {:<{}}", report.circuit, std::max<std::size_t>(11, report.circuit.size()));
  }
  text.erase(text.find_last_not_of(' ') + 1);
  text += '\n';
  for (std::size_t k = 0; k < plan.lesions.size(); ++k) {
    std::string line = fmt::format("{:<{}}", plan.lesions[k].name, name_width);
    for (const ClinicReport& report : reports) {
      line += fmt::format("  {:<{}}", verdict_text(report.results[k].verdict),
                          std::max<std::size_t>(11, report.circuit.size()));
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text + '\n';
}

std::string circuit_text(const ClinicPlan& plan, const ClinicReport& report) {
  std::string text = fmt::format("clinic: {}\n\n", report.circuit);
  for (std::size_t k = 0; k < plan.lesions.size(); ++k) {
    const ClinicLesion& lesion = plan.lesions[k];
    const ClinicResult& result = report.results[k];
    if (result.verdict == ClinicVerdict::NoStructure) {
      text += fmt::format("-       {}: not present\n\n", lesion.name);
      continue;
    }
    text += fmt::format("{:<8}{}: {}\n", verdict_text(result.verdict), lesion.name, lesion.sign);
    text += fmt::format("          out {}\n", removed_text(lesion, result));
    for (const FindingResult& finding : result.findings) {
      text += finding_lines(finding);
    }
    text += fmt::format("          {}\n\n", source_text(lesion));
  }
  return text + tally_text(report) + '\n';
}

nlohmann::ordered_json circuit_json(const ClinicPlan& plan, const ClinicReport& report) {
  const ClinicTally tally = tally_of(report);
  nlohmann::ordered_json json{{"protocol", "clinic"},
                              {"circuit", report.circuit},
                              {"shown", tally.shown},
                              {"tried", tally.tried},
                              {"signs_of_the_whole", tally.of_whole},
                              {"whole", report.measures}};
  json["lesions"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < plan.lesions.size(); ++k) {
    const ClinicLesion& lesion = plan.lesions[k];
    const ClinicResult& result = report.results[k];
    nlohmann::ordered_json row{
        {"lesion", lesion.name}, {"sign", lesion.sign}, {"source", lesion.source}, {"doi", lesion.doi}};
    row["has_structure"] = result.verdict != ClinicVerdict::NoStructure;
    row["shows"] = result.verdict == ClinicVerdict::Shows;
    row["whole_shows"] = row["has_structure"] && result.is_shown_by_the_whole();
    row["removed"] = result.removed;
    row["findings"] = nlohmann::ordered_json::array();
    for (const FindingResult& finding : result.findings) {
      nlohmann::ordered_json seen = nlohmann::ordered_json::array();
      for (const Observation& each : finding.observed) {
        seen.push_back({{"measure", each.condition.measure},
                        {"lesioned", each.lesioned},
                        {"whole", each.whole},
                        {each.condition.is_above ? "above" : "below", each.bound}});
      }
      row["findings"].push_back({{"says", finding.says}, {"is_there", finding.is_there}, {"any_of", std::move(seen)}});
    }
    row["measures"] = result.measures;
    json["lesions"].push_back(std::move(row));
  }
  return json;
}

}  // namespace

ClinicTally tally_of(const ClinicReport& report) {
  ClinicTally tally;
  for (const ClinicResult& result : report.results) {
    if (result.verdict != ClinicVerdict::NoStructure) {
      ++tally.tried;
      tally.shown += result.verdict == ClinicVerdict::Shows ? 1U : 0U;
      tally.of_whole += result.is_shown_by_the_whole() ? 1U : 0U;
    }
  }
  return tally;
}

std::string verdict_text(ClinicVerdict verdict) {
  switch (verdict) {
    case ClinicVerdict::Shows:
      return "shows";
    case ClinicVerdict::Misses:
      return "MISSES";
    case ClinicVerdict::NoStructure:
      return "not present";
  }
  return "";
}

std::string tally_text(const ClinicReport& report) {
  const ClinicTally tally = tally_of(report);
  return fmt::format("{} of {} lesions show their sign; the whole circuit shows {} of the signs", tally.shown,
                     tally.tried, tally.of_whole == 0 ? "none" : std::to_string(tally.of_whole));
}

std::string observation_text(const Observation& seen) {
  const std::string& measure = seen.condition.measure;
  return fmt::format("{} {} (whole {}, asked: {} {})", measure, measured(measure, seen.lesioned),
                     measured(measure, seen.whole), seen.condition.is_above ? "over" : "under",
                     measured(measure, seen.bound));
}

std::string source_text(const ClinicLesion& lesion) {
  return lesion.source + (lesion.doi.empty() ? "" : ", doi:" + lesion.doi);
}

std::string removed_text(const ClinicLesion& lesion, const ClinicResult& result) {
  return fmt::format("{}{}", fmt::join(result.removed, ", "),
                     lesion.fraction < 1 ? fmt::format(", {:.0f} % of it", 100 * lesion.fraction) : "");
}

std::string clinic_text(const ClinicPlan& plan, const std::vector<ClinicReport>& reports) {
  std::string text = reports.size() > 1 ? overview(plan, reports) : "";
  for (const ClinicReport& report : reports) {
    text += (&report == reports.data() ? "" : "\n") + circuit_text(plan, report);
  }
  return text;
}

std::string clinic_json(const ClinicPlan& plan, const std::vector<ClinicReport>& reports) {
  if (reports.size() == 1) {
    return circuit_json(plan, reports.front()).dump(2);
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const ClinicReport& report : reports) {
    all.push_back(circuit_json(plan, report));
  }
  return all.dump(2);
}

}  // namespace tectum
