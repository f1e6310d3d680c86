// Images with a right checksum and wrong contents: each must be refused with a line that names the fault.
#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <string>

#include "runtime/image/image_contents.h"
#include "runtime/image/load_image.h"
#include "runtime/image/models.h"
#include "tests/support/example_contents.h"

namespace tectum {
namespace {

struct Hostile {
  const char* what;
  std::function<void(ImageContents&)> spoil;
  const char* error;  // a part of the expected line
};

constexpr std::uint32_t kHuge = 0xFFFFFFF0U;
const double kNan = std::numeric_limits<double>::quiet_NaN();

void expect_refused(std::span<const Hostile> cases) {
  for (const Hostile& hostile : cases) {
    CAPTURE(hostile.what);
    ImageContents contents = test::example_contents();
    hostile.spoil(contents);
    const LoadedImage loaded = load_image(write_image(contents));
    CHECK(!loaded.image.has_value());
    CAPTURE(loaded.error);
    CHECK(loaded.error.find(hostile.error) != std::string::npos);
  }
}

TEST_CASE("names and populations out of range are refused") {
  const Hostile cases[] = {
      {"no tick", [](ImageContents& c) { c.tick_ns = 0; }, "tick of 0 ns"},
      {"unterminated strings", [](ImageContents& c) { c.strings.back() = 'x'; }, "do not end with NUL"},
      {"circuit name", [](ImageContents& c) { c.circuit_name = 1U << 30U; }, "circuit's name"},
      {"population name", [](ImageContents& c) { c.populations[1].name = kHuge; }, "population 1: name"},
      {"population without neurons", [](ImageContents& c) { c.populations[1].size = 0; }, "population 1: neurons"},
      {"population beyond 2^32", [](ImageContents& c) { c.populations[3].size = kHuge; }, "the header says"},
      {"neuron count", [](ImageContents& c) { c.neuron_count += 1; }, "the header says"},
  };
  expect_refused(cases);
}

TEST_CASE("groups that leave their arrays are refused") {
  const Hostile cases[] = {
      {"model", [](ImageContents& c) { c.groups[2].model = ModelKind{77}; }, "group 2: unknown model 77"},
      {"program", [](ImageContents& c) { c.groups[2].model = ModelKind::Program; }, "program outside its section"},
      {"population", [](ImageContents& c) { c.groups[2].population = 99; }, "population 99"},
      {"neurons", [](ImageContents& c) { c.groups[2].first_neuron = kHuge; }, "outside its population"},
      {"size", [](ImageContents& c) { c.groups[2].size = kHuge; }, "outside its population"},
      {"receptor order", [](ImageContents& c) { c.groups[2].first_receptor = 1; }, "do not follow"},
      {"receptor count", [](ImageContents& c) { c.groups[3].receptor_count = kHuge; }, "do not follow"},
      {"slots", [](ImageContents& c) { c.groups[2].first_slot = 1; }, "share slots"},
      {"slot count", [](ImageContents& c) { c.slot_count = kHuge; }, "share slots"},
      {"flags", [](ImageContents& c) { c.groups[2].flags |= 2U; }, "unknown flags"},
      {"sleep without tables", [](ImageContents& c) { c.groups[2].flags |= kGroupMaySleep; }, "table"},
      {"sleep of a threshold unit", [](ImageContents& c) { c.groups[3].flags |= kGroupMaySleep; }, "cannot sleep"},
      {"column of nothing", [](ImageContents& c) { c.groups[2].flags |= 1U << 31U; }, "does not exist"},
      {"columns", [](ImageContents& c) { c.groups[2].column_begin = kHuge; }, "columns outside"},
      {"parameters", [](ImageContents& c) { c.groups[2].parameter_begin = kHuge; }, "parameters outside"},
      {"parameter count", [](ImageContents& c) { c.groups[2].parameter_count = 0; }, "parameters outside"},
      {"table", [](ImageContents& c) { c.groups[2].table_begin = kHuge; }, "table outside"},
      {"table entry", [](ImageContents& c) { c.tables[0] = std::numeric_limits<float>::infinity(); }, "table entry"},
      {"spike list", [](ImageContents& c) { c.groups[1].data_count = kHuge; }, "spike list outside"},
      {"odd spike list", [](ImageContents& c) { c.groups[1].data_count = 3; }, "spike list outside"},
      {"spike order", [](ImageContents& c) { c.source_spikes[0] = 5; }, "out of order"},
      {"spiking neuron", [](ImageContents& c) { c.source_spikes[1] = 2; }, "of no neuron"},
  };
  expect_refused(cases);
}

TEST_CASE("parameters and receptors that make no sense are refused") {
  const auto lif = [](ImageContents& c, std::uint32_t p) -> double& {
    return c.parameters[c.groups[2].parameter_begin + p];
  };
  const Hostile cases[] = {
      {"tau_m", [&](ImageContents& c) { lif(c, lif_parameter::kTauM) = 0; }, "tau_m is 0"},
      {"NaN", [&](ImageContents& c) { lif(c, lif_parameter::kRestV) = kNan; }, "E_L is"},
      {"NaN in a column", [&](ImageContents& c) { c.columns[0] = kNan; }, "V_th is"},
      {"split tick", [&](ImageContents& c) { lif(c, lif_parameter::kRefractory) = 0.25; }, "t_ref is 2.5"},
      {"long t_ref", [&](ImageContents& c) { lif(c, lif_parameter::kRefractory) = 1e5; }, "t_ref is"},
      {"tau", [&](ImageContents& c) { lif(c, lif_parameter::kLifCount) = -1; }, "receptor with tau"},
      {"decay", [&](ImageContents& c) { lif(c, lif_parameter::kLifCount + 2) = 2; }, "decay 2"},
      {"rate", [](ImageContents& c) { c.parameters[c.groups[0].parameter_begin] = 1e9; }, "more than one spike a tick"},
      {"receptor kind", [](ImageContents& c) { c.receptors[0].kind = ReceptorKind{9}; }, "receptor of kind 9"},
      {"receptor kind of its model", [](ImageContents& c) { c.receptors[0].kind = ReceptorKind::Boxcar; }, "of kind 3"},
      {"quantum", [](ImageContents& c) { c.receptors[0].quantum_log2 = -2000; }, "quantum of 2^-2000"},
      {"window", [](ImageContents& c) { c.receptors[2].window_ticks = 0; }, "window of 0"},
      {"long window", [](ImageContents& c) { c.receptors[2].window_ticks = kHuge; }, "window of"},
  };
  expect_refused(cases);
}

TEST_CASE("rows, segments and targets that leave their arrays are refused") {
  const Hostile cases[] = {
      {"no sentinel", [](ImageContents& c) { c.segments.clear(); }, "no sentinel"},
      {"rows", [](ImageContents& c) { c.row_begin.pop_back(); }, "do not cover the segments"},
      {"row order", [](ImageContents& c) { c.row_begin[1] = kHuge; }, "out of order"},
      {"empty segment", [](ImageContents& c) { c.segments[1].target_begin = 0; }, "segment 0 is empty"},
      {"segment", [](ImageContents& c) { c.segments[1].target_begin = kHuge; }, "segment 0 has weights"},
      {"weights", [](ImageContents& c) { c.segments[0].weight_begin = kHuge; }, "weights outside"},
      {"segment flags", [](ImageContents& c) { c.segments[0].flags = 8; }, "unknown flags"},
      {"sentinel", [](ImageContents& c) { c.segments.back().weight_begin = 0; }, "do not cover the targets"},
      {"longest delay", [](ImageContents& c) { c.max_delay_ticks = 1; }, "the header says 1"},
      {"endless delay",
       [](ImageContents& c) { c.max_delay_ticks = c.segments[c.segments.size() - 2].delay_ticks = kHuge; },
       "longest delay"},
      {"delay order", [](ImageContents& c) { c.segments[3].delay_ticks = 1; }, "do not ascend"},
      {"target order", [](ImageContents& c) { std::swap(c.targets[0], c.targets[1]); }, "out of order"},
      {"target", [](ImageContents& c) { c.targets.back() = kHuge; }, "no slots"},
      {"same-tick synapse within a group",
       [](ImageContents& c) {
         const std::uint32_t segment = c.row_begin[4];
         c.targets[c.segments[segment].target_begin] = c.groups[2].first_slot;
       },
       "not updated after its own"},
      {"projection", [](ImageContents& c) { c.projections[0].post_population = 99; }, "projection 0"},
      {"projection receptor", [](ImageContents& c) { c.projections[0].receptor = 7; }, "projection 0"},
  };
  expect_refused(cases);
}

TEST_CASE("retinas, outputs and joints out of range are refused") {
  const Hostile cases[] = {
      {"eye", [](ImageContents& c) { c.retinas[0].eye = Eye{2}; }, "retina 0: eye 2"},
      {"frame", [](ImageContents& c) { c.retinas[0].frame_width = 0; }, "frame of 0"},
      {"field of view", [](ImageContents& c) { c.retinas[0].field_of_view_deg = 180; }, "field of view"},
      {"channel", [](ImageContents& c) { c.retinas[0].lit_channel = LitChannel{0}; }, "lit channel 0"},
      {"level", [](ImageContents& c) { c.retinas[0].lit_above = 256; }, "above 256"},
      {"share", [](ImageContents& c) { c.retinas[0].lit_share = kNan; }, "lit share"},
      {"fields", [](ImageContents& c) { c.retinas[0].field_count = kHuge; }, "fields outside"},
      {"sources", [](ImageContents& c) { c.retinas[0].first_neuron = 3; }, "drive no field source"},
      {"field", [](ImageContents& c) { c.fields[1].x1 = 1e9F; }, "outside the frame"},
      {"NaN field", [](ImageContents& c) { c.fields[1].y0 = std::numeric_limits<float>::quiet_NaN(); }, "outside the"},
      {"output kind", [](ImageContents& c) { c.outputs[0].kind = OutputKind{3}; }, "output 0: kind 3"},
      {"joint mask", [](ImageContents& c) { c.outputs[0].joint_mask = 64; }, "joint mask 64"},
      {"output window", [](ImageContents& c) { c.outputs[0].window_ticks = 0; }, "window of 0"},
      {"terms", [](ImageContents& c) { c.outputs[0].term_count = 3; }, "terms outside"},
      {"counted neurons", [](ImageContents& c) { c.output_terms[0].size = kHuge; }, "a term counts"},
      {"gain", [](ImageContents& c) { c.output_terms[1].gain = kNan; }, "a term counts"},
      {"joint", [](ImageContents& c) { c.joints[0].joint = Joint{6}; }, "names joint 6"},
      {"joint twice", [](ImageContents& c) { c.joints.push_back(c.joints[0]); }, "joint record 1"},
      {"limits", [](ImageContents& c) { c.joints[0].min_deg = 90; }, "limits that are none"},
      {"program words", [](ImageContents& c) { c.programs.push_back(1); }, "equation programs"},
  };
  expect_refused(cases);
}

}  // namespace
}  // namespace tectum
