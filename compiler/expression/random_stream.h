// Random numbers keyed by (seed, name, index): an edit in one place of a circuit never reshuffles another.
#pragma once

#include <cstdint>
#include <string_view>

#include "runtime/image/philox.h"

namespace tectum {

class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name) : seed_(seed), stream_(name_hash(name)) {}

  /// Uniform in [0, 1), 53 bits. Depends on the seed, the name and `index` alone.
  [[nodiscard]] double uniform(std::uint64_t index) const {
    const PhiloxWords words =
        philox4x32(seed_, {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32U),
                           static_cast<std::uint32_t>(stream_), static_cast<std::uint32_t>(stream_ >> 32U)});
    const std::uint64_t bits = (std::uint64_t{words[0]} << 32U | words[1]) >> 11U;
    return static_cast<double>(bits) * 0x1.0p-53;
  }

  /// Uniform in 0 .. count - 1.
  [[nodiscard]] std::uint32_t below(std::uint64_t index, std::uint32_t count) const {
    return static_cast<std::uint32_t>(uniform(index) * count);
  }

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
};

}  // namespace tectum
