#include <doctest/doctest.h>

#include <map>
#include <string>
#include <vector>

#include "compiler/source/cell_numbers.h"

namespace tectum {
namespace {

TEST_CASE("cells are numbered in the order in which their names first come") {
  CellNumbers cells;
  CHECK(cells.add("29") == std::pair(0U, true));
  CHECK(cells.add("MBON-a1") == std::pair(1U, true));
  CHECK(cells.add("29") == std::pair(0U, false));
  CHECK(cells.add("MBON-a1") == std::pair(1U, false));
  CHECK(cells.size() == 2);
  CHECK(cells.find("MBON-a1") == 1U);
  CHECK(!cells.find("MBON-a2"));
}

TEST_CASE("nothing is found among no cells") { CHECK(!CellNumbers().find("")); }

TEST_CASE("names that are equal as numbers only are different cells") {
  CellNumbers cells;
  const std::vector<std::string> names = {"7",
                                          "07",
                                          "+7",
                                          "7.0",
                                          " 7",
                                          "",
                                          "0",
                                          "00",
                                          "9999999999999999999",   // the largest that is kept as a number
                                          "10000000000000000000",  // 20 digits
                                          "18446744073709551623",  // 7 more than 2^64
                                          "720575940621039145"};
  for (const std::string& name : names) {
    CHECK_MESSAGE(cells.add(name).second, name);
  }
  for (std::uint32_t k = 0; k < names.size(); ++k) {
    CHECK_MESSAGE(cells.find(names[k]) == k, names[k]);
  }
}

TEST_CASE("many names, of numbers in sequence and of text, are told apart as an ordered map does") {
  constexpr std::uint32_t kCount = 20000;
  CellNumbers cells;
  std::map<std::string, std::uint32_t> expected;
  for (std::uint32_t k = 0; k < 2 * kCount; ++k) {
    const std::uint32_t id = (k * 7919U) % kCount;
    const std::string name = k % 2 == 0 ? std::to_string(720575940600000000ULL + id) : "cell " + std::to_string(id);
    const auto [found, is_new] = expected.try_emplace(name, static_cast<std::uint32_t>(expected.size()));
    REQUIRE(cells.add(name) == std::pair(found->second, is_new));
  }
  REQUIRE(cells.size() == expected.size());
  for (const auto& [name, number] : expected) {
    REQUIRE(cells.find(name) == number);
  }
}

}  // namespace
}  // namespace tectum
