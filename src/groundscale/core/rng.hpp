#pragma once

#include <cstdint>

namespace groundscale {

/// Random numbers that are the same on every platform: xoshiro256** seeded by splitmix64 (Blackman, Vigna 2018).
///
/// Handed on by reference from one place, seeded from the configuration; there is no global generator. The standard
/// library's distributions differ between implementations, so the few that are needed are here.
class Rng {
 public:
  explicit Rng(std::uint64_t seed);

  std::uint64_t next();
  /// Uniform in [0, 1).
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in {0, ..., count - 1}; count > 0.
  int index(int count);
  /// Standard normal (Marsaglia's polar method).
  double normal();

 private:
  std::uint64_t state_[4];
};

}  // namespace groundscale
