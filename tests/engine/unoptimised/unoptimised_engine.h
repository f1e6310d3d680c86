// What the unoptimised copy of the engine exports. Everything else of it is hidden, so that the two
// copies in one process never mix.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/engine/spike_engine.h"
#include "tests/support/run_digest.h"

/// False if the image is refused.
using UnoptimisedRun = bool (*)(const std::byte* bytes, std::size_t size, const tectum::EngineOptions* options,
                                std::uint64_t ticks, std::uint64_t plan, tectum::test::RunDigest* digest);
inline constexpr const char* kUnoptimisedRunName = "tectum_unoptimised_run";
