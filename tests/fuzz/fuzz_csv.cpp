// Any bytes as an edge list.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/source/csv_reader.h"
#include "tests/fuzz/expect.h"

namespace {

// Numbers, as edge lists that number their neurons have them.
void read_numbers(tectum::CsvReader& reader, std::size_t count) {
  std::vector<double> values(count);
  std::uint64_t last_line = 0;
  while (reader.next(values)) {
    TECTUM_EXPECT(reader.error().empty());
    TECTUM_EXPECT(reader.line() > last_line);
    last_line = reader.line();
  }
}

// Text, as tables of cells have it: a bad row has a reason, and the rows behind it are read.
void read_fields(tectum::CsvReader& reader, std::size_t count) {
  std::vector<std::string_view> fields(count);
  for (tectum::CsvRow row = reader.next_fields(fields); row != tectum::CsvRow::End; row = reader.next_fields(fields)) {
    if (row == tectum::CsvRow::Bad) {
      TECTUM_EXPECT(!reader.row_error().empty());
      continue;
    }
    for (std::size_t f = 0; f < count; ++f) {
      double value = 0;
      TECTUM_EXPECT(reader.read_number(fields[f], f, value) || !reader.row_error().empty());
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // The reader takes a path; a file in memory has one.
  const int file = memfd_create("edges.csv", 0);
  TECTUM_EXPECT(file >= 0);
  TECTUM_EXPECT(write(file, data, size) == static_cast<ssize_t>(size));
  tectum::CsvReader reader("/proc/self/fd/" + std::to_string(file));
  if (reader.error().empty()) {
    // The first byte decides which columns are read.
    const std::size_t count = reader.header().size();
    TECTUM_EXPECT(count > 0);
    std::vector<std::size_t> columns = {data[0] % count};
    if (count > 1 && (data[0] & 64U) != 0) {
      columns.push_back((columns[0] + 1) % count);
    }
    const std::size_t selected = columns.size();
    reader.select(std::move(columns), (data[0] & 128U) != 0);
    if ((data[0] & 32U) != 0) {
      read_fields(reader, selected);
    } else {
      read_numbers(reader, selected);
    }
  }
  close(file);
  return 0;
}
