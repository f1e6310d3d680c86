// A property that must hold of every input. Stays on in release builds, unlike assert.
#pragma once

#include <cstdio>
#include <cstdlib>

#define TECTUM_EXPECT(condition)                                                          \
  do {                                                                                    \
    if (!(condition)) {                                                                   \
      std::fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                       \
    }                                                                                     \
  } while (false)
