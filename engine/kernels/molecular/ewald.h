// The smooth part of Coulomb's sum over all images of a periodic box (Ewald 1921; Allen, Tildesley 1987,
// section 5.5.2), surrounded by a conductor:
//   U = 4 pi k / V sum over half of all k of A(k) |S(k)|^2 - k alpha / sqrt(pi) sum q^2
//       - pi k Q^2 / (2 V alpha^2)
//   A = exp(-k^2 / 4 alpha^2) / k^2,    S(k) = sum q_i exp(i k . x_i)
// The pair part is in pair_law.h. Sums over atoms use fixed blocks: the same bits for any number of threads.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/math/vec3.h"

namespace truestep::molecular {

struct EwaldSetting {
  double coulomb = 0;  ///< N m^2/C^2
  double alpha = 0;    ///< 1/m
  double k_max = 0;    ///< 1/m, longest wave vector
  friend bool operator==(const EwaldSetting&, const EwaldSetting&) = default;
};
/// alpha and k_max such that the truncation errors of both sums are about `accuracy` at the cut-off (m).
EwaldSetting ewald_setting(double coulomb, double cutoff, double accuracy);

struct EwaldEnergy {
  double energy = 0, virial = 0;  ///< J
};

/// Keeps its arrays from call to call.
class EwaldSum {
 public:
  /// Energy of n x 3 positions (m) and charges (C); adds forces (N) to n x 3 `force` unless that is empty.
  EwaldEnergy add(const EwaldSetting& s, const Vec3& edges, std::span<const double> x,
                  std::span<const double> charge, std::span<double> force, const ThreadArena& arena);

 private:
  static constexpr size_t kBlock = 64;
  /// Waves with wave numbers (nx, ny, from ... to - 1 of nz), stored from `first` on.
  struct Row {
    int nx, ny, from, to;
    size_t first;
  };
  /// exp(i 2 pi n x / L) of a block's atoms for n = 0 ... largest, along each axis.
  struct Tables {
    std::vector<double> c[3], s[3];
  };
  void plan(const EwaldSetting& s, const Vec3& edges);
  void fill(const Vec3& edges, std::span<const double> x, size_t begin, size_t end, Tables& t) const;

  EwaldSetting planned_;
  Vec3 edges_;
  std::vector<Row> rows_;
  size_t waves_ = 0;
  int most_[3] = {};
  std::vector<double> weight_;  // of every wave: 4 pi k / V A, J/C^2
  std::vector<double> sums_;    // blocks x waves x 2, then reduced into the first
  std::vector<Tables> tables_;  // one per block
};

}  // namespace truestep::molecular
