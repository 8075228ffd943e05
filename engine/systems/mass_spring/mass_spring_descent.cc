// Support for descent methods on the potential of mass_spring_field.h: a bound of its stiffness that is
// independent of directions, and the forces on single points with their derivatives.
#include <algorithm>

#include "engine/kernels/springs/air.h"
#include "engine/kernels/springs/spring.h"
#include "engine/math/block_sparse.h"
#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep::mass_spring {

using Columns = MassSpringColumns;

namespace {

// K += alpha I + beta d d^T
void add_to_slope(PointSlope& s, double alpha, double beta, const Vec3& d) {
  double* k = s.stiffness;
  k[0] += alpha + beta * d.x * d.x, k[1] += beta * d.x * d.y, k[2] += beta * d.x * d.z;
  k[3] += alpha + beta * d.y * d.y, k[4] += beta * d.y * d.z, k[5] += alpha + beta * d.z * d.z;
}

}  // namespace

// Greedily in the order of the points.
void MassSpringField::colour_points() {
  const size_t n = network_.x.size();
  std::vector<std::vector<uint32_t>> beside(n);
  for (const auto& [a, b] : pairs_) beside[a].push_back(b), beside[b].push_back(a);
  std::vector<uint32_t> colour(n, UINT32_MAX), taken;
  std::vector<std::vector<uint32_t>> of;
  for (uint32_t i = 0; i < n; ++i) {
    taken.assign(of.size() + 1, UINT32_MAX);
    for (const uint32_t j : beside[i]) {
      if (colour[j] != UINT32_MAX) taken[colour[j]] = i;
    }
    const auto free = std::find(taken.begin(), taken.end(), UINT32_MAX) - taken.begin();
    colour[i] = static_cast<uint32_t>(free);
    if (colour[i] == of.size()) of.emplace_back();
    of[colour[i]].push_back(i);
  }
  colours_.begin = {0};
  for (const auto& points : of) {
    colours_.points.insert(colours_.points.end(), points.begin(), points.end());
    colours_.begin.push_back(static_cast<uint32_t>(colours_.points.size()));
  }
}

void MassSpringField::bound_pattern(BlockSparse& out) const {
  out.set_pattern(network_.x.size(), 1, pairs_);
}

void MassSpringField::bound(const State& state, double h, BlockSparse& out) const {
  const auto k_family = state.f64(Columns::stiffness);
  const double viscous = state.f64(Columns::damping)[0] / h, internal = state.f64(Columns::damping)[1] / h;
  const auto values = out.values();
  std::fill(values.begin(), values.end(), 0.0);
  for (uint32_t i = 0; i < network_.x.size(); ++i) {
    double sum = viscous;
    for (uint32_t r = row_begin_[i]; r < row_begin_[i + 1]; ++r) {
      if (rows_[r].spring == RowEntry::kNoSpring) continue;
      const uint32_t s = rows_[r].spring;
      const double k = k_family[static_cast<size_t>(schedule_.family[s])] * schedule_.scale[s] + internal;
      values[rows_[r].slot] -= k;
      sum += k;
    }
    values[out.diagonal_slot(i)] += sum;
  }
  // For three points in line, E = B / 2 |sum c_i x_i|^2.
  for (size_t k = 0; k < network_.bends.size(); ++k) {
    const Bend& b = network_.bends[k];
    const auto l = bending::links(network_.x[b.points[0]], network_.x[b.points[1]], network_.x[b.points[2]]);
    const double c[3] = {l.per_a, -l.per_a - l.per_b, l.per_b};
    for (size_t i = 0; i < 3; ++i) {
      for (size_t j = 0; j < 3; ++j) values[bend_slots_[k][3 * i + j]] += b.stiffness * c[i] * c[j];
    }
  }
  for (size_t k = 0; k < Columns::kHands.drags(state); ++k) {
    const UserForces::Drag d = Columns::kHands.drag(state, k);
    values[out.diagonal_slot(static_cast<uint32_t>(d.who))] += d.stiffness;
  }
}

Vec3 MassSpringField::free_acceleration(const State& state) const {
  return load3(state.f64(Columns::gravity).data(), 0);
}

