// Any bytes as an image: refused, or described and run for a few ticks. Size and checksum in the header are
// mended first, or the fuzzer would never get past them.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "runtime/engine/spike_engine.h"
#include "runtime/image/checksum.h"
#include "runtime/image/describe_image.h"
#include "runtime/image/load_image.h"
#include "runtime/learn/learner.h"
#include "tests/fuzz/expect.h"

using namespace tectum;

namespace {

// A legal image may ask for far more memory than it has bytes (boxcar windows, delays); that is no finding.
bool is_small(const SpikeImage& image) {
  std::uint64_t window_cells = 0;
  for (const GroupRecord& group : image.groups) {
    for (std::uint32_t r = 0; r < group.receptor_count; ++r) {
      window_cells += std::uint64_t{image.receptors[group.first_receptor + r].window_ticks} * group.size;
    }
  }
  return window_cells < 1'000'000 && image.header.neuron_count < 100'000;
}

/// A reward on every channel, which is another one each tick.
RewardSample reward_of(std::uint32_t tick) {
  RewardSample reward;
  reward.value.fill(tick % 3 == 0 ? -0.5 : 1.0);
  reward.given = (std::uint32_t{1} << kRewardChannelCount) - 1;
  return reward;
}

void run(const SpikeImage& image) {
  SpikeEngine engine(image);
  Learner learner(image);
  for (std::uint32_t tick = 0; tick < 10; ++tick) {
    if (image.header.neuron_count > 0) {
      engine.inject_spike(NeuronId{tick % image.header.neuron_count});
    }
    if (image.header.slot_count > 0) {
      engine.inject_input(SlotId{tick % image.header.slot_count}, 1e3);
    }
    engine.step();
    learner.take_spikes(engine.spikes());
    if (!image.plasticity.empty()) {
      learner.take_reward(engine.tick(), reward_of(tick), engine.plastic_weights());
    }
  }
  learner.reset();
  engine.reset();
  engine.step();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) {
    std::memcpy(bytes.data(), data, size);
  }
  if (size >= sizeof(FileHeader)) {
    FileHeader header;
    std::memcpy(&header, bytes.data(), sizeof(header));
    header.magic = kImageMagic;
    header.version = kImageVersion;
    header.file_bytes = size;
    std::memcpy(bytes.data(), &header, sizeof(header));
    header.checksum = image_checksum(bytes);
    std::memcpy(bytes.data(), &header, sizeof(header));
  }
  const LoadedImage loaded = load_image(std::move(bytes));
  TECTUM_EXPECT(loaded.image.has_value() == loaded.error.empty());
  if (!loaded.image) {
    return 0;
  }
  static_cast<void>(describe_image(*loaded.image));
  if (is_small(*loaded.image)) {
    run(*loaded.image);
  }
  return 0;
}
