#pragma once
// Seeds of tests with random input: another one each time, printed, and LIMN_SEED=N to have one again.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace limn {

inline std::uint32_t random_seed() {
  const char* const wanted = std::getenv("LIMN_SEED");
  const std::uint32_t seed = wanted != nullptr ? static_cast<std::uint32_t>(std::strtoul(wanted, nullptr, 10)) : std::random_device{}();
  std::printf("seed %u (LIMN_SEED=%u draws the same again)\n", seed, seed);
  return seed;
}

}  // namespace limn
