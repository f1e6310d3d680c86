#include "runtime/sense/lit_pixels.h"

#include <algorithm>

namespace tectum {
namespace {

using Byte = std::uint8_t;

Byte above(Byte value, Byte floor) { return value > floor ? static_cast<Byte>(value - floor) : Byte{0}; }

// Every channel is a function of three bytes in a row. The loop evaluates it at every byte, also where the three
// straddle two pixels, and keeps the results at the first byte of a pixel only. Three times the arithmetic, but the
// loads are contiguous, so that the compiler vectorises it for any instruction set; taking interleaved pixels apart
// needs byte shuffles that baseline x86-64 has not.
template <typename Channel>
bool mark(Channel channel, Byte lit_above, const Byte* bgr, std::size_t pixel_count, const Byte* first_of_pixel,
          Byte* lit) {
  const std::size_t last = 3 * pixel_count - 3;
  Byte any = 0;
  for (std::size_t i = 0; i <= last; ++i) {
    const Byte value = channel(bgr[i], bgr[i + 1], bgr[i + 2]);
    const Byte hit = static_cast<Byte>((value > lit_above ? 1 : 0) & first_of_pixel[i]);
    lit[i] = hit;
    any = static_cast<Byte>(any | hit);
  }
  return any != 0;
}

}  // namespace

bool mark_lit_pixels(LitChannel channel, std::uint32_t lit_above, const Byte* bgr, std::size_t pixel_count,
                     const Byte* first_of_pixel, Byte* lit) noexcept {
  if (pixel_count == 0) {
    return false;
  }
  const Byte floor = static_cast<Byte>(std::min<std::uint32_t>(lit_above, 255));
  const auto run = [&](auto value_of) { return mark(value_of, floor, bgr, pixel_count, first_of_pixel, lit); };
  switch (channel) {
    case LitChannel::Red:
      return run([](Byte, Byte, Byte r) { return r; });
    case LitChannel::Green:
      return run([](Byte, Byte g, Byte) { return g; });
    case LitChannel::Blue:
      return run([](Byte b, Byte, Byte) { return b; });
    case LitChannel::Luma:
      // The weights of ITU-R BT.601 in 1/256; the largest sum, 256 * 255, fits 16 bits.
      return run([](Byte b, Byte g, Byte r) {
        const auto sum = static_cast<std::uint16_t>(77U * r + 150U * g + 29U * b);
        return static_cast<Byte>(sum >> 8U);
      });
    case LitChannel::RedOverGreenBlue:
      return run([](Byte b, Byte g, Byte r) { return above(r, std::max(g, b)); });
    case LitChannel::GreenOverRedBlue:
      return run([](Byte b, Byte g, Byte r) { return above(g, std::max(r, b)); });
    case LitChannel::BlueOverRedGreen:
      return run([](Byte b, Byte g, Byte r) { return above(b, std::max(r, g)); });
    case LitChannel::Brightest:
      return run([](Byte b, Byte g, Byte r) { return std::max(r, std::max(g, b)); });
  }
  return false;
}

}  // namespace tectum
