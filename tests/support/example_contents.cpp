#include "tests/support/example_contents.h"

#include "tests/support/test_network.h"

namespace tectum::test {

ImageContents example_contents() {
  TestNetwork network;
  network.seed = 7;
  network.add("field", {ModelKind::FieldSource, 2, {{"rate", {1000.0}}}, {}, false});
  network.add_spikes("given", {{3, 9}, {3}});
  network.add(
      "lif",
      {ModelKind::LifExp, 3, {{"V_th", {-50.0, -51.0, -52.0}}}, {exponential("ex", 5), exponential("in", 10)}, false});
  network.add("gate", {ModelKind::Threshold, 2, {{"theta", {1.0}}}, {boxcar("window", 4)}, false});
  network.connect(0, 4, 1, 0.5);
  network.connect(0, 5, 1, 0.25);
  network.connect(1, 6, 3, -0.5, 1);
  network.connect(2, 4, 1, 0.5);
  network.connect(2, 5, 1, 0.5);
  network.connect(2, 6, 2, 0.5);
  network.connect(4, 7, 0, 1.0);
  network.connect(4, 8, 5, 1.0);
  ImageContents image = lower_network(network);
  image.populations[2].nucleus = image.add_string("nucleus");
  image.projections.push_back({image.add_string("field_lif"), 0, 2, 0, 2, image.add_string("rotter1999")});
  image.retinas.push_back(
      {image.add_string("left_eye"), Eye::Left, 720, 720, 60.0, LitChannel::GreenOverRedBlue, 20, 0.05, 0, 2, 0, 0});
  image.fields.push_back({0, 0, 360, 720});
  image.fields.push_back({360, 0, 720, 720});
  image.outputs.push_back({image.add_string("pan"), OutputKind::Velocity, 0, 2, 0b000101, 200, 0.0});
  image.output_terms.push_back({4, 2, 0.5});
  image.output_terms.push_back({6, 1, -0.5});
  image.joints.push_back({Joint::LeftEyePan, 0, -35, 35, 300});
  return image;
}

}  // namespace tectum::test
