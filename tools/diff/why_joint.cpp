#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "tools/diff/picture_tap.h"
#include "tools/diff/why.h"

namespace tectum {
namespace {

constexpr double kMovingDegS = 8;  // slower is drift
constexpr double kLeastMovementDeg = 0.75;
constexpr double kLongestMovementS = 0.4;
constexpr double kBaselineS = 0.04;  // before the movement
constexpr double kBinS = 0.01;
constexpr double kReachS = 0.08;  // how long before its effect a cause is looked for
constexpr std::size_t kMostHops = 8;
constexpr std::size_t kSampled = 4;  // neurons of a population whose input is added up

class JointFinder {
 public:
  JointFinder(const RecordedCircuit& run, Joint joint)
      : run_(run),
        view_(run.view),
        joint_(static_cast<std::size_t>(joint)),
        spikes_(spike_ticks(run.recording.spikes, run.view.image.header.neuron_count)) {}

  std::optional<JointWhy> run(double at_s) {
    const auto& frames = run_.recording.frames;
    std::size_t at = 0;
    while (at + 1 < frames.size() && time_s(at + 1) <= at_s) {
      ++at;
    }
    const OutputView* output = strongest_output();
    if (frames.empty() || output == nullptr) {
      return std::nullopt;
    }
    why_.joint = kJointNames[joint_];
    why_.output = output->name;
    // The command of a frame rests on the ticks up to the next one.
    why_.time_s = time_s(at);
    why_.goal_deg = frames[at].goal_deg[joint_];
    find_movement(at);
    const double end_s = time_s(at) + period_s();
    const double begin_s = why_.is_moving ? why_.begin_s : end_s - kReachS;
    const PopulationChange first = terms(*output, begin_s, end_s);
    if (why_.is_moving) {
      follow(first, begin_s, end_s);
    }
    return std::move(why_);
  }

 private:
  struct PopulationChange {
    std::uint32_t population = 0;
    double direction = 1;  // +1: that it fires more is what counts
  };

  [[nodiscard]] double period_s() const { return static_cast<double>(run_.recording.frame_period_ns) * 1e-9; }
  [[nodiscard]] double time_s(std::size_t frame) const {
    return static_cast<double>(run_.recording.frames[frame].time_ns) * 1e-9;
  }
  [[nodiscard]] double goal(std::size_t frame) const { return run_.recording.frames[frame].goal_deg[joint_]; }

  [[nodiscard]] const OutputView* strongest_output() const {
    const OutputView* found = nullptr;
    for (const OutputView& output : view_.outputs) {
      if ((output.joint_mask >> joint_ & 1U) != 0 && (found == nullptr || output.terms.size() > found->terms.size())) {
        found = &output;
      }
    }
    return found;
  }

  /// Backwards from the frame while the joint goes on in the same direction.
  void find_movement(std::size_t at) {
    std::size_t begin = at;
    const double now = at > 0 ? goal(at) - goal(at - 1) : 0;
    const double least = kMovingDegS * period_s();
    why_.is_moving = std::abs(now) >= least;
    while (why_.is_moving && begin > 0 && time_s(at) - time_s(begin) < kLongestMovementS) {
      const double step = goal(begin) - goal(begin - 1);
      if (step * now <= 0 || std::abs(step) < least) {
        break;
      }
      --begin;
    }
    why_.is_moving = why_.is_moving && std::abs(goal(at) - goal(begin)) >= kLeastMovementDeg;
    why_.begin_s = time_s(begin);
    why_.begin_deg = goal(begin);
    if (!why_.is_moving) {
      why_.nearest_movement_s = nearest_movement(at);
    }
  }

  /// A frame in which the joint makes a good part of a movement.
  [[nodiscard]] std::optional<double> nearest_movement(std::size_t at) const {
    std::optional<double> found;
    for (std::size_t frame = 1; frame < run_.recording.frames.size(); ++frame) {
      const bool is_nearer = !found || std::abs(time_s(frame) - time_s(at)) < std::abs(*found - time_s(at));
      if (is_nearer && std::abs(goal(frame) - goal(frame - 1)) >= kLeastMovementDeg) {
        found = time_s(frame);
      }
    }
    return found;
  }

