// A live run as text in a terminal: both eyes, spikes, joints, timing, and the last things that were told.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "tools/live/live_run.h"

namespace tectum {

class Dashboard {
 public:
  /// `image` outlives it.
  explicit Dashboard(const SpikeImage& image);

  /// One screen, with the terminal's own commands to draw it over the last one.
  [[nodiscard]] std::string draw(const LiveGlimpse& glimpse);
  void add_line(const std::string& text);

 private:
  [[nodiscard]] std::vector<std::string> eyes(const RecordedFrame& frame) const;
  [[nodiscard]] std::string raster_row(std::size_t population) const;

  const SpikeImage& image_;
  std::deque<std::vector<std::uint32_t>> history_;  // spikes of each population, one entry a drawing
  std::deque<std::string> lines_;
};

}  // namespace tectum
