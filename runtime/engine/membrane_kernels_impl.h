// The membrane kernels over a vector type. Each membrane_kernels_*.cpp includes this once, inside an
// anonymous namespace and after its Vec:
//   kWidth                        lanes, a divisor of 64
//   F, M                          floats, a mask
//   load store set1 add mul max   as named
//   reaches(F, F)                 a >= b
//   below(F, F)                   a < b
//   blend(M, F, F)                the second where set, else the first
//   mask(bits), bits(M), both(M, M), either(M, M), without(M, M)   a and not b
//   without_dust(F)               0 where the size is below 2^-63
//   take_inputs(int32*, lanes)    quanta as floats, 0 in other lanes; zeroes what it read
//   take_all_inputs(int32*)       the same, all lanes
//   was_refractory(uint16*)       who is refractory; takes one tick off
//   is_refractory(uint16*)        who still is
//   I                             unsigned integers, with indices(uint32*, lanes), set1i, sub, bits_of (and), times,
//                                 shift_right, nonzero, gather, gather_integers, gather_refractory, scatter,
//                                 scatter_integers, take_gathered_inputs: only the lanes of a mask are read or written
// Every way to advance a neuron gives the same bits: the same operations in the same order.

/// Number of currents not known when the kernel is compiled.
constexpr std::uint32_t kAnyCount = 0xFFFFFFFFU;

struct VectorResult {
  std::uint64_t fired;
  std::uint64_t may_sleep;
};

constexpr std::uint64_t kAllLanes = ~std::uint64_t{0} >> (64 - Vec::kWidth);

// Where each current and each receptor's inputs begin, worked out before the loop over neurons.
template <std::uint32_t kCurrents>
struct Places {
  static constexpr std::uint32_t kRoom = kCurrents == kAnyCount || kCurrents == 0 ? kMaxReceptors + 1 : kCurrents;
  float* currents[kRoom];
  std::int32_t* inputs[kRoom];

  Places(const MembraneArgs& a, std::int32_t* first_input) noexcept {
    const std::uint32_t count = kCurrents == kAnyCount || kCurrents == 0 ? kRoom : kCurrents;
    for (std::uint32_t c = 0; c < count; ++c) {
      currents[c] = a.currents != nullptr ? a.currents + c * a.stride : nullptr;  // lif_delta has none
      inputs[c] = first_input + c * a.input_stride;
    }
  }
};

// Advances `lanes` of the vector of neurons that starts at `i`; all of them unless kMasked.
template <ModelKind kModel, std::uint32_t kCurrents, bool kOwn, bool kMasked, bool kDust>
[[gnu::always_inline]] inline VectorResult advance_vector(const MembraneArgs& a, const Places<kCurrents>& places,
                                                          std::size_t i, std::uint64_t lanes) noexcept {
  const auto arrived = [&](std::uint32_t receptor) {
    std::int32_t* const place = places.inputs[receptor] + i;
    return kMasked ? Vec::take_inputs(place, lanes) : Vec::take_all_inputs(place);
  };
  constexpr bool kIsDelta = kModel == ModelKind::LifDelta;
  constexpr bool kAdapts = kModel == ModelKind::Alif;
  const std::uint32_t currents = kIsDelta ? 0 : kCurrents == kAnyCount ? a.current_count : kCurrents;
  const std::uint32_t arriving = kAdapts ? currents - 1 : currents;
  typename Vec::F now[kIsDelta ? 1 : kCurrents == kAnyCount ? kMaxReceptors + 1 : kCurrents];
  typename Vec::F old[kMasked && !kIsDelta ? kMaxReceptors + 1 : 1];
  const typename Vec::M on = Vec::mask(lanes);

  const typename Vec::F old_u = Vec::load(a.u + i);
  typename Vec::F u = Vec::mul(Vec::set1(a.decay), kDust ? Vec::without_dust(old_u) : old_u);
  for (std::uint32_t c = 0; c < currents; ++c) {
    const typename Vec::F loaded = Vec::load(places.currents[c] + i);
    if constexpr (kMasked && !kIsDelta) {
      old[c] = loaded;
    }
    const typename Vec::F current = kDust ? Vec::without_dust(loaded) : loaded;
    u = Vec::add(u, Vec::mul(Vec::set1(a.gain[c]), current));
    now[c] = Vec::mul(Vec::set1(a.current_decay[c]), current);
    if (c < arriving) {
      now[c] = Vec::add(now[c], arrived(c));
    }
  }
  if constexpr (kIsDelta) {
    for (std::uint32_t r = 0; r < a.receptor_count; ++r) {
      const typename Vec::F quanta = arrived(r);
      u = Vec::add(u, Vec::mul(Vec::set1(a.delta_quantum_mv[r]), quanta));
    }
  }

  const typename Vec::F threshold = kOwn ? Vec::load(a.threshold_mv + i) : Vec::set1(a.shared_threshold_mv);
  const typename Vec::F reset = kOwn ? Vec::load(a.reset_mv + i) : Vec::set1(a.shared_reset_mv);
  const typename Vec::M was_refractory = Vec::was_refractory(a.refractory + i);
  const typename Vec::M fires = Vec::both(on, Vec::without(Vec::reaches(u, threshold), was_refractory));
  u = Vec::blend(Vec::either(was_refractory, fires), u, reset);
  if constexpr (kAdapts) {
    const std::uint32_t w = currents - 1;
    now[w] = Vec::blend(fires, now[w], Vec::add(now[w], Vec::set1(a.adaptation_step_na)));
  }
  const std::uint64_t fired = Vec::bits(fires);
  for (std::uint64_t left = fired; __builtin_expect(left != 0, 0); left &= left - 1) {
    a.refractory[i + static_cast<std::size_t>(__builtin_ctzll(left))] = static_cast<std::uint16_t>(a.refractory_ticks);
  }

  std::uint64_t may_sleep = 0;
  if constexpr (kMasked) {
    typename Vec::F bound = Vec::max(u, Vec::set1(0));
    for (std::uint32_t c = 0; c < currents; ++c) {
      bound = Vec::add(bound, Vec::max(Vec::mul(Vec::set1(a.peak[c]), now[c]), Vec::set1(0)));
    }
    const typename Vec::F sleep = kOwn ? Vec::load(a.sleep_mv + i) : Vec::set1(a.shared_sleep_mv);
    may_sleep = lanes & Vec::bits(Vec::without(Vec::below(bound, sleep), Vec::is_refractory(a.refractory + i)));
    u = Vec::blend(on, old_u, u);
  }
  Vec::store(a.u + i, u);
  for (std::uint32_t c = 0; c < currents; ++c) {
    if constexpr (kMasked && !kIsDelta) {
      now[c] = Vec::blend(on, old[c], now[c]);
    }
    Vec::store(places.currents[c] + i, now[c]);
  }
  return {fired, may_sleep};
}

