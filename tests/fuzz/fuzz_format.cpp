// Any text to the formatter: it refuses, or its result formats to itself.
#include <cstdint>
#include <string_view>

#include "compiler/format/format_circuit.h"
#include "tests/fuzz/expect.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const tectum::FormattedCircuit once = tectum::format_circuit(text);
  TECTUM_EXPECT(once.text.has_value() == once.error.empty());
  TECTUM_EXPECT(once.error_offset <= size);
  if (once.text) {
    TECTUM_EXPECT(tectum::format_circuit(*once.text).text == once.text);
  }
  return 0;
}
