#include "engine/integrators/descent/descent.h"

#include <algorithm>

#include "engine/base/interrupt.h"
#include "engine/core/equations/lagged_dissipation.h"

namespace truestep {

Descent::Descent(Motion& m)
    : m_(m),
      w_(m.field.inverse_mass(m.state)),
      x0_(m.scratch("descent.x0", m.x.size())),
      v0_(m.scratch("descent.v0", m.x.size())),
      u_(m.scratch("descent.u", m.x.size())) {
  std::copy(m.x.begin(), m.x.end(), x0_.begin());
  std::copy(m.v.begin(), m.v.end(), v0_.begin());
}

std::span<const double> Descent::velocity(std::span<const double> x) {
  const double per_h = 1 / h();
  m_.loop(x.size(), [&](size_t k) { u_[k] = (x[k] - x0_[k]) * per_h; });
  return u_;
}

void Descent::gradient(std::span<const double> x, std::span<double> r) {
  const auto u = velocity(x);
  interruption_point();
  Evaluation e{m_.input.workspace, m_.input.arena};
  const Phase at{t_end(), x, u, m_.state};
  if (const LaggedDissipation* lagged = m_.field.lagged_dissipation()) {
    lagged->lagged_acceleration(at, x0_, r, e);
  } else {
    m_.field.acceleration(at, r, e);
  }
  const double per_h = 1 / h();
  m_.input.arena.for_blocks(w_.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double mass = w_[i] > 0 ? 1 / w_[i] : 0;
      for (size_t k = 3 * i; k < 3 * i + 3; ++k) r[k] = mass * ((u[k] - v0_[k]) * per_h - r[k]);
    }
  });
}

void Descent::finish(std::span<const double> x) {
  const double per_h = 1 / h();
  m_.input.arena.for_blocks(w_.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
        m_.v[k] = w_[i] > 0 ? (x[k] - x0_[k]) * per_h : v0_[k];
        m_.x[k] = w_[i] > 0 ? x[k] : x0_[k] + h() * v0_[k];
      }
    }
  });
}

double Descent::dot(std::span<const double> a, std::span<const double> b) {
  constexpr size_t kLanes = 8;
  double s[kLanes] = {};
  size_t k = 0;
  for (; k + kLanes <= a.size(); k += kLanes) {
    for (size_t l = 0; l < kLanes; ++l) s[l] += a[k + l] * b[k + l];
  }
  double total = 0;
  for (const double part : s) total += part;
  for (; k < a.size(); ++k) total += a[k] * b[k];
  return total;
}

}  // namespace truestep
