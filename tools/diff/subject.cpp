#include "tools/diff/subject.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <string_view>

#include "runtime/record/recording_file.h"
#include "tools/analysis/run_summary.h"
#include "tools/diff/load_view.h"
#include "tools/diff/open_loop_run.h"

namespace tectum {
namespace {

bool looks_like_recording(const std::string& path) {
  constexpr std::string_view kMagic = "TECTREC\n";  // runtime/record/recording_file.h
  std::array<char, kMagic.size()> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  return file.gcount() == static_cast<std::streamsize>(head.size()) &&
         std::string_view(head.data(), head.size()) == kMagic;
}

/// Names and sizes, which a recording has even without its image.
CircuitView view_of_populations(const std::string& path, const Recording& recording) {
  CircuitView view;
  view.path = path;
  view.image.header.tick_ns = recording.tick_ns;
  for (const RecordedPopulation& recorded : recording.populations) {
    PopulationView population;
    population.name = recorded.name;
    population.nucleus = recorded.nucleus;
    population.first_neuron = recorded.first_neuron;
    population.size = recorded.size;
    view.populations.push_back(std::move(population));
    view.image.header.neuron_count = std::max(view.image.header.neuron_count, recorded.first_neuron + recorded.size);
  }
  return view;
}

DiffSubject load_recording(const std::string& path) {
  DiffSubject subject;
  ReadRecording read = read_recording(path);
  if (!read.error.empty()) {
    subject.error = "tectum: " + read.error + "\n";
    return subject;
  }
  if (read.is_truncated) {
    subject.notice = path + ": " + read.ending + "\n";
  }
  if (read.recording.image.empty()) {
    subject.view = view_of_populations(path, read.recording);
  } else {
    const LoadedImage image = load_image(read.recording.image);
    if (!image.image) {
      subject.error = fmt::format("tectum: {}: the circuit in it: {}\n", path, image.error);
      return subject;
    }
    subject.view = view_of_image(path, *image.image);
    subject.has_circuit = true;
  }
  subject.recording = std::move(read.recording);
  return subject;
}

/// The other one's fields, through the circuit's own retinas where those are the same.
Recording driven_by(const CircuitView& view, const CircuitView& seen_by, const Recording& input) {
  const LitNeurons lit = PictureTap(seen_by.image, view.image).lit_neurons(input);
  OpenLoopRun run(view.image, input, lit);
  for (std::size_t k = 0; k < input.frames.size(); ++k) {
    run.run_frame(k);
  }
  return std::move(run.recording());
}

/// With the target, as of a battery; without, what the eyes alone say.
std::vector<PairedFigure> recorded_figures(const Recording& a, const Recording& b) {
  std::vector<PairedFigure> figures;
  if (has_truth(a) && has_truth(b)) {
    add_kinematics({a, b, parts_of(a)}, figures);
    return figures;
  }
  const RunSummary x = summarize_run(a), y = summarize_run(b);
  const auto add = [&](const char* name, const char* unit, auto value) {
    const auto over_eyes = [&](const RunSummary& run) { return (value(run.saccades[0]) + value(run.saccades[1])) / 2; };
    figures.push_back({name, unit, {over_eyes(x)}, {over_eyes(y)}});
  };
  add("saccades", "", [](const EyeSaccades& eye) { return static_cast<double>(eye.saccades.size()); });
  add("saccade amplitude", "deg", [](const EyeSaccades& eye) { return eye.median_amplitude_deg; });
  add("peak velocity", "deg/s", [](const EyeSaccades& eye) { return eye.median_peak_velocity_deg_s; });
  return figures;
}

}  // namespace

DiffSubject load_subject(const std::string& path) {
  if (looks_like_recording(path)) {
    DiffSubject subject = load_recording(path);
    subject.path = path;
    return subject;
  }
  LoadedView loaded = load_view(path);
  DiffSubject subject;
  subject.path = path;
  subject.view = std::move(loaded.view);
  subject.error = std::move(loaded.error);
  subject.has_circuit = true;
  return subject;
}

StructureDiff compare_structure(DiffSubject& a, DiffSubject& b) {
  if (a.view.has_projections != b.view.has_projections) {
    forget_projections(a.view);
    forget_projections(b.view);
  }
  StructureDiff structure = diff_structure(a.view, b.view);
  if (!a.has_circuit || !b.has_circuit) {
    structure.changes.clear();
    structure.match.pathways.clear();
  }
  return structure;
}

Behaviour compare_subjects(const DiffSubject& a, const DiffSubject& b, const StructureDiff& structure,
                           const BehaviourOptions& options) {
  if (!a.recording && !b.recording) {
    return compare_behaviour(a.view, b.view, structure, options);
  }
  Behaviour behaviour;
  behaviour.is_closed_loop = false;
  const bool both = a.recording && b.recording;
  if (both) {
    behaviour.what = "as recorded";
    behaviour.kinematics = recorded_figures(*a.recording, *b.recording);
  } else {
    behaviour.what =
        fmt::format("{} driven by the input of {}", (a.recording ? b : a).path, (a.recording ? a : b).path);
  }
  behaviour.first_a = a.recording ? *a.recording : driven_by(a.view, b.view, *b.recording);
  behaviour.first_b = b.recording ? *b.recording : driven_by(b.view, a.view, *a.recording);
  behaviour.first_parts = parts_of(behaviour.first_a);
  behaviour.populations =
      compare_spikes({{behaviour.first_a, behaviour.first_b, behaviour.first_parts}}, structure.match.population_of_b);
  behaviour.divergence = find_divergence({a.view, b.view, structure, behaviour.first_a, behaviour.first_b, {}});
  behaviour.divergence.is_driven = !both;
  const bool same_commands =
      std::equal(behaviour.first_a.frames.begin(), behaviour.first_a.frames.end(), behaviour.first_b.frames.begin(),
                 behaviour.first_b.frames.end(), [](const RecordedFrame& x, const RecordedFrame& y) {
                   return x.decoded_deg == y.decoded_deg && x.goal_deg == y.goal_deg;
                 });
  behaviour.is_same = behaviour.populations.empty() && same_commands;
  return behaviour;
}

}  // namespace tectum
