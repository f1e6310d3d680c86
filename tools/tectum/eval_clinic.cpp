#include "tools/tectum/eval_clinic.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "compiler/source/source_file.h"
#include "tools/evaluate/clinic.h"
#include "tools/evaluate/parallel_jobs.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

/// Is `name` a population, a side, a projection, or a pathway between two of the first two?
bool has(const Circuit& circuit, const std::string& name) {
  if (const std::size_t arrow = name.find("->"); arrow != std::string::npos) {
    return has(circuit, name.substr(0, arrow)) && has(circuit, name.substr(arrow + 2));
  }
  const auto is_it = [&](const auto& part) { return part.name == name; };
  return std::any_of(circuit.populations.begin(), circuit.populations.end(), is_it) ||
         std::any_of(circuit.instances.begin(), circuit.instances.end(), is_it) ||
         std::any_of(circuit.projections.begin(), circuit.projections.end(), is_it);
}

std::vector<std::string> those_there(const Circuit& circuit, const std::vector<std::string>& names) {
  std::vector<std::string> there;
  std::copy_if(names.begin(), names.end(), std::back_inserter(there),
               [&](const std::string& name) { return has(circuit, name); });
  return there;
}

struct Patient {
  std::vector<std::string> removed;
  SpikeImage image;
  ClinicTrial trial;
};

/// A circuit and all that is to be tried on it.
struct Ward {
  std::string circuit;
  std::vector<Patient> patients;                       // the whole circuit first
  std::vector<std::optional<std::size_t>> patient_of;  // for each lesion; nothing without the structure
};

std::optional<SpikeImage> compiled(const CircuitArguments& circuit, const std::vector<std::string>& restrained,
                                   const std::vector<std::string>& removed, double fraction, CommandContext& context) {
  CircuitArguments lesioned = circuit;
  lesioned.lesions.insert(lesioned.lesions.end(), restrained.begin(), restrained.end());
  for (const std::string& name : removed) {
    lesioned.lesions.push_back(fraction < 1 ? fmt::format("{}:{}", name, fraction) : name);
  }
  return load_circuit(lesioned, context, WarningPolicy::Quiet);
}

/// What of the circuit the lesion takes; empty when it has no such structure.
std::vector<std::string> taken_out(const Circuit& circuit, const ClinicLesion& lesion) {
  const auto own = lesion.in_circuit.find(circuit.name);
  if (own != lesion.in_circuit.end()) {
    return own->second;
  }
  return those_there(circuit, lesion.needs).empty() ? std::vector<std::string>{} : those_there(circuit, lesion.remove);
}

/// Compiles the circuit whole and with each lesion that it has the structure for.
std::optional<Ward> admit(const CircuitArguments& circuit, const ClinicPlan& plan, CommandContext& context) {
  const std::optional<Compilation> compilation = compile_file(circuit, compile_options(circuit), context);
  if (!compilation) {
    return std::nullopt;
  }
  if (!compilation->result.image) {
    print_diagnostics(*compilation, context);
    return std::nullopt;
  }
  const Circuit& parts = *compilation->result.circuit;
  const std::vector<std::string> restrained = those_there(parts, plan.restrain);
  Ward ward;
  ward.circuit = parts.name;
  const auto add = [&](std::vector<std::string> removed, double fraction) {
    std::optional<SpikeImage> image = compiled(circuit, restrained, removed, fraction, context);
    if (image) {
      ward.patients.push_back({std::move(removed), std::move(*image), {}});
    }
    return image.has_value();
  };
  if (!add({}, 1)) {
    return std::nullopt;
  }
  for (const ClinicLesion& lesion : plan.lesions) {
    std::vector<std::string> removed = taken_out(parts, lesion);
    if (removed.empty()) {
      ward.patient_of.emplace_back();
      continue;
    }
    if (!add(std::move(removed), lesion.fraction)) {
      return std::nullopt;
    }
    ward.patient_of.emplace_back(ward.patients.size() - 1);
  }
  return ward;
}

ClinicReport report_on(Ward& ward, const ClinicPlan& plan) {
  ClinicReport report;
  report.circuit = ward.circuit;
  report.whole = ward.patients.front().trial;
  report.measures = clinic_measures(report.whole, report.whole, plan);
  for (std::size_t k = 0; k < plan.lesions.size(); ++k) {
    ClinicResult& result = report.results.emplace_back();
    if (ward.patient_of[k]) {
      Patient& patient = ward.patients[*ward.patient_of[k]];
      result = judge(plan.lesions[k], std::move(patient.trial), report.whole, plan);
      result.removed = patient.removed;
    }
  }
  return report;
}

void write_page(const std::string& path, const std::string& html, CommandContext& context) {
  std::error_code ignored;
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) {
    std::filesystem::create_directories(parent, ignored);
  }
  std::ofstream file(path, std::ios::binary);
  file << html;
  if (file.flush()) {
    context.err << fmt::format("report: {}\n", path);
  } else {
    context.err << fmt::format("tectum: cannot write {}\n", path);
    context.exit_status = kExitTrouble;
  }
}

}  // namespace

void eval_clinic(const std::vector<CircuitArguments>& circuits, const Protocol& protocol,
                 const std::string& protocol_path, const std::string& report_path, unsigned threads,
                 CommandContext& context) {
  const ReadSource source = read_source(protocol_path);
  const ReadClinic read = read_clinic_text(protocol_path, source.file.bytes);
  context.err << read.problems;
  if (!read.plan) {
    context.exit_status = kExitFailed;
    return;
  }
  std::vector<Ward> wards;
  for (const CircuitArguments& circuit : circuits) {
    if (is_image_file(circuit.path)) {
      context.err << fmt::format(
          "tectum: {} is an image, and the clinic needs names to lesion: give the circuit file\n", circuit.path);
      context.exit_status = kExitUsage;
      return;
    }
    std::optional<Ward> ward = admit(circuit, *read.plan, context);
    if (!ward) {
      return;
    }
    wards.push_back(std::move(*ward));
  }
  Progress progress(context.err, "the clinic");
  std::vector<Job> jobs;
  for (Ward& ward : wards) {
    for (Patient& patient : ward.patients) {
      jobs.emplace_back([&](const std::function<void(double)>& done) {
        patient.trial = clinic_trial(patient.image, protocol, *read.plan, done);
      });
    }
  }
  run_jobs(jobs, threads, [&](double done) { progress.update(done); });
  std::vector<ClinicReport> reports;
  for (Ward& ward : wards) {
    reports.push_back(report_on(ward, *read.plan));
  }
  const bool is_json = circuits.front().format == "json";
  context.out << (is_json ? clinic_json(*read.plan, reports) + '\n' : clinic_text(*read.plan, reports));
  if (!report_path.empty()) {
    write_page(report_path, clinic_html(*read.plan, reports), context);
  }
}

}  // namespace tectum