  [[nodiscard]] std::size_t count(std::uint32_t population, double begin_s, double end_s) const {
    const PopulationView& p = view_.populations[population];
    const double tick_s = view_.tick_ms() * 1e-3;
    const auto first = static_cast<std::uint32_t>(std::llround(std::max(0.0, begin_s) / tick_s));
    const auto last = static_cast<std::uint32_t>(std::llround(std::max(0.0, end_s) / tick_s));
    std::size_t spikes = 0;
    for (std::uint32_t i = 0; i < p.size; ++i) {
      const auto& own = spikes_[p.first_neuron + i];
      spikes += static_cast<std::size_t>(std::lower_bound(own.begin(), own.end(), last) -
                                         std::lower_bound(own.begin(), own.end(), first));
    }
    return spikes;
  }
  [[nodiscard]] double rate_hz(std::uint32_t population, double begin_s, double end_s) const {
    const double from_s = std::max(0.0, begin_s);
    return end_s <= from_s ? 0
                           : static_cast<double>(count(population, from_s, end_s)) /
                                 view_.populations[population].size / (end_s - from_s);
  }

  /// The rates that the decoder sees, and the term that moves the joint most.
  PopulationChange terms(const OutputView& output, double begin_s, double end_s) {
    PopulationChange largest;
    double most = -1;
    const double window_s = output.window_ms * 1e-3;
    for (const OutputView::Term& term : output.terms) {
      OutputShare share{view_.populations[term.population].name, rate_hz(term.population, end_s - window_s, end_s),
                        rate_hz(term.population, begin_s - window_s, begin_s), term.gain,
                        output.kind == OutputKind::Position ? "deg/Hz" : "deg/s/Hz"};
      const double moved = term.gain * (share.rate_hz - share.rate_before_hz);
      if (std::abs(moved) > most) {
        most = std::abs(moved);
        largest = {term.population, share.rate_hz >= share.rate_before_hz ? 1.0 : -1.0};
      }
      why_.terms.push_back(std::move(share));
    }
    return largest;
  }

  /// The 10 ms in which a population's rate is farthest from its baseline, in the direction that counts.
  [[nodiscard]] double busiest_s(const PopulationChange& change, double begin_s, double end_s,
                                 double baseline_hz) const {
    double best = 0, best_s = end_s;
    for (double bin_s = end_s; bin_s - kBinS >= begin_s - kReachS; bin_s -= kBinS) {
      const double gain = change.direction * (rate_hz(change.population, bin_s - kBinS, bin_s) - baseline_hz);
      if (gain > best) {
        best = gain;
        best_s = bin_s;
      }
    }
    return best_s;
  }

  void follow(PopulationChange change, double begin_s, double end_s) {
    std::set<std::uint32_t> visited;
    double until_s = end_s;
    while (why_.hops.size() < kMostHops && visited.insert(change.population).second) {
      const PopulationView& population = view_.populations[change.population];
      WhyHop hop;
      hop.population = population.name;
      hop.rate_before_hz = rate_hz(change.population, begin_s - kReachS - kBaselineS, begin_s - kReachS);
      hop.time_s = busiest_s(change, begin_s, until_s, hop.rate_before_hz);
      hop.rate_hz = rate_hz(change.population, hop.time_s - kBinS, hop.time_s);
      hop.spikes = count(change.population, begin_s - kReachS, hop.time_s);
      hop.unit = population.weight_unit;
      const std::optional<PopulationChange> next = strongest_input(change, begin_s, hop, visited);
      if (!next) {
        hop.note = population.is_retina ? seen_text(hop.time_s) : "";
      }
      until_s = hop.time_s;
      why_.hops.push_back(std::move(hop));
      if (!next) {
        return;
      }
      change = *next;
    }
  }

  /// Mean over the 10 ms before `end` of what the arrivals of the last `reach` ticks bring: what slow currents still
  /// hold of older ones is no news.
  [[nodiscard]] double recent_input(const NeuronSetup& setup, const PathwayInput& input, std::uint32_t end,
                                    std::uint32_t reach) const {
    const std::uint32_t span = std::max(1U, static_cast<std::uint32_t>(kBinS * 1e3 / view_.tick_ms()));
    PathwayInput recent{input.pathway, input.receptor, {}};
    std::copy_if(input.arrivals.begin(), input.arrivals.end(), std::back_inserter(recent.arrivals),
                 [&](const Arrival& arrival) { return arrival.tick < end && arrival.tick + reach >= end; });
    return mean_input(setup, recent, end > span ? end - span : 0, std::max(end, 1U));
  }

