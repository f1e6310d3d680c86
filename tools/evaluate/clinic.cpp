// Whether a lesion's findings are there.
#include "tools/evaluate/clinic.h"

#include <algorithm>
#include <utility>

namespace tectum {
namespace {

bool is_met(const ClinicCondition& condition, double value, double bound) {
  return condition.is_above ? value > bound : value < bound;
}

Observation observe(const ClinicCondition& condition, const Measures& lesioned, const Measures& whole) {
  const auto mine = lesioned.find(condition.measure);
  const auto theirs = whole.find(condition.measure);
  if (mine == lesioned.end() || theirs == whole.end()) {
    return {condition};  // read_clinic_text() lets no unknown measure pass
  }
  const double bound = condition.is_ratio ? condition.bound * theirs->second : condition.bound;
  return {condition, mine->second, theirs->second, bound, is_met(condition, mine->second, bound)};
}

}  // namespace

bool ClinicResult::is_shown_by_the_whole() const {
  return std::all_of(findings.begin(), findings.end(),
                     [](const FindingResult& finding) { return finding.is_there_when_whole; });
}

ClinicResult judge(const ClinicLesion& lesion, ClinicTrial trial, const ClinicTrial& whole, const ClinicPlan& plan) {
  ClinicResult result;
  const Measures intact = clinic_measures(whole, whole, plan);
  result.measures = clinic_measures(trial, whole, plan);
  result.trial = std::move(trial);
  bool shows = true;
  for (const ClinicFinding& finding : lesion.findings) {
    FindingResult& found = result.findings.emplace_back();
    found.says = finding.says;
    for (const ClinicCondition& condition : finding.any) {
      const Observation seen = observe(condition, result.measures, intact);
      found.is_there = found.is_there || seen.holds;
      found.is_there_when_whole = found.is_there_when_whole || is_met(condition, seen.whole, seen.bound);
      found.observed.push_back(seen);
    }
    shows = shows && found.is_there;
  }
  result.verdict = shows && !result.is_shown_by_the_whole() ? ClinicVerdict::Shows : ClinicVerdict::Misses;
  return result;
}

}  // namespace tectum
