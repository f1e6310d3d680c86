// The engine once more, compiled without optimisation and loaded at run time.
#include "tests/engine/unoptimised/unoptimised_engine.h"

#include "runtime/image/load_image.h"
#include "tests/support/run_digest.h"

extern "C" __attribute__((visibility("default"))) bool tectum_unoptimised_run(const std::byte* bytes, std::size_t size,
                                                                              const tectum::EngineOptions* options,
                                                                              std::uint64_t ticks, std::uint64_t plan,
                                                                              tectum::test::RunDigest* digest) {
  const tectum::LoadedImage loaded = tectum::load_image({bytes, bytes + size});
  if (!loaded.image) {
    return false;
  }
  *digest = tectum::test::run_digest(*loaded.image, *options, ticks, plan, false);
  return true;
}
