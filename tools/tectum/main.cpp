#include <iostream>

#include "tools/tectum/tectum_main.h"

int main(int argc, char** argv) {
  std::ios::sync_with_stdio(false);
  return tectum::tectum_main({argv + 1, argv + argc}, std::cout, std::cerr);
}
