#include "engine/systems/fem/barrier/barrier_newton.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"

namespace truestep::fem {

namespace {

constexpr int kMostIterations = 60;
/// Share of the gap that an advance aims at.
constexpr double kAim = 0.1;
/// Share of the reach: a shorter Newton step ends the search.
constexpr double kNear = 1e-2;
/// Share of the reach: a gap that shrinks below it doubles the barrier's stiffness.
constexpr double kThin = 1e-4;
/// Share of the shortest edge by which pairs are searched further than needed.
constexpr double kSlack = 0.1;
constexpr double kNoise = 1e-12;

// The share of the step at which at most kLeftOfGap of the gap is left, by conservative advancement;
// gap(share).
template <class Gap>
double share_before(double share, double speed, Gap gap) {
  const double start = gap(0.0);
  double t = 0, left = start;
  for (int k = 0; k < 1000; ++k) {
    t += (left - kAim * start) / speed;
    if (!(t < share)) return share;
    left = gap(t);
    if (left <= kLeftOfGap * start) return t;
  }
  return t;
}

}  // namespace

double relative_way(const FeaturePair& p, std::span<const double> d) {
  FeaturePoints dx = p.at(d);
  const Vec3 mean = (dx[0] + dx[1] + dx[2] + dx[3]) * 0.25;
  double first = 0, second = 0;
  for (size_t i = 0; i < 4; ++i) {
    double& most = i < (p.edges ? 2u : 1u) ? first : second;
    most = std::max(most, norm2(dx[i] - mean));
  }
  return std::sqrt(first) + std::sqrt(second);
}

void BarrierNewton::find_pairs(BarrierWork& k, std::span<const double> d) const {
  const double slack = std::max(k.law.reach, kSlack * surface_.shortest_edge());
  const size_t rows = k.all / 3;
  bool good = k.searched;
  for (size_t i = 0; i < rows && good; ++i) {
    for (size_t c = 0; c < 3 && good; ++c) {
      const double a = k.x[3 * i + c], b = d.empty() ? a : a + d[3 * i + c];
      good = std::min(a, b) >= k.ways[6 * i + c] - slack && std::max(a, b) <= k.ways[6 * i + 3 + c] + slack;
    }
  }
  if (good) return;
  for (size_t i = 0; i < rows; ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const double a = k.x[3 * i + c], b = d.empty() ? a : a + d[3 * i + c];
      k.ways[6 * i + c] = std::min(a, b), k.ways[6 * i + 3 + c] = std::max(a, b);
    }
  }
  surface_.find_pairs(k.x, d, k.law.reach + 2 * slack, k.pairs);
  k.searched = true;
}

double BarrierNewton::evaluate(BarrierWork& k, std::span<const double> x, bool slopes) const {
  const double h = k.in.h;
  for (size_t i = 0; i < k.n; ++i) k.v[i] = (x[i] - k.x0[i]) / h;
  const Phase at{k.in.t + h, x.first(k.n), k.v, k.state};
  const double v = *field_.potential(at, k.e), r = *field_.dissipation(at, k.e);
  double inertia = 0;
  const auto& m = field_.body().masses;
  for (size_t i = 0; i < k.n; ++i) {
    if (k.w[i / 3] > 0) inertia += 0.5 * m[i / 3] * (x[i] - k.to[i]) * (x[i] - k.to[i]);
  }
  BarrierOutput out;
  if (slopes) {
    std::fill(k.gradient.begin(), k.gradient.end(), 0.0);
    k.forms.clear(), k.touches.clear();
    out.gradient = k.gradient, out.forms = &k.forms, out.touches = &k.touches, out.slip = k.slip;
  }
  const double contact = barrier_energy(surface_, k.law, {x, k.tau}, k.pairs, out);
  if (!std::isfinite(contact)) return HUGE_VAL;
  const double slip = friction_energy(k.law, k.friction, k.x0, x, k.n / 3, out);
  k.least_gap = out.least_gap;
  if (slopes) {
    field_.acceleration(at, k.a, k.e);
    for (size_t i = 0; i < k.n; ++i) {
      const bool held = !(k.w[i / 3] > 0) || field_.body().axes[i / 3] >> (i % 3) & 1;
      k.gradient[i] = held ? 0 : m[i / 3] * (x[i] - k.to[i]) + h * h * (k.gradient[i] - m[i / 3] * k.a[i]);
    }
    field_.definite_jacobian(at, k.system.dfdx, k.system.dfdv, k.e);
  }
  k.magnitude = inertia + h * h * (std::abs(v) + field_.cancelling_terms(k.state) + contact + slip);
  return inertia + h * h * (v + h * r + contact + slip);
}

