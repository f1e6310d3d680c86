#include "drivers/servo/ax12_registers.h"

#include <doctest/doctest.h>

#include <set>
#include <string>

using namespace tectum;

TEST_CASE("registers have their own name, do not overlap and lie inside the table") {
  std::set<std::string_view> names;
  std::set<int> bytes;
  for (const ax12::Register& row : ax12::kRegisters) {
    CAPTURE(std::string(row.name));
    CHECK(names.insert(row.name).second);
    CHECK((row.size == 1 || row.size == 2));
    for (int at = row.address; at < row.address + row.size; ++at) {
      CHECK(bytes.insert(at).second);
      CHECK(at < ax12::kTableSize);
    }
    CHECK(row.min <= row.max);
    CHECK(row.initial <= row.max);
    CHECK(row.max < (1U << (8 * row.size)));
  }
}

TEST_CASE("a register is found by its name and by each of its bytes") {
  CHECK(ax12::find_register("goal_position")->address == 30);
  CHECK(ax12::find_register("goal") == nullptr);
  CHECK(ax12::register_at(31)->name == "goal_position");
  CHECK(ax12::register_at(43)->name == "present_temperature");
  for (const int reserved : {10, 19, 20, 21, 22, 23, 45}) {
    CHECK(ax12::register_at(static_cast<std::uint8_t>(reserved)) == nullptr);
  }
}

TEST_CASE("baud rates are two million over the value plus one") {
  CHECK(ax12::baud_of(1) == 1e6);
  CHECK(ax12::baud_of(34) == doctest::Approx(57142.9));
}
