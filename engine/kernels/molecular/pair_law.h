// The sum over one atom's neighbours of Lennard-Jones and Coulomb, four neighbours at a time:
//   f_i = sum_j s(r) (x_i - x_j),    s = -U'(r) / r
// Coulomb ends at the cut-off as k q q (1/r + a r^2 + b r + c): a reaction field (Barker, Watts 1973) or a
// force that is shifted to 0; or it is the direct part of Ewald's sum. Lists are padded to multiples of four
// with a row far from everything. Both ends of a pair compute it, with exactly opposite results; sums follow
// the list's order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/kernels/molecular/erf_series.h"
#include "engine/kernels/molecular/lennard_jones.h"
#include "engine/math/vec3.h"

namespace truestep::molecular {

struct PairLaw {
  enum class Charges : uint8_t { none, cutoff, ewald };

  size_t kinds = 1;
  std::vector<double> table;  ///< kinds x kinds rows of 4: c12, c6, shift, 0
  Truncation truncation = Truncation::truncated;
  double cutoff2 = 0, from2 = 0;  ///< m^2: rc^2, rs^2 of a switched potential
  /// m^2: closer atoms are treated as this close in the magnitude of the force, so that it stays finite.
  double floor2 = 0;
  Charges charges = Charges::none;
  double coulomb = 0;          ///< N m^2/C^2
  double a = 0, b = 0, c = 0;  ///< 1/m^3, 1/m^2, 1/m, see above
  double alpha = 0;            ///< 1/m, Ewald's splitting
  ErfSeries erf{};

  LjPair lj(size_t p, size_t q) const {
    const double* row = table.data() + 4 * (p * kinds + q);
    return {row[0], row[1], row[2]};
  }
};

/// Atoms and their images in the order of the list: rows of x, y, z (m) and charge (C), 32-byte aligned, and
/// kinds, whose column is only read if there are several.
struct PairRows {
  const double* rows;
  const uint32_t* kinds;
};

struct PairSum {
  Vec3 force;         ///< N
  double energy = 0;  ///< J: half of every pair
  double virial = 0;  ///< J: half of r . f of every pair
};

/// Sum over `count` neighbours (a multiple of four) of the row i. Energy and virial are 0 when only forces
/// are requested.
using PairSumFunction = PairSum (*)(const PairLaw&, const PairRows&, uint32_t i, const uint32_t* list,
                                    size_t count);
enum class Wanted : uint8_t { forces, energies };
PairSumFunction pair_sum_function(const PairLaw& law, Wanted wanted);

}  // namespace truestep::molecular