// Newton's direction: (M - h^2 df/dx - h df/dv + h^2 forms) d = -gradient.
void BarrierNewton::direction(BarrierWork& k) const {
  BarrierWork::System& s = k.system;
  const double h = k.in.h;
  std::vector<BlockSparse::Pair>& extra = s.extra;
  std::vector<BlockSparse::Pair> wanted;
  const uint32_t nodes = static_cast<uint32_t>(k.n / 3);
  for (const BarrierHessian& f : k.forms) {
    for (uint32_t i = 0; i < f.count; ++i) {
      for (uint32_t j = i + 1; j < f.count; ++j) {
        if (f.rows[i] >= nodes || f.rows[j] >= nodes) continue;
        wanted.push_back({std::min(f.rows[i], f.rows[j]), std::max(f.rows[i], f.rows[j])});
      }
    }
  }
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  if (s.a.empty() || wanted != extra) {
    extra = wanted;
    s.pattern = field_.body().pairs;
    s.pattern.insert(s.pattern.end(), extra.begin(), extra.end());
    s.a.set_pattern(nodes, 3, s.pattern);
    s.slots.clear();
    for (uint32_t i = 0; i < nodes; ++i) {
      for (auto b = s.dfdx.row_begin(i); b < s.dfdx.row_begin(i + 1); ++b)
        s.slots.push_back(s.a.slot(i, s.dfdx.column(b)));
    }
  }
  s.a.set_zero();
  for (BlockSparse::Slot b = 0; b < s.slots.size(); ++b)
    s.a.add_block(s.slots[b], s.dfdx.block(b).data(), -h * h);
  for (uint32_t i = 0; i < nodes; ++i)
    s.a.add_block(s.a.diagonal_slot(i), s.dfdv.block(s.dfdv.diagonal_slot(i)).data(), -h);
  for (const BarrierHessian& f : k.forms) {
    double block[9];
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) block[3 * c + r] = f.m(r, c);
    }
    for (uint32_t i = 0; i < f.count; ++i) {
      for (uint32_t j = 0; j < f.count; ++j) {
        if (f.rows[i] < nodes && f.rows[j] < nodes)
          s.a.add_block(s.a.slot(f.rows[i], f.rows[j]), block, h * h * f.c[i] * f.c[j]);
      }
    }
  }
  // Prescribed components keep their position.
  const Body& body = field_.body();
  const auto fixed = [&](uint32_t i) -> uint8_t { return k.w[i] > 0 ? body.axes[i] : 7; };
  for (uint32_t i = 0; i < nodes; ++i) {
    const uint8_t rows = fixed(i);
    for (auto b = s.a.row_begin(i); b < s.a.row_begin(i + 1); ++b) {
      const uint32_t j = s.a.column(b);
      const uint8_t columns = fixed(j);
      const auto block = s.a.block(b);
      for (size_t c = 0; c < 9 && (rows | columns); ++c) {
        if ((rows >> (c % 3) & 1) | (columns >> (c / 3) & 1)) block[c] = 0;
      }
      for (size_t c = 0; i == j && c < 3; ++c) block[4 * c] += body.masses[i];
    }
  }
  for (size_t i = 0; i < k.n; ++i) k.gradient[i] = -k.gradient[i];
  const auto result =
      s.solver.solve(s.a, k.gradient, k.d.first(k.n), {.tolerance = 1e-6, .condition = 1e6}, k.in.arena);
  for (size_t i = 0; i < k.n; ++i) k.gradient[i] = -k.gradient[i];
  if (!result.solved)
    throw Instability("", "position", -1, "the matrix of a step is singular; a smaller dt would help");
}

