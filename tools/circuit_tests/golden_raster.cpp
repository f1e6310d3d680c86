#include "tools/circuit_tests/golden_raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <sstream>

#include "runtime/image/checksum.h"
#include "tools/analysis/spike_times.h"

namespace tectum {
namespace {

constexpr double kBinMs = 10;
constexpr std::size_t kMostWritten = 40;  // spikes in a line
constexpr std::size_t kMostShown = 60;    // bytes of a line in a message

/// Of one population in one bin, ascending by (tick, neuron); neurons count from 0.
using Spikes = std::vector<RecordedSpike>;

/// "0-3,9"
std::string neurons_text(std::span<const RecordedSpike> spikes) {
  std::string text;
  for (std::size_t k = 0; k < spikes.size();) {
    std::size_t last = k;
    while (last + 1 < spikes.size() && spikes[last + 1].neuron == spikes[last].neuron + 1) {
      ++last;
    }
    text += text.empty() ? "" : ",";
    text +=
        last == k ? fmt::format("{}", spikes[k].neuron) : fmt::format("{}-{}", spikes[k].neuron, spikes[last].neuron);
    k = last + 1;
  }
  return text;
}

std::string spikes_text(const Spikes& spikes) {
  if (spikes.size() > kMostWritten) {
    std::vector<std::uint64_t> words;
    for (const RecordedSpike& spike : spikes) {
      words.push_back(spike.tick);
      words.push_back(spike.neuron);
    }
    return fmt::format("#{:016x}", checksum64(std::as_bytes(std::span(words))));
  }
  std::string text;
  for (std::size_t k = 0; k < spikes.size();) {
    std::size_t next = k;
    while (next < spikes.size() && spikes[next].tick == spikes[k].tick) {
      ++next;
    }
    text += fmt::format("{}{}:{}", text.empty() ? "" : " ", spikes[k].tick,
                        neurons_text(std::span(spikes).subspan(k, next - k)));
    k = next;
  }
  return text;
}

struct Line {
  std::string place, rest;
  friend bool operator<(const Line& a, const Line& b) {
    return a.place != b.place ? a.place < b.place : a.rest < b.rest;
  }
  friend bool operator==(const Line&, const Line&) = default;
};

/// Blanks are only for the eye: a longer name elsewhere in the file moves a column and changes nothing.
std::vector<Line> lines_of(const std::string& text) {
  std::vector<Line> lines;
  std::istringstream in(text);
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string time, unit, population, count, word, rest;
    if (line.empty() || line[0] == '#' || !(words >> time >> unit >> population >> count)) {
      continue;
    }
    while (words >> word) {
      rest += " " + word;
    }
    lines.push_back({fmt::format("{} {}, {}", time, unit, population), count + rest});
  }
  return lines;
}

std::string cut(const std::string& text) {
  return text.size() <= kMostShown ? text : text.substr(0, kMostShown) + "...";
}

}  // namespace

std::string golden_raster(const Recording& recording, const RasterSelection& selection, const std::string& world) {
  const double tick_ms = static_cast<double>(recording.tick_ns) * 1e-6;
  const auto bin_ticks = static_cast<std::uint64_t>(std::max(1.0, std::round(kBinMs / tick_ms)));
  std::string text = fmt::format(
      "# tectum raster 1:{}\n"
      "# ticks of {:g} ms; each line: a bin of {:g} ms, population, spikes, then tick:neurons (# checksum where they "
      "are many)\n",
      world, tick_ms, static_cast<double>(bin_ticks) * tick_ms);
  std::vector<std::size_t> slot_of(recording.populations.size(), selection.populations.size());
  std::size_t width = 0;
  for (std::size_t slot = 0; slot < selection.populations.size(); ++slot) {
    slot_of[selection.populations[slot]] = slot;
    width = std::max(width, recording.populations[selection.populations[slot]].name.size());
  }
  const std::vector<std::uint32_t> population_of = population_of_neurons(recording);
  const std::span<const RecordedSpike> spikes = spikes_between(recording, selection.begin_s, selection.end_s);
  for (auto spike = spikes.begin(); spike != spikes.end();) {
    const std::uint64_t bin = spike->tick / bin_ticks;
    std::vector<Spikes> in_bin(selection.populations.size());
    for (; spike != spikes.end() && spike->tick / bin_ticks == bin; ++spike) {
      const std::uint32_t population = population_of[spike->neuron];
      if (population != kNoPopulation && slot_of[population] < in_bin.size()) {
        in_bin[slot_of[population]].push_back(
            {spike->tick, spike->neuron - recording.populations[population].first_neuron});
      }
    }
    for (std::size_t slot = 0; slot < in_bin.size(); ++slot) {
      if (!in_bin[slot].empty()) {
        text += fmt::format("{:g} ms  {:<{}}  {:>4}  {}\n", static_cast<double>(bin * bin_ticks) * tick_ms,
                            recording.populations[selection.populations[slot]].name, width, in_bin[slot].size(),
                            spikes_text(in_bin[slot]));
      }
    }
  }
  return text;
}

std::optional<RasterChange> compare_rasters(const std::string& golden, const std::string& now) {
  const std::vector<Line> before_lines = lines_of(golden), now_lines = lines_of(now);
  const std::set<Line> before(before_lines.begin(), before_lines.end()), after(now_lines.begin(), now_lines.end());
  RasterChange change;
  const auto count_missing = [&](const std::vector<Line>& lines, const std::set<Line>& others) {
    return static_cast<std::size_t>(
        std::count_if(lines.begin(), lines.end(), [&](const Line& line) { return others.count(line) == 0; }));
  };
  change.lines = std::max(count_missing(before_lines, after), count_missing(now_lines, before));
  if (change.lines == 0) {
    return std::nullopt;
  }
  const std::size_t common = std::min(before_lines.size(), now_lines.size());
  std::size_t first = 0;
  while (first < common && before_lines[first] == now_lines[first]) {
    ++first;
  }
  // A line that only one of them has: the other goes on with a place that comes later, or ends.
  const bool is_added =
      first == before_lines.size() ||
      (first < now_lines.size() && std::none_of(before_lines.begin(), before_lines.end(), [&](const Line& line) {
         return line.place == now_lines[first].place;
       }));
  const Line& line = is_added ? now_lines[first] : before_lines[first];
  change.first_place = line.place;
  const auto rest_at = [&](const std::vector<Line>& lines) {
    const auto found =
        std::find_if(lines.begin(), lines.end(), [&](const Line& other) { return other.place == line.place; });
    return found == lines.end() ? std::string() : found->rest;
  };
  change.before = rest_at(before_lines);
  change.now = rest_at(now_lines);
  return change;
}

std::string change_text(const RasterChange& change) {
  const auto shown = [](const std::string& rest) { return rest.empty() ? "no spike" : fmt::format("`{}`", cut(rest)); };
  return fmt::format("{} line{} differ{}, the first at {}: {} instead of {}", change.lines,
                     change.lines == 1 ? "" : "s", change.lines == 1 ? "s" : "", change.first_place, shown(change.now),
                     shown(change.before));
}

}  // namespace tectum
