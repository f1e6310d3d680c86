#include "runtime/image/describe_image.h"

#include <doctest/doctest.h>

#include "runtime/image/image_contents.h"
#include "tests/support/example_contents.h"

namespace tectum {
namespace {

std::string describe_example(bool in_full) {
  DescribeOptions options;
  options.in_full = in_full;
  return describe_image(load_image(write_image(test::example_contents())).image.value(), options);
}

TEST_CASE("the description says what each record means, by name") {
  const std::string text = describe_example(true);
  CAPTURE(text);
  for (const char* line : {
           "circuit `test`, tick 0.1 ms, seed 7",
           "9 neurons, 8 slots, 8 synapses, longest delay 5 ticks",
           "population 2 `lif`, nucleus `nucleus`, neurons 4..6",
           "group 2 of `lif`: lif_exp, neurons 4..6, 2 receptors, slots from 0, one value a neuron: V_th",
           "receptor 1 `in` of `lif`: exponential, quantum 2^-30",
           "20  lif.tau_m, ms",
           "10  lif.in tau, ms",
           "row of neuron 4 lif[0] starts at segment",
           "segment 4 of lif[0]: delay 0 ticks, 1 targets from 6, all with weight",
           "slot 5: field[1] -> lif[2].in, 3 ticks, weight -536870912 quanta = -0.5",
           "projection 0 `field_lif`: `field` -> `lif`, receptor 0, 2 synapses, cites `rotter1999`",
           "retina 0 `left_eye`: left eye, frame 720 x 720 px over 60 deg, lit when green over red and blue > 20",
           "field 1: x 360..720, y 0..720 px",
           "output 0 `pan`: velocity, terms 0..+2, window 200 ticks, offset 0 deg, to left_eye_pan right_eye_pan",
           "term 1: rate of neurons 6..6 (lif[2] on) times -0.5",
           "joint left_eye_pan: -35..35 deg, at most 300 deg/s",
           "end of file",
       }) {
    CAPTURE(line);
    CHECK(text.find(line) != std::string::npos);
  }
}

TEST_CASE("long arrays are cut unless asked for in full") {
  const std::string brief = describe_example(false);
  CHECK(brief.size() < describe_example(true).size());
  CHECK(brief.find("more\n") != std::string::npos);
  CHECK(describe_example(true).find("more\n") == std::string::npos);
}

}  // namespace
}  // namespace tectum
