#include "tools/sweep/sweep_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/sweep/row_file.h"
#include "tools/sweep/sweep_means.h"

namespace tectum {
namespace {

/// RFC 4180.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

std::string point_text(const std::vector<SweepAxis>& axes, const SweepPoint& point) {
  std::string text;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (axes[a].name != kSeedAxis) {
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", axes[a].name, axes[a].values[point[a]]);
    }
  }
  return text.empty() ? "this circuit" : text;
}

}  // namespace

std::string sweep_csv(const SweepPlan& plan, const SweepResult& result) {
  std::string text;
  for (const SweepAxis& axis : plan.axes) {
    text += csv_cell(axis.name) + ",";
  }
  for (const SweepMeasure& measure : kSweepMeasures) {
    text += std::string(measure.name) + (&measure == &kSweepMeasures.back() ? "\n" : ",");
  }
  for (std::size_t k = 0; k < result.points.size(); ++k) {
    for (std::size_t a = 0; a < plan.axes.size(); ++a) {
      text += csv_cell(plan.axes[a].values[result.points[k][a]]) + ",";
    }
    for (std::size_t m = 0; m < kSweepMeasures.size(); ++m) {
      text += cell_text(result.rows[k][m]) + (m + 1 == kSweepMeasures.size() ? "\n" : ",");
    }
  }
  return text;
}

std::string sweep_json(const SweepPlan& plan, const SweepResult& result) {
  nlohmann::ordered_json json;
  json["circuit"] = plan.circuit_path;
  json["protocol"] = plan.protocol.name;
  json["folder"] = plan.folder;
  json["runs"] = result.runs;
  json["kept"] = result.distinct - result.runs;
  json["rows"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < result.points.size(); ++k) {
    nlohmann::ordered_json row;
    for (std::size_t a = 0; a < plan.axes.size(); ++a) {
      row["at"][plan.axes[a].name] = plan.axes[a].values[result.points[k][a]];
    }
    for (std::size_t m = 0; m < kSweepMeasures.size(); ++m) {
      const std::optional<double>& value = result.rows[k][m];
      row[kSweepMeasures[m].name] = value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
    }
    json["rows"].push_back(std::move(row));
  }
  return json.dump(2);
}

std::vector<MeasureExtremes> extremes_of(const SweepPlan& plan, const SweepResult& result) {
  std::vector<std::size_t> without_seeds;
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    if (plan.axes[a].name != kSeedAxis) {
      without_seeds.push_back(a);
    }
  }
  std::vector<MeasureExtremes> found;
  for (const std::size_t m : kMainMeasures) {
    const std::vector<MeanOverRest> means = means_over_rest(plan, result, without_seeds, m);
    if (means.empty()) {
      continue;
    }
    const auto [least, most] = std::minmax_element(
        means.begin(), means.end(), [](const MeanOverRest& a, const MeanOverRest& b) { return a.mean < b.mean; });
    const auto text = [&](const MeanOverRest& mean) {
      return fmt::format("{:.{}f} at {}", mean.mean, kSweepMeasures[m].decimals, point_text(plan.axes, mean.point));
    };
    if (least->mean < most->mean) {
      found.push_back({kSweepMeasures[m].title, text(*least), text(*most)});
    } else {
      found.push_back(
          {kSweepMeasures[m].title, fmt::format("{:.{}f} everywhere", least->mean, kSweepMeasures[m].decimals), ""});
    }
  }
  return found;
}

std::string sweep_text(const SweepPlan& plan, const SweepResult& result) {
  std::string text;
  for (const MeasureExtremes& each : extremes_of(plan, result)) {
    text += each.most.empty() ? fmt::format("{}: {}\n", each.title, each.least)
                              : fmt::format("{}: least {}; most {}\n", each.title, each.least, each.most);
  }
  return text;
}

std::string shell_word(const std::string& word) {
  const char* const plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+%@";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
    return word;
  }
  std::string quoted = "'";
  for (const char c : word) {
    quoted += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return quoted + "'";
}

std::vector<std::string> task_commands(const SweepPlan& plan, const std::string& shared) {
  std::vector<std::string> tasks;
  for (const SweepPoint& point : points_of(plan.axes)) {
    std::string task = shared;
    for (std::size_t a = 0; a < plan.axes.size(); ++a) {
      task += " -p " + shell_word(plan.axes[a].name + "=" + plan.axes[a].values[point[a]]);
    }
    tasks.push_back(task + " --rows-only --threads 1");
  }
  return tasks;
}

std::string slurm_script(const std::vector<std::string>& tasks) {
  std::string text = fmt::format(
      "#!/bin/bash\n"
      "#SBATCH --job-name=tectum-sweep\n"
      "#SBATCH --array=0-{}\n"
      "#SBATCH --ntasks=1\n"
      "#SBATCH --cpus-per-task=1\n"
      "#SBATCH --mem=1G\n"
      "set -euo pipefail\n"
      "case \"$SLURM_ARRAY_TASK_ID\" in\n",
      tasks.size() - 1);
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    text += fmt::format("{}) {} ;;\n", k, tasks[k]);
  }
  return text + "*) echo \"no task $SLURM_ARRAY_TASK_ID\" >&2; exit 2 ;;\nesac\n";
}

}  // namespace tectum