template <ModelKind kModel, std::uint32_t kCurrents, bool kOwn, bool kDust>
std::uint32_t sweep_all(const MembraneArgs& args, std::int32_t* inputs, std::uint32_t begin, std::uint32_t end,
                        std::uint32_t* fired) noexcept {
  const MembraneArgs a = args;  // a copy that no store can touch, so that it stays in registers
  const Places<kCurrents> places(a, inputs);
  std::uint32_t fired_count = 0;
  const auto emit = [&](std::uint64_t bits, std::uint32_t first) {
    for (; bits != 0; bits &= bits - 1) {
      fired[fired_count++] = first + static_cast<std::uint32_t>(__builtin_ctzll(bits));
    }
  };
  std::size_t i = begin;
  for (const std::size_t whole = begin + (end - begin) / Vec::kWidth * Vec::kWidth; i < whole; i += Vec::kWidth) {
    const std::uint64_t who = advance_vector<kModel, kCurrents, kOwn, false, kDust>(a, places, i, kAllLanes).fired;
    if (__builtin_expect(who != 0, 0)) {
      emit(who, static_cast<std::uint32_t>(i));
    }
  }
  if (i < end) {
    const std::uint64_t lanes = kAllLanes >> (Vec::kWidth - (end - i));
    emit(advance_vector<kModel, kCurrents, kOwn, true, kDust>(a, places, i, lanes).fired,
         static_cast<std::uint32_t>(i));
  }
  return fired_count;
}

template <ModelKind kModel, std::uint32_t kCurrents, bool kOwn>
std::uint32_t sweep(const MembraneArgs& args, MembraneTick tick, std::uint32_t begin, std::uint32_t end,
                    std::uint32_t* fired) noexcept {
  return tick.removes_dust ? sweep_all<kModel, kCurrents, kOwn, true>(args, tick.inputs, begin, end, fired)
                           : sweep_all<kModel, kCurrents, kOwn, false>(args, tick.inputs, begin, end, fired);
}

template <ModelKind kModel, std::uint32_t kCurrents, bool kOwn>
MembraneWord sweep_word(const MembraneArgs& args, MembraneTick tick, std::uint32_t word, std::uint64_t lanes) noexcept {
  const Places<kCurrents> places(args, tick.inputs);
  MembraneWord result{0, 0};
  for (std::uint32_t k = 0; k < 64; k += Vec::kWidth) {
    const std::uint64_t here = (lanes >> k) & kAllLanes;
    if (here == 0) {
      continue;
    }
    const std::uint32_t i = 64 * word + k;
    const VectorResult vector = tick.removes_dust
                                    ? advance_vector<kModel, kCurrents, kOwn, true, true>(args, places, i, here)
                                    : advance_vector<kModel, kCurrents, kOwn, true, false>(args, places, i, here);
    result.fired |= vector.fired << k;
    result.may_sleep |= vector.may_sleep << k;
  }
  return result;
}

