// Any bytes as an edge list.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/source/csv_reader.h"
#include "tests/fuzz/expect.h"

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
    reader.select(columns, (data[0] & 128U) != 0);
    std::vector<double> values(columns.size());
    std::uint64_t last_line = 0;
    while (reader.next(values)) {
      TECTUM_EXPECT(reader.error().empty());
      TECTUM_EXPECT(reader.line() > last_line);
      last_line = reader.line();
    }
  }
  close(file);
  return 0;
}
