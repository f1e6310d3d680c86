// Units, their products, and how dimensions are named in messages.
#include "compiler/expression/dimension.h"

#include <doctest/doctest.h>

#include <string>

using namespace tectum;

TEST_CASE("dimensions are named as a neuroscientist would") {
  const auto name = [](std::string_view unit) { return describe(parse_unit(unit)->dimension); };
  CHECK(name("V") == "voltage (mV)");
  CHECK(name("pA") == "current (nA)");
  CHECK(name("s") == "time (ms)");
  CHECK(name("kHz") == "frequency (Hz)");
  CHECK(name("mV/nA") == "resistance (MOhm)");
  CHECK(name("nA/mV") == "conductance (uS)");
  CHECK(name("nA*ms") == "charge (pC)");
  CHECK(name("nA*ms/mV") == "capacitance (nF)");
  CHECK(name("V/s") == "voltage per time (mV/ms)");
  CHECK(name("rad/s") == "angular velocity (deg/s)");
  CHECK(name("deg/Hz") == "angle per frequency (deg/Hz)");
  CHECK(name("mV^2/ms") == "mV^2/ms");
  CHECK(name("1/ms^2") == "1/ms^2");
  CHECK(name("%") == "number");
  CHECK(describe(kBoolean) == "truth value");
  CHECK(describe(kWord) == "word");
}

TEST_CASE("one coherent system: products of coherent units need no factor") {
  for (const char* unit :
       {"mV/nA", "nA/mV", "nA*ms", "nA*ms/mV", "1/ms", "deg/ms", "mV/ms", "MOhm*nA/mV", "nF*MOhm/ms"}) {
    CAPTURE(unit);
    CHECK(to_coherent(1, *parse_unit(unit)) == 1);
  }
}

TEST_CASE("what is no unit is refused") {
  for (const char* text : {"mX", "mV/", "/ms", "mV**ms", "mV^", "mV^x", "mV^1000", "mV mV", "2", "s^99*s^99", "(mV)"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_unit(text));
  }
  CHECK(parse_unit("")->dimension == kNumber);
  CHECK(parse_unit("1")->dimension == kNumber);
  CHECK(parse_unit("deg / s / Hz")->dimension == kAngle);
}

TEST_CASE("units convert there and back") {
  const Unit deg_per_hz = *parse_unit("deg/Hz");
  CHECK(from_coherent(to_coherent(0.02, deg_per_hz), deg_per_hz) == 0.02);
  CHECK(to_coherent(1, *parse_unit("V/A")) == to_coherent(1, *parse_unit("Ohm")));
  CHECK(to_coherent(1, *parse_unit("F")) == to_coherent(1, *parse_unit("s/Ohm")));
  CHECK(from_coherent(0.25, *parse_unit("Hz")) == 250);
}

TEST_CASE("misspelt units get a suggestion") {
  CHECK(suggest_unit("mv") == "mV");
  CHECK(suggest_unit("MOHM") == "MOhm");
  CHECK(suggest_unit("degrees") == "deg");
  CHECK(suggest_unit("hz") == "Hz");
  CHECK_FALSE(suggest_unit("furlong"));
}