// The state of a vector of neurons picked by index.
template <ModelKind kModel, std::uint32_t kCurrents>
struct Picked {
  static constexpr std::uint32_t kRoom = kModel == ModelKind::LifDelta ? 1
                                         : kCurrents == kAnyCount      ? kMaxReceptors + 1
                                                                       : kCurrents;
  typename Vec::F u;
  typename Vec::F now[kRoom];
};

// u and the currents after `ticks`, digit by digit.
template <ModelKind kModel, std::uint32_t kCurrents>
[[gnu::always_inline]] inline void leap_vector(const MembraneLeaps& leaps, std::uint32_t currents, typename Vec::M on,
                                               typename Vec::I ticks, Picked<kModel, kCurrents>& state) noexcept {
  const std::uint32_t entry_size = 1 + 2 * currents;
  const std::uint32_t digits = 1U << leaps.digit_bits;
  const float* level = leaps.levels;
  while (Vec::bits(Vec::both(on, Vec::nonzero(ticks))) != 0) {
    const typename Vec::I digit = Vec::bits_of(ticks, digits - 1);
    const typename Vec::M leaping = Vec::both(on, Vec::nonzero(digit));
    const typename Vec::I entry = Vec::times(digit, entry_size);
    typename Vec::F u = Vec::mul(Vec::gather(level, entry, leaping), state.u);
    for (std::uint32_t c = 0; c < currents; ++c) {
      u = Vec::add(u, Vec::mul(Vec::gather(level + 1 + c, entry, leaping), state.now[c]));
      const typename Vec::F decayed = Vec::mul(Vec::gather(level + 1 + currents + c, entry, leaping), state.now[c]);
      state.now[c] = Vec::blend(leaping, state.now[c], decayed);
    }
    state.u = Vec::blend(leaping, state.u, u);
    ticks = Vec::shift_right(ticks, leaps.digit_bits);
    level += digits * entry_size;
  }
  state.u = Vec::without_dust(state.u);
  for (std::uint32_t c = 0; c < currents; ++c) {
    state.now[c] = Vec::without_dust(state.now[c]);
  }
}

// u and the currents after one tick, before what arrived is added.
template <ModelKind kModel, std::uint32_t kCurrents>
[[gnu::always_inline]] inline void step_vector(const MembraneArgs& a, std::uint32_t currents, bool removes_dust,
                                               Picked<kModel, kCurrents>& state) noexcept {
  typename Vec::F u = Vec::mul(Vec::set1(a.decay), removes_dust ? Vec::without_dust(state.u) : state.u);
  for (std::uint32_t c = 0; c < currents; ++c) {
    const typename Vec::F current = removes_dust ? Vec::without_dust(state.now[c]) : state.now[c];
    u = Vec::add(u, Vec::mul(Vec::set1(a.gain[c]), current));
    state.now[c] = Vec::mul(Vec::set1(a.current_decay[c]), current);
  }
  state.u = u;
}

