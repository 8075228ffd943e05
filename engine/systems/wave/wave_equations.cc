// Waves as first-order equations y = (u, v) and as second-order equations; implicit methods solve for v
// alone, (1 + z k - z^2 L) q = s + z L r.
#include <algorithm>

#include "engine/systems/wave/wave.h"

namespace truestep::wave {

WaveEquations::WaveEquations(lattice::LatticeWork& work, const lattice::Lattice& l, double damping,
                             const ThreadArena& arena)
    : work_(work),
      n_(l.nodes()),
      damping_(damping),
      arena_(arena),
      fixed_(work.fixed()),
      product_(work.scratch()) {}

void WaveEquations::rate(double t, const double* y, double* dydt) const {
  std::copy_n(y + n_, n_, dydt);
  acceleration(t, y, y + n_, dydt + n_);
}

void WaveEquations::acceleration(double t, const double* x, const double* v, double* a) const {
  if (damping_ == 0) return work_.rate(t, x, a);
  work_.homogeneous(t, x, a);
  for (size_t i = 0; i < n_; ++i) a[i] -= damping_ * v[i];
  // After the damping: nodes with prescribed values have only their side's acceleration.
  work_.force(t, a);
}

void WaveEquations::jacobian(double t, const double*, const double*, double* dadx, double* dadv) const {
  work_.move_to(t);
  const auto& m = work_.matrix();
  std::ranges::copy(m.values, dadx);
  for (size_t j = 0; j < n_; ++j) {
    for (auto k = static_cast<size_t>(m.column_start[j]); k < static_cast<size_t>(m.column_start[j + 1]);
         ++k) {
      dadv[k] = static_cast<size_t>(m.rows[k]) == j ? -damping_of(j) : 0;
    }
  }
}

LinearSolver* WaveEquations::linear_solver() const {
  return work_.solver() ? const_cast<WaveEquations*>(this) : nullptr;
}

// (1 + z k - z^2 L) q = s + z L r,  p = r + z q  for b = (r, s), x = (p, q).
bool WaveEquations::factor(double z) {
  z_ = z;
  return work_.solver()->factor(1 + z * damping_, z * z);
}
bool WaveEquations::factor(Complex z) {
  complex_z_ = z;
  return work_.solver()->factor(Complex(1) + damping_ * z, z * z);
}
void WaveEquations::solve(double* b) {
  double *r = b, *s = b + n_, *l = product_.data();
  work_.diffusion().apply(r, l, 0, 1, arena_);
  const double z = z_;
  for (size_t i = 0; i < n_; ++i) s[i] += z * l[i];
  work_.solver()->solve(s, arena_);
  for (size_t i = 0; i < n_; ++i) r[i] += z * s[i];
}
void WaveEquations::solve(double* re, double* im) {
  double* l = product_.data();
  double *sr = re + n_, *si = im + n_;
  work_.diffusion().apply(re, l, 0, 1, arena_);
  for (size_t i = 0; i < n_; ++i) sr[i] += complex_z_.re * l[i], si[i] += complex_z_.im * l[i];
  work_.diffusion().apply(im, l, 0, 1, arena_);
  for (size_t i = 0; i < n_; ++i) sr[i] -= complex_z_.im * l[i], si[i] += complex_z_.re * l[i];
  work_.solver()->solve(sr, si, arena_);
  for (size_t i = 0; i < n_; ++i) {
    re[i] += complex_z_.re * sr[i] - complex_z_.im * si[i];
    im[i] += complex_z_.re * si[i] + complex_z_.im * sr[i];
  }
}
bool WaveEquations::factor_second_order(double with_x, double with_v) {
  return work_.solver()->factor(1 + with_v * damping_, with_x);
}
void WaveEquations::solve_second_order(double* b) {
  work_.solver()->solve(b, arena_);
}

}  // namespace truestep::wave
