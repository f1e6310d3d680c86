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
//   take_inputs(int32*, count)    quanta as floats, 0 beyond `count`; zeroes what it read
//   was_refractory(uint16*)       who is refractory; takes one tick off
//   is_refractory(uint16*)        who still is
// The semantics are those of MembraneGroup::advance_neuron, bit for bit.

/// Number of currents not known when the kernel is compiled.
constexpr std::uint32_t kAnyCount = 0xFFFFFFFFU;

struct VectorResult {
  std::uint64_t fired;
  std::uint64_t may_sleep;
};

// Advances the vector of neurons that starts at `i`, of which `count` exist and `lanes` are meant.
template <ModelKind kModel, std::uint32_t kCurrents, bool kOwn, bool kMasked, bool kDust>
[[gnu::always_inline]] inline VectorResult advance_vector(const MembraneArgs& a, std::int32_t* inputs, std::size_t i,
                                                          std::uint32_t count, std::uint64_t lanes) noexcept {
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
    const typename Vec::F loaded = Vec::load(a.currents + c * a.stride + i);
    if constexpr (kMasked && !kIsDelta) {
      old[c] = loaded;
    }
    const typename Vec::F current = kDust ? Vec::without_dust(loaded) : loaded;
    u = Vec::add(u, Vec::mul(Vec::set1(a.gain[c]), current));
    now[c] = Vec::mul(Vec::set1(a.current_decay[c]), current);
    if (c < arriving) {
      now[c] = Vec::add(now[c], Vec::take_inputs(inputs + c * a.input_stride + i, count));
    }
  }
  if constexpr (kIsDelta) {
    for (std::uint32_t r = 0; r < a.receptor_count; ++r) {
      const typename Vec::F quanta = Vec::take_inputs(inputs + r * a.input_stride + i, count);
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
  for (std::uint64_t left = fired; left != 0; left &= left - 1) {
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
    Vec::store(a.currents + c * a.stride + i, now[c]);
  }
  return {fired, may_sleep};
}

constexpr std::uint64_t kAllLanes = ~std::uint64_t{0} >> (64 - Vec::kWidth);

template <ModelKind kModel, std::uint32_t kCurrents, bool kOwn, bool kDust>
std::uint32_t sweep_all(const MembraneArgs& args, std::int32_t* inputs, std::uint32_t begin, std::uint32_t end,
                        std::uint32_t* fired) noexcept {
  const MembraneArgs a = args;  // a copy that no store can touch, so that it stays in registers
  std::uint32_t fired_count = 0;
  const auto emit = [&](std::uint64_t bits, std::uint32_t first) {
    for (; bits != 0; bits &= bits - 1) {
      fired[fired_count++] = first + static_cast<std::uint32_t>(__builtin_ctzll(bits));
    }
  };
  std::uint32_t i = begin;
  for (; i + Vec::kWidth <= end; i += Vec::kWidth) {
    emit(advance_vector<kModel, kCurrents, kOwn, false, kDust>(a, inputs, i, Vec::kWidth, kAllLanes).fired, i);
  }
  if (i < end) {
    const std::uint64_t lanes = kAllLanes >> (Vec::kWidth - (end - i));
    emit(advance_vector<kModel, kCurrents, kOwn, false, kDust>(a, inputs, i, end - i, lanes).fired, i);
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
  MembraneWord result{0, 0};
  for (std::uint32_t k = 0; k < 64; k += Vec::kWidth) {
    const std::uint64_t here = (lanes >> k) & kAllLanes;
    if (here == 0) {
      continue;
    }
    const std::uint32_t i = 64 * word + k;
    const std::uint32_t count = args.size - i < Vec::kWidth ? args.size - i : Vec::kWidth;
    const VectorResult vector =
        tick.removes_dust ? advance_vector<kModel, kCurrents, kOwn, true, true>(args, tick.inputs, i, count, here)
                          : advance_vector<kModel, kCurrents, kOwn, true, false>(args, tick.inputs, i, count, here);
    result.fired |= vector.fired << k;
    result.may_sleep |= vector.may_sleep << k;
  }
  return result;
}

template <ModelKind kModel, std::uint32_t kCurrents>
MembraneKernels kernels_for(bool own) noexcept {
  return own ? MembraneKernels{sweep<kModel, kCurrents, true>, sweep_word<kModel, kCurrents, true>}
             : MembraneKernels{sweep<kModel, kCurrents, false>, sweep_word<kModel, kCurrents, false>};
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