  /// Of all pathways into the population, the one whose input changed most in the direction that counts.
  std::optional<PopulationChange> strongest_input(const PopulationChange& change, double begin_s, WhyHop& hop,
                                                  const std::set<std::uint32_t>& visited) const {
    const PopulationView& population = view_.populations[change.population];
    const auto now = static_cast<std::uint32_t>(std::llround(hop.time_s * 1e3 / view_.tick_ms()));
    const auto before =
        static_cast<std::uint32_t>(std::llround(std::max(0.0, begin_s - kReachS) * 1e3 / view_.tick_ms()));
    struct Sum {
      double now = 0, before = 0, weight = 0;
    };
    std::vector<Sum> sums(view_.pathways.size());
    const std::uint32_t reach = std::max(1U, now - std::min(now, before));
    const std::uint32_t sampled = std::min<std::uint32_t>(kSampled, population.size);
    for (std::uint32_t k = 0; k < sampled; ++k) {
      const std::uint32_t neuron = population.first_neuron + k * population.size / sampled;
      const NeuronSetup setup = neuron_setup(view_, spikes_, neuron, now);
      for (const PathwayInput& input : setup.inputs) {
        Sum& sum = sums[input.pathway];
        sum.now += recent_input(setup, input, now, reach) / sampled;
        sum.before += recent_input(setup, input, before, reach) / sampled;
        sum.weight += input.arrivals.empty() ? 0 : input.arrivals.back().weight;
      }
    }
    std::optional<PopulationChange> best;
    double most = 1e-6;  // below any weight that matters
    for (std::uint32_t w = 0; w < sums.size(); ++w) {
      const double gain = change.direction * (sums[w].now - sums[w].before);
      hop.input_change_total += std::max(0.0, gain);
      if (gain > most && !visited.contains(view_.pathways[w].pre_population)) {
        most = gain;
        const PathwayView& pathway = view_.pathways[w];
        best = PopulationChange{pathway.pre_population, change.direction * (sums[w].weight < 0 ? -1.0 : 1.0)};
        hop.projection = pathway.projection;
        hop.where = view_.populations[pathway.pre_population].name + " -> " + population.name;
        hop.input = sums[w].now;
        hop.input_before = sums[w].before;
      }
    }
    return best;
  }

  /// Where the lit fields lie, seen from the eye's axis.
  [[nodiscard]] std::string seen_text(double time_s_at) const {
    std::size_t frame = 0;
    while (frame + 1 < run_.recording.frames.size() && time_s(frame + 1) <= time_s_at) {
      ++frame;
    }
    std::string text;
    std::array<std::size_t, kEyeCount> first{};
    for (const RecordedRetina& retina : run_.recording.retinas) {
      const auto e = static_cast<std::size_t>(retina.eye);
      double x = 0, y = 0;
      std::size_t lit = 0;
      for (const std::uint32_t field : run_.recording.frames[frame].active_fields[e]) {
        if (field >= first[e] && field - first[e] < retina.fields.size()) {
          const FieldRecord& box = retina.fields[field - first[e]];
          x += (box.x0 + box.x1) / 2 - retina.frame_width / 2.0;
          y += retina.frame_height / 2.0 - (box.y0 + box.y1) / 2;
          ++lit;
        }
      }
      first[e] += retina.fields.size();
      if (lit > 0) {
        const double focal = retina.frame_width / 2.0 / std::tan(retina.field_of_view_deg * M_PI / 360);
        const auto deg = [&](double px) { return std::atan2(px / static_cast<double>(lit), focal) * 180 / M_PI; };
        text += fmt::format("{}{} sees the target {:.1f} deg {} and {:.1f} deg {} of its axis",
                            text.empty() ? "" : "; ", retina.name, std::abs(deg(x)), deg(x) < 0 ? "left" : "right",
                            std::abs(deg(y)), deg(y) < 0 ? "below" : "above");
      }
    }
    return text;
  }