// Features that turn about each other come closer than their initial normals predict, by e. To make Newton's
// direction p exact for such gaps, x + p + q is used, where the same matrix times q = the forces of the
// errors e (a second-order correction; Nocedal, Wright 2006, section 15.6). Without it a needle that slips
// along an edge advances in tiny steps.
void BarrierNewton::bend(BarrierWork& k) const {
  constexpr double kWorthIt = 0.1;
  const double h = k.in.h;
  const size_t nodes = k.n / 3;
  bool any = false;
  const auto push = k.push;
  std::fill(push.begin(), push.end(), 0.0);
  for (const BarrierTouch& t : k.touches) {
    const FeaturePoints x = t.pair->at(k.x), d = t.pair->at(k.d);
    FeaturePoints there;
    double predicted = t.gap;
    for (size_t i = 0; i < 4; ++i)
      there[i] = x[i] + d[i], predicted += t.near.c[i] * dot(t.near.normal, d[i]);
    const Proximity after = t.pair->closest(there);
    Vec3 apart;
    for (size_t i = 0; i < 4; ++i) apart += after.c[i] * there[i];
    const double e = dot(apart, t.near.normal) - static_cast<double>(t.pair->radius) - predicted;
    if (!(e < -kWorthIt * t.gap)) continue;
    any = true;
    for (size_t i = 0; i < 4; ++i) {
      const uint32_t row = t.pair->rows[i];
      if (row < nodes && k.w[row] > 0)
        store3(push.data(), row,
               load3(push.data(), row) - (h * h * t.curvature * e * t.near.c[i]) * t.near.normal);
    }
  }
  if (!any) return;
  for (size_t i = 0; i < k.n; ++i) {
    if (field_.body().axes[i / 3] >> (i % 3) & 1) push[i] = 0;
  }
  const auto q = k.trial.first(k.n);
  k.system.solver.solve_again(k.system.a, push, q, 1e-6, k.in.arena);
  double slope = 0;
  for (size_t i = 0; i < k.n; ++i) slope += k.gradient[i] * (k.d[i] + q[i]);
  // Only while the direction still descends.
  for (size_t i = 0; i < k.n && slope < 0; ++i) k.d[i] += q[i];
}

double BarrierNewton::safe_share(const BarrierWork& k, std::span<const double> d) const {
  double share = 1;
  for (const FeaturePair& p : k.pairs) {
    const FeaturePoints x = p.at(k.x);
    const FeaturePoints dx = p.at(d);
    const double speed = relative_way(p, d);
    if (!(speed > 0)) continue;
    share = share_before(share, speed, [&](double t) {
      FeaturePoints there;
      for (size_t i = 0; i < 4; ++i) there[i] = x[i] + dx[i] * t;
      return p.closest(there).distance - static_cast<double>(p.radius);
    });
  }
  for (const Wall& wall : surface_.walls()) {
    for (const uint32_t p : surface_.surface_nodes()) {
      const Vec3 x = load3(k.x.data(), p), dx = load3(d.data(), p);
      const double speed = norm(dx);
      if (!(speed > 0)) continue;
      share = share_before(share, speed,
                           [&](double t) { return surface_.wall_gap(wall, k.tau, x + t * dx).gap; });
    }
  }
  return share;
}

void BarrierNewton::minimise(BarrierWork& k) const {
  for (int it = 0;; ++it) {
    interruption_point();
    find_pairs(k, {});
    k.energy = evaluate(k, k.x, true);
    const double gap = k.least_gap, noise = kNoise * k.magnitude;
    if (!std::isfinite(k.energy))
      throw Instability("", "position", -1, "features of the surface touch at the start of the step");
    direction(k);
    std::fill(k.d.begin() + static_cast<std::ptrdiff_t>(k.n), k.d.end(), 0.0);
    bend(k);
    double most = 0, slope = 0;
    for (size_t i = 0; i < k.n; ++i) {
      if (!std::isfinite(k.d[i]))
        throw Instability("", "position", static_cast<long long>(i / 3), "forces are not finite");
      most = std::max(most, std::abs(k.d[i]));
      slope += k.d[i] * k.gradient[i];
    }
    const bool last = most <= kNear * k.law.reach;
    find_pairs(k, k.d);
    const double safe = safe_share(k, k.d);
    double share = safe;
    for (;; share *= 0.5) {
      for (size_t i = 0; i < k.all; ++i) k.trial[i] = k.x[i] + share * k.d[i];
      const double energy = evaluate(k, k.trial, false);
      if (energy <= k.energy + 1e-4 * share * slope + noise) break;
      if (share * most < 1e-12 * field_.body().mesh.diagonal()) return;
    }
    std::copy(k.trial.begin(), k.trial.end(), k.x.begin());
    if (last) return;
    k.slip = share < 0.5 * safe ? BarrierOutput::Slip::above : BarrierOutput::Slip::exact;
    if (it >= kMostIterations) {
      throw Instability("", "position", -1,
                        "Newton's method found no state without contact (" + std::to_string(it) +
                            " iterations); a smaller dt would help");
    }
    if (k.least_gap < kThin * k.law.reach && k.least_gap < gap) k.law.stiffness *= 2;
  }
}

}  // namespace truestep::fem