void MassSpringField::air_slope(const Phase& at, std::span<const double> x_lagged, double h, size_t i,
                                PointSlope& out) const {
  const Vec3 wind = wind_at(at);
  const double *x = x_lagged.data(), *v = at.v.data();
  if (!section_.empty()) {
    const Vec3 u = wind - load3(v, i);
    out.force += air::cylinder_force(u, air_factor_, section_[i]);
    const auto [alpha, beta] = air::cylinder_slope(u, air_factor_, section_[i]);
    add_to_slope(out, alpha / h, beta / h, u);
    return;
  }
  for (uint32_t k = point_triangles_begin_[i]; k < point_triangles_begin_[i + 1]; ++k) {
    const auto& t = network_.triangles[point_triangles_[k].triangle];
    const Vec3 normal = cross(load3(x, t[1]) - load3(x, t[0]), load3(x, t[2]) - load3(x, t[0]));
    const Vec3 u = wind - (load3(v, t[0]) + load3(v, t[1]) + load3(v, t[2])) * (1.0 / 3);
    out.force += air::plate_force(normal, u, air_factor_) * (1.0 / 3);
    add_to_slope(out, 0, air::plate_slope(normal, u, air_factor_) / (9 * h), normal);
  }
}

void MassSpringField::point_slopes(const Phase& at, std::span<const double> x_lagged, double h,
                                   std::span<const uint32_t> points, std::span<PointSlope> out) const {
  const State& state = at.state;
  const double *x = at.x.data(), *v = at.v.data();
  const double* k_family = state.f64(Columns::stiffness).data();
  const double viscous = state.f64(Columns::damping)[0], internal = state.f64(Columns::damping)[1];
  const bool air = state.span<uint32_t>(Columns::air)[0] != 0;
  const Vec3 g = load3(state.f64(Columns::gravity).data(), 0);
  for (size_t k = 0; k < points.size(); ++k) {
    const uint32_t i = points[k];
    const Vec3 xi = load3(x, i), vi = load3(v, i);
    PointSlope s;
    s.force = g * masses_[i] - vi * viscous;
    add_to_slope(s, viscous / h, 0, {});
    for (uint32_t r = row_begin_[i]; r < row_begin_[i + 1]; ++r) {
      const RowEntry& entry = rows_[r];
      if (entry.spring == RowEntry::kNoSpring) continue;
      const uint32_t spring = entry.spring;
      const Vec3 d = load3(x, entry.column) - xi;
      const double stiff = k_family[static_cast<size_t>(schedule_.family[spring])] * schedule_.scale[spring];
      const double l2 = norm2(d), per_l = l2 > 0 ? 1 / std::sqrt(l2) : 0;
      const double across = 1 - schedule_.rest[spring] * per_l;
      s.force += d * (stiff * across);
      // Without the destabilising sideways term of a compressed spring (kernels/springs/spring.h).
      const double alpha = l2 > 0 ? std::max(0.0, across) * stiff : stiff;
      add_to_slope(s, alpha, (stiff - alpha) * per_l * per_l, d);
      if (internal > 0) {
        const Vec3 e = load3(x_lagged.data(), entry.column) - load3(x_lagged.data(), i);
        s.force += spring::force(e, load3(v, entry.column) - vi, 0, 0, internal);
        const double e2 = norm2(e);
        add_to_slope(s, 0, e2 > 0 ? internal / (h * e2) : 0, e);
      }
    }
    if (!network_.bends.empty()) {
      for (uint32_t j = point_bends_begin_[i]; j < point_bends_begin_[i + 1]; ++j) {
        const Bend& b = network_.bends[point_bends_[j].bend];
        const auto l = bending::links(load3(x, b.points[0]), load3(x, b.points[1]), load3(x, b.points[2]));
        const int corner = static_cast<int>(point_bends_[j].corner);
        s.force += bending::forces(l, b.stiffness)[point_bends_[j].corner];
        const auto block = bending::force_slope(bending::definite_hessian(l, b.stiffness), corner, corner);
        double* K = s.stiffness;
        K[0] -= block[0], K[1] -= block[1], K[2] -= block[2], K[3] -= block[4], K[4] -= block[5],
            K[5] -= block[8];
      }
    }
    if (air) air_slope(at, x_lagged, h, i, s);
    out[k] = s;
  }
  if (!Columns::kHands.any(state)) return;
  const auto each = [&](uint64_t who, const auto& act) {
    const auto at_row = std::lower_bound(points.begin(), points.end(), who);
    if (at_row != points.end() && *at_row == who) act(out[static_cast<size_t>(at_row - points.begin())]);
  };
  for (size_t k = 0; k < Columns::kHands.drags(state); ++k) {
    const UserForces::Drag d = Columns::kHands.drag(state, k);
    each(d.who, [&](PointSlope& s) {
      s.force += d.stiffness * (d.target - load3(x, d.who));
      add_to_slope(s, d.stiffness, 0, {});
    });
  }
  for (size_t k = 0; k < Columns::kHands.pushes(state); ++k) {
    const UserForces::Push p = Columns::kHands.push(state, k);
    each(p.who, [&](PointSlope& s) { s.force += p.force; });
  }
}

}  // namespace truestep::mass_spring
