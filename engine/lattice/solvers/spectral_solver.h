// (shift I - step L) x = b for constant coefficients: transforms along every axis that diagonalize L, one
// division per wave, and the inverse transforms (the classical fast solver; Buzbee, Golub, Nielson 1970,
// section 2). Exact to rounding for any step and both orders in space.
#pragma once
#include <optional>

#include "engine/lattice/solvers/shifted_solver.h"
#include "engine/math/solvers/trig_transform.h"

namespace truestep::lattice {

class SpectralSolver final : public ShiftedSolver {
 public:
  /// Whether such transforms exist for the operator.
  static bool serves(const Diffusion& diffusion);
  explicit SpectralSolver(const Diffusion& diffusion);

  bool factor(double shift, double step) override;
  bool factor(Complex shift, Complex step) override;
  void solve(double* b, const ThreadArena& arena) override;
  void solve(double* re, double* im, const ThreadArena& arena) override;

 private:
  void move_given(double* b, double with, double* to, const ThreadArena& arena);
  template <class Divide>
  void divide(const ThreadArena& arena, Divide&& divide) const;
  enum class Way : uint8_t { forward, backward };
  void transform(double* x, Way way, const ThreadArena& arena);

  Diffusion diffusion_;
  std::vector<TrigTransform> transforms_;
  std::array<std::vector<double>, 3> eigenvalues_;
  std::vector<uint32_t> fixed_;
  double shift_ = 1, step_ = 0;
  Complex complex_shift_, complex_step_;  ///< methods keep a real and a complex matrix at the same time
  std::vector<double, CacheLineAllocator<double>> given_, moved_, re_, im_;
  std::vector<double> kept_;
};

}  // namespace truestep::lattice