  const RecordedCircuit& run_;
  const CircuitView& view_;
  std::size_t joint_;
  SpikeTicks spikes_;
  JointWhy why_;
};

/// Of all input that changed in the same direction.
double share_of_change(const WhyHop& hop) {
  return hop.input_change_total > 0 ? std::abs(hop.input - hop.input_before) / hop.input_change_total : 0;
}

std::string rate_text(double hz) { return fmt::format("{:.{}f}", hz, hz < 10 ? 1 : 0); }

}  // namespace

std::optional<JointWhy> why_joint(const RecordedCircuit& run, Joint joint, double at_s) {
  return JointFinder(run, joint).run(at_s);
}

std::string why_text(const JointWhy& why) {
  std::string text = fmt::format("{} at {:.3f} s: told {:+.2f} deg, ", why.joint, why.time_s, why.goal_deg);
  text += why.is_moving ? fmt::format("moving {:+.2f} deg since {:.3f} s\n", why.goal_deg - why.begin_deg, why.begin_s)
                        : "holding still";
  text += why.nearest_movement_s ? fmt::format("; it moves at {:.3f} s\n", *why.nearest_movement_s)
                                 : std::string(why.is_moving ? "" : "\n");
  for (const OutputShare& term : why.terms) {
    text += fmt::format("  {}: {} fires at {:.0f} Hz, x {:+.4g} {}", why.output, term.population, term.rate_hz,
                        term.gain, term.gain_unit);
    text += why.is_moving ? fmt::format("; {:.0f} Hz before, so {:+.2f} {}\n", term.rate_before_hz,
                                        term.gain * (term.rate_hz - term.rate_before_hz),
                                        term.gain_unit == "deg/Hz" ? "deg" : "deg/s")
                          : fmt::format(" = {:+.2f} {}\n", term.gain * term.rate_hz,
                                        term.gain_unit == "deg/Hz" ? "deg" : "deg/s");
  }
  for (const WhyHop& hop : why.hops) {
    text +=
        fmt::format("  {:.3f} s  {} fires at {} Hz, {} Hz before: {} spike{} until then", hop.time_s, hop.population,
                    rate_text(hop.rate_hz), rate_text(hop.rate_before_hz), hop.spikes, hop.spikes == 1 ? "" : "s");
    if (!hop.where.empty()) {
      const double share = 100 * share_of_change(hop);
      text +=
          fmt::format("\n           because {}, {}, brings {:.3g} {} instead of {:.3g} {} ({:.0f} % of what changed)",
                      hop.where, hop.projection, hop.input, hop.unit, hop.input_before, hop.unit, share);
    }
    text += hop.note.empty() ? "\n" : "\n           because " + hop.note + "\n";
  }
  return text;
}

std::string why_json(const JointWhy& why) {
  nlohmann::ordered_json json = {
      {"joint", why.joint},      {"time_s", six_digits(why.time_s)},   {"goal_deg", six_digits(why.goal_deg)},
      {"moving", why.is_moving}, {"begin_s", six_digits(why.begin_s)}, {"begin_deg", six_digits(why.begin_deg)},
      {"output", why.output}};
  json["nearest_movement_s"] = why.nearest_movement_s ? nlohmann::ordered_json(six_digits(*why.nearest_movement_s))
                                                      : nlohmann::ordered_json(nullptr);
  json["terms"] = nlohmann::ordered_json::array();
  for (const OutputShare& term : why.terms) {
    json["terms"].push_back({{"population", term.population},
                             {"rate_hz", six_digits(term.rate_hz)},
                             {"rate_before_hz", six_digits(term.rate_before_hz)},
                             {"gain", term.gain},
                             {"gain_unit", term.gain_unit}});
  }
  json["hops"] = nlohmann::ordered_json::array();
  for (const WhyHop& hop : why.hops) {
    json["hops"].push_back({{"population", hop.population},
                            {"time_s", six_digits(hop.time_s)},
                            {"rate_hz", six_digits(hop.rate_hz)},
                            {"rate_before_hz", six_digits(hop.rate_before_hz)},
                            {"spikes", hop.spikes},
                            {"projection", hop.projection},
                            {"where", hop.where},
                            {"input", six_digits(hop.input)},
                            {"input_before", six_digits(hop.input_before)},
                            {"input_unit", hop.unit},
                            {"share_of_change", six_digits(share_of_change(hop))},
                            {"note", hop.note}});
  }
  return json.dump(2);
}

}  // namespace tectum
