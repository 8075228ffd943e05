#include "engine/systems/fem/barrier/barrier_terms.h"

#include <cmath>

namespace truestep::fem {

namespace {

Mat3 outer(const Vec3& n, double scale) {
  const double v[3] = {n.x, n.y, n.z};
  Mat3 out;
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) out(r, c) = scale * v[r] * v[c];
  }
  return out;
}

void add(std::span<double> g, uint32_t row, const Vec3& what) {
  if (3 * size_t(row) < g.size()) store3(g.data(), row, load3(g.data(), row) + what);
}

}  // namespace

double barrier_energy(const BarrierSurface& surface, const BarrierLaw& law, const BarrierPlace& at,
                      std::span<const FeaturePair> pairs, BarrierOutput& out) {
  double sum = 0;
  for (const FeaturePair& pair : pairs) {
    const FeaturePoints x = pair.at(at.x);
    const Proximity near = pair.closest(x);
    const double gap = near.distance - static_cast<double>(pair.radius);
    out.least_gap = std::min(out.least_gap, gap);
    if (!(gap > 0)) return HUGE_VAL;
    if (gap >= law.reach) continue;
    ++out.touching;
    const barrier::Slope2 b = barrier::log_barrier(gap, law.reach);
    const barrier::Mollifier m = pair.edges ? barrier::mollifier(x, pair.parallel) : barrier::Mollifier{};
    sum += m.value * b.value;
    if (!out.gradient.empty()) {
      for (size_t i = 0; i < 4; ++i) {
        add(out.gradient, pair.rows[i],
            law.stiffness * (m.value * b.first * near.c[i] * near.normal + b.value * m.slope[i]));
      }
    }
    if (!out.forms) continue;
    out.forms->push_back({pair.rows, near.c, 4, outer(near.normal, law.stiffness * m.value * b.second)});
    if (out.touches) out.touches->push_back({&pair, near, gap, law.stiffness * m.value * b.second});
    if (m.by_c == 0) continue;
    // Hessian of c = |u x v|^2 with u nearly parallel to v: 2 |(du - r dv) x v|^2, r = u.v / v.v.
    const Vec3 u = x[1] - x[0], v = x[3] - x[2];
    const double r = dot(u, v) / norm2(v), scale = 2 * law.stiffness * b.value * m.by_c;
    Mat3 across = outer(v, -scale);
    for (size_t k = 0; k < 3; ++k) across(k, k) += scale * norm2(v);
    out.forms->push_back({pair.rows, {-1, 1, r, -r}, 4, across});
  }
  for (const Wall& wall : surface.walls()) {
    for (const uint32_t p : surface.surface_nodes()) {
      const WallGap w = surface.wall_gap(wall, at.t, load3(at.x.data(), p));
      out.least_gap = std::min(out.least_gap, w.gap);
      if (!(w.gap > 0)) return HUGE_VAL;
      if (w.gap >= law.reach) continue;
      ++out.touching;
      const barrier::Slope2 b = barrier::log_barrier(w.gap, law.reach);
      sum += b.value;
      if (!out.gradient.empty()) add(out.gradient, p, law.stiffness * b.first * w.normal);
      if (out.forms) out.forms->push_back({{p}, {1}, 1, outer(w.normal, law.stiffness * b.second)});
    }
  }
  return law.stiffness * sum;
}

void look_at_friction(const BarrierSurface& surface, const BarrierLaw& law, const BarrierPlace& at,
                      double start, std::span<const FeaturePair> pairs, std::vector<FrictionTerm>& out) {
  out.clear();
  for (const FeaturePair& pair : pairs) {
    if (!(pair.friction > 0)) continue;
    const FeaturePoints x = pair.at(at.x);
    const Proximity near = pair.closest(x);
    const double gap = near.distance - static_cast<double>(pair.radius);
    if (!(gap > 0) || gap >= law.reach) continue;
    const double share = pair.edges ? barrier::mollifier(x, pair.parallel).value : 1;
    const double force = -law.stiffness * share * barrier::log_barrier(gap, law.reach).first;
    out.push_back({pair.rows, near.c, 4, near.normal, {}, static_cast<double>(pair.friction) * force});
  }
  for (const Wall& wall : surface.walls()) {
    const double friction = surface.wall_friction(wall);
    if (!(friction > 0)) continue;
    for (const uint32_t p : surface.surface_nodes()) {
      const Vec3 x = load3(at.x.data(), p);
      const WallGap w = surface.wall_gap(wall, at.t, x);
      if (!(w.gap > 0) || w.gap >= law.reach) continue;
      const double force = -law.stiffness * barrier::log_barrier(w.gap, law.reach).first;
      out.push_back({{p}, {1}, 1, w.normal, surface.wall_shift(wall, start, at.t, x), friction * force});
    }
  }
}

double friction_energy(const BarrierLaw& law, std::span<const FrictionTerm> terms, std::span<const double> x0,
                       std::span<const double> x, size_t nodes, BarrierOutput& out) {
  double sum = 0;
  for (const FrictionTerm& f : terms) {
    Vec3 u = -f.shift;
    for (uint32_t i = 0; i < f.count; ++i)
      u += f.c[i] * (load3(x.data(), f.rows[i]) - load3(x0.data(), f.rows[i]));
    u -= dot(u, f.normal) * f.normal;
    const double y = norm(u);
    const barrier::Slope2 slip = barrier::smooth_slip(y, law.still);
    sum += f.most * slip.value;
    for (uint32_t i = 0; !out.gradient.empty() && i < f.count; ++i)
      if (f.rows[i] < nodes) add(out.gradient, f.rows[i], f.most * slip.first * f.c[i] * u);
    if (!out.forms) continue;
    // f1 / y across the slip, f1' along it, nothing along the normal. Using f1 / y for both is an upper
    // bound.
    Mat3 m = outer(f.normal, -f.most * slip.first);
    for (size_t k = 0; k < 3; ++k) m(k, k) += f.most * slip.first;
    if (y > 0 && out.slip == BarrierOutput::Slip::exact)
      m = m + outer(u / y, f.most * (slip.second - slip.first));
    out.forms->push_back({f.rows, f.c, f.count, m});
  }
  return sum;
}

}  // namespace truestep::fem