// One tick (or a leap over many, kLeaps) of up to 64 neurons picked by index.
template <ModelKind kModel, std::uint32_t kCurrents, bool kOwn, bool kLeaps>
MembraneWord advance_picked(const MembraneArgs& a, MembraneTick tick, const MembraneLeaps& leaps,
                            const std::uint32_t* neurons, std::uint32_t count, std::uint32_t done) noexcept {
  constexpr bool kIsDelta = kModel == ModelKind::LifDelta;
  constexpr bool kAdapts = kModel == ModelKind::Alif;
  const std::uint32_t currents = kIsDelta ? 0 : kCurrents == kAnyCount ? a.current_count : kCurrents;
  MembraneWord result{0, 0};
  for (std::uint32_t k = 0; k < count; k += Vec::kWidth) {
    const std::uint64_t lanes = count - k < Vec::kWidth ? kAllLanes >> (Vec::kWidth - (count - k)) : kAllLanes;
    const typename Vec::M on = Vec::mask(lanes);
    const typename Vec::I neuron = Vec::indices(neurons + k, lanes);
    Picked<kModel, kCurrents> state;
    state.u = Vec::gather(a.u, neuron, on);
    for (std::uint32_t c = 0; c < currents; ++c) {
      state.now[c] = Vec::gather(a.currents + c * a.stride, neuron, on);
    }
    if constexpr (kLeaps) {
      const typename Vec::I slept = Vec::sub(Vec::set1i(done), Vec::gather_integers(leaps.valid_after, neuron, on));
      leap_vector<kModel, kCurrents>(leaps, currents, on, slept, state);
    } else {
      step_vector<kModel, kCurrents>(a, currents, tick.removes_dust, state);
    }
    for (std::uint32_t r = 0; r < (kIsDelta ? a.receptor_count : kAdapts ? currents - 1 : currents); ++r) {
      const typename Vec::F quanta = Vec::take_gathered_inputs(tick.inputs + r * a.input_stride, neuron, on);
      if constexpr (kIsDelta) {
        state.u = Vec::add(state.u, Vec::mul(Vec::set1(a.delta_quantum_mv[r]), quanta));
      } else {
        state.now[r] = Vec::add(state.now[r], quanta);
      }
    }

    // Who sleeps is not refractory.
    const std::uint64_t was_refractory =
        kLeaps ? 0 : Vec::bits(Vec::both(on, Vec::gather_refractory(a.refractory, neuron, on)));
    std::uint64_t still_refractory = 0;
    for (std::uint64_t left = was_refractory; left != 0; left &= left - 1) {
      std::uint16_t& ticks = a.refractory[neurons[k + static_cast<std::uint32_t>(__builtin_ctzll(left))]];
      ticks = static_cast<std::uint16_t>(ticks - 1);
      still_refractory |= ticks != 0 ? left & -left : 0;
    }
    const typename Vec::F threshold = kOwn ? Vec::gather(a.threshold_mv, neuron, on) : Vec::set1(a.shared_threshold_mv);
    const typename Vec::F reset = kOwn ? Vec::gather(a.reset_mv, neuron, on) : Vec::set1(a.shared_reset_mv);
    const std::uint64_t fired = lanes & Vec::bits(Vec::reaches(state.u, threshold)) & ~was_refractory;
    state.u = Vec::blend(Vec::mask(was_refractory | fired), state.u, reset);
    if constexpr (kAdapts) {
      const std::uint32_t w = currents - 1;
      const typename Vec::F adapted = Vec::add(state.now[w], Vec::set1(a.adaptation_step_na));
      state.now[w] = Vec::blend(Vec::mask(fired), state.now[w], adapted);
    }
    for (std::uint64_t left = fired; left != 0; left &= left - 1) {
      a.refractory[neurons[k + static_cast<std::uint32_t>(__builtin_ctzll(left))]] =
          static_cast<std::uint16_t>(a.refractory_ticks);
    }
    typename Vec::F bound = Vec::max(state.u, Vec::set1(0));
    for (std::uint32_t c = 0; c < currents; ++c) {
      bound = Vec::add(bound, Vec::max(Vec::mul(Vec::set1(a.peak[c]), state.now[c]), Vec::set1(0)));
    }
    const typename Vec::F sleep = kOwn ? Vec::gather(a.sleep_mv, neuron, on) : Vec::set1(a.shared_sleep_mv);
    const std::uint64_t refractory = still_refractory | (a.refractory_ticks == 0 ? 0 : fired);
    const std::uint64_t calm = lanes & Vec::bits(Vec::below(bound, sleep)) & ~refractory;
    result.fired |= fired << k;
    result.may_sleep |= calm << k;

    Vec::scatter(a.u, neuron, on, state.u);
    for (std::uint32_t c = 0; c < currents; ++c) {
      Vec::scatter(a.currents + c * a.stride, neuron, on, state.now[c]);
    }
    Vec::scatter_integers(leaps.valid_after, neuron, Vec::mask(calm), Vec::set1i(done));
  }
  return result;
}

template <ModelKind kModel, std::uint32_t kCurrents>
MembraneKernels kernels_for(bool own) noexcept {
  return own ? MembraneKernels{sweep<kModel, kCurrents, true>, sweep_word<kModel, kCurrents, true>,
                               advance_picked<kModel, kCurrents, true, true>,
                               advance_picked<kModel, kCurrents, true, false>}
             : MembraneKernels{sweep<kModel, kCurrents, false>, sweep_word<kModel, kCurrents, false>,
                               advance_picked<kModel, kCurrents, false, true>,
                               advance_picked<kModel, kCurrents, false, false>};
}

inline MembraneKernels choose_kernels(ModelKind model, std::uint32_t current_count, bool own) noexcept {
  if (model == ModelKind::LifDelta) {
    return kernels_for<ModelKind::LifDelta, 0>(own);
  }
  if (model == ModelKind::Alif) {
    return kernels_for<ModelKind::Alif, kAnyCount>(own);
  }
  switch (current_count) {
    case 1:
      return kernels_for<ModelKind::LifExp, 1>(own);
    case 2:
      return kernels_for<ModelKind::LifExp, 2>(own);
    case 3:
      return kernels_for<ModelKind::LifExp, 3>(own);
    default:
      return kernels_for<ModelKind::LifExp, kAnyCount>(own);
  }
}
