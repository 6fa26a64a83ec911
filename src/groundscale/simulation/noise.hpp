#pragma once

#include <cstdint>

namespace groundscale {

/// A number from 0 to 1 (not 1 itself) for a cell of a grid, as good as independent of that of any other cell or seed.
double cell_value(std::int64_t column, std::int64_t row, std::uint64_t seed);
/// The same as a seed.
std::uint64_t cell_seed(std::int64_t column, std::int64_t row, std::uint64_t seed);

/// Smooth random field over the plane, the same on every machine for a seed: cubic B-spline through independent normal
/// values on the integer lattice, which repeats after 64, evaluated at quarters of it and straight in between. Mean 0;
/// its sd is 1 on average over the plane.
double smooth_noise(double x, double y, std::uint64_t seed);

/// A sum of smooth noise of ever shorter wavelengths.
struct FractalNoise {
  std::uint64_t seed = 0;
  double longest_m = 1.0;    ///< Lattice spacing of the first octave; each next one has half of it.
  int octaves = 1;           ///< At least 1.
  double first_sd = 1.0;     ///< Of the first octave.
  double persistence = 1.0;  ///< Sd of an octave over that of the one before.

  /// Estimate of the average over a square patch of side `footprint_m`: octaves that the patch averages out are left
  /// away, so that what is far off neither flickers nor costs time.
  double at(double x_m, double y_m, double footprint_m) const;
};

}  // namespace groundscale
