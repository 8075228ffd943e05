#include "engine/systems/mass_spring/mass_spring_field.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/springs/air.h"
#include "engine/kernels/springs/spring.h"

namespace truestep::mass_spring {

using Columns = MassSpringColumns;

namespace {

// Adds (or subtracts) n forces to rows i0 ... of the owner's sums.
void add(size_t n, double* __restrict to, const double* __restrict f) {
  for (size_t i = 0; i < n; ++i) to[i] += f[i];
}
void subtract(size_t n, double* __restrict to, const double* __restrict f) {
  for (size_t i = 0; i < n; ++i) to[i] -= f[i];
}
void difference(size_t n, double* __restrict d, const double* a, const double* b) {
  for (size_t i = 0; i < n; ++i) d[i] = b[i] - a[i];
}
void gathered_difference(size_t n, double* __restrict d, const double* x, const uint32_t* a,
                         const uint32_t* b) {
  for (size_t i = 0; i < n; ++i) d[i] = x[b[i]] - x[a[i]];
}

}  // namespace

MassSpringField::MassSpringField(const MassSpringDef& def, const BuildContext& context)
    : network_(build_network(def, normalized(context.gravity, {0, -1, 0}))),
      masses_(point_masses(def, network_)),
      schedule_(network_, kBlockRows),
      gravity_(context.gravity),
      stiffness_{def.stiffness, def.shear_stiffness, def.bending_stiffness, 1},
      damping_{def.damping, def.internal_damping},
      wind_(def.wind.value_or(Vec3{})),
      air_(def.wind.has_value()),
      air_factor_(0.5 * def.air_density * def.drag_coefficient),
      gust_(def.gust),
      gust_period_(def.gust_period),
      dependence_(def.damping > 0 || def.internal_damping > 0 || def.wind ? Dependence::position_and_velocity
                                                                          : Dependence::position) {
  if (network_.triangles.empty()) {
    // Each point carries half of each of its links.
    section_.assign(network_.x.size(), 0);
    for (const SpringLink& s : network_.springs) {
      if (s.family == SpringFamily::bending) continue;
      for (const uint32_t p : {s.a, s.b}) section_[p] += 0.5 * def.thickness * s.rest;
    }
  }
  for (const SpringLink& s : network_.springs) {
    double& largest = largest_scale_[static_cast<size_t>(s.family)];
    largest = std::max(largest, s.scale);
  }
  build_rows();
}

State MassSpringField::initial_state() const {
  State s;
  const size_t n = network_.x.size();
  s.add({"position", "m", Scalar::f64, 3, Role::position}, n);
  s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, n);
  s.add({"inverse_mass", "1/kg"}, n);
  s.add({"stiffness", "N/m"}, kSpringFamilies);
  s.add({"damping", "N s/m"}, 2);
  s.add({"gravity", "m/s^2", Scalar::f64, 3}, 1);
  s.add({"wind", "m/s", Scalar::f64, 3}, 1);
  s.add({"air", "1", Scalar::u32}, 1);
  s.add({"drag.row", "1", Scalar::u32}, 0);
  s.add({"drag.target", "m", Scalar::f64, 3}, 0);
  s.add({"drag.stiffness", "N/m"}, 0);
  s.add({"push.row", "1", Scalar::u32}, 0);
  s.add({"push.force", "N", Scalar::f64, 3}, 0);
  s.add({"push.remaining", "s"}, 0);
  for (size_t i = 0; i < n; ++i) {
    store3(s.f64(Columns::position).data(), i, network_.x[i]);
    store3(s.f64(Columns::velocity).data(), i, network_.v[i]);
    s.f64(Columns::inverse_mass)[i] = 1 / masses_[i];
  }
  for (const uint32_t p : network_.pins) s.f64(Columns::inverse_mass)[p] = 0;
  std::copy_n(stiffness_, kSpringFamilies, s.f64(Columns::stiffness).data());
  std::copy_n(damping_, 2, s.f64(Columns::damping).data());
  store3(s.f64(Columns::gravity).data(), 0, gravity_);
  store3(s.f64(Columns::wind).data(), 0, wind_);
  s.span<uint32_t>(Columns::air)[0] = air_;
  return s;
}

std::span<const double> MassSpringField::inverse_mass(const State& state) const {
  return state.f64(Columns::inverse_mass);
}

void MassSpringField::lagged_acceleration(const Phase& at, std::span<const double> x_lagged,
                                          std::span<double> a, Evaluation& e) const {
  const auto lagged = e.workspace.doubles("mass_spring.lagged", a.size());
  accelerate({at.t, x_lagged, at.v, at.state}, lagged, e, Forces::dissipative);
  accelerate(at, a, e, Forces::conservative);
  for (size_t k = 0; k < a.size(); ++k) a[k] += lagged[k];
}

MassSpringField::Scratch MassSpringField::scratch(Evaluation& e) const {
  const size_t n = schedule_.points();
  double* memory = e.workspace.doubles("mass_spring.coordinates", 9 * n).data();
  Scratch s;
  s.rests = rests(e);
  for (size_t c = 0; c < 3; ++c) {
    s.x[c] = memory + c * n, s.v[c] = memory + (3 + c) * n, s.f[c] = memory + (6 + c) * n;
  }
  return s;
}

void MassSpringField::reactions(const Phase& at, std::span<double> out, Evaluation& e) const {
  accelerate(at, out, e, Forces::all);
  const Scratch s = scratch(e);
  const auto w = at.state.f64(Columns::inverse_mass);
  const Vec3 g = load3(at.state.f64(Columns::gravity).data(), 0);
  for (size_t i = 0; i < w.size(); ++i) {
    const Vec3 f{s.f[0][i], s.f[1][i], s.f[2][i]};
    store3(out.data(), i, w[i] > 0 ? Vec3{} : -(f + g * masses_[i]));
  }
}

void MassSpringField::accelerate(const Phase& at, std::span<double> a, Evaluation& e, Forces which) const {
  const size_t n = schedule_.points();
  const State& state = at.state;
  const double dissipative = which == Forces::conservative ? 0 : 1;
  const double viscous = dissipative * state.f64(Columns::damping)[0];
  const double internal = dissipative * state.f64(Columns::damping)[1];
  const bool air = dissipative > 0 && state.span<uint32_t>(Columns::air)[0] != 0;
  const bool bends = which != Forces::dissipative && !network_.bends.empty();
  const bool hands = Columns::kHands.any(state);
  const bool moving = internal > 0 || (air && !network_.triangles.empty());

  // Coordinates in separate arrays, so that the spring loops read contiguously.
  const Scratch s = scratch(e);
  const auto separate = [](const double* from, size_t begin, size_t end, double* const to[3]) {
    double* __restrict x = to[0], * __restrict y = to[1], * __restrict z = to[2];
    for (size_t i = begin; i < end; ++i) x[i] = from[3 * i], y[i] = from[3 * i + 1], z[i] = from[3 * i + 2];
  };
  e.arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    separate(at.x.data(), begin, end, s.x);
    if (moving) separate(at.v.data(), begin, end, s.v);
  });

  const double* w = state.f64(Columns::inverse_mass).data();
  const Vec3 g = which == Forces::dissipative ? Vec3{} : load3(state.f64(Columns::gravity).data(), 0);
  e.arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    const Rows rows{begin / kBlockRows, begin, end};
    for (size_t c = 0; c < 3; ++c) std::fill(s.f[c] + begin, s.f[c] + end, 0.0);
    spring_forces(rows, state, s, which);
    if (bends) bending_forces(rows, s);
    if (air) air_forces(rows, at, s);
    if (hands) hand_forces(rows, state, s, which);
    const double* __restrict fx = s.f[0], * __restrict fy = s.f[1], * __restrict fz = s.f[2];
    const double* v = at.v.data();
    double* out = a.data();
    for (size_t i = begin; i < end; ++i) {
      const double free = w[i] > 0 ? 1.0 : 0.0;
      out[3 * i] = free * g.x + w[i] * (fx[i] - viscous * v[3 * i]);
      out[3 * i + 1] = free * g.y + w[i] * (fy[i] - viscous * v[3 * i + 1]);
      out[3 * i + 2] = free * g.z + w[i] * (fz[i] - viscous * v[3 * i + 2]);
    }
  });
}

void MassSpringField::spring_forces(const Rows& rows, const State& state, const Scratch& s,
                                    Forces which) const {
  const double* stiffness = state.f64(Columns::stiffness).data();
  const double internal = which == Forces::conservative ? 0 : state.f64(Columns::damping)[1];
  if (which == Forces::dissipative && internal == 0) return;
  alignas(64) double d[3][spring::kRunChunk], w[3][spring::kRunChunk];
  for (const SpringSegment& segment : schedule_.segments(rows.index)) {
    const bool run = segment.kind == SpringSegment::Kind::run;
    const double k = which == Forces::dissipative ? 0 : stiffness[static_cast<size_t>(segment.family)];
    const double* rest = (run ? s.rests.springs : s.rests.list) + segment.first;
    const double* scale = (run ? schedule_.scale.data() : schedule_.list_scale.data()) + segment.first;
    for (size_t i = 0; i < segment.count; i += spring::kRunChunk) {
      const size_t n = std::min(spring::kRunChunk, segment.count - i);
      const uint32_t* list_a = run ? nullptr : schedule_.list_a.data() + segment.first + i;
      const uint32_t* list_b = run ? nullptr : schedule_.list_b.data() + segment.first + i;
      for (size_t c = 0; c < 3; ++c) {
        if (run) {
          difference(n, d[c], s.x[c] + segment.a + i, s.x[c] + segment.b + i);
          if (internal > 0) difference(n, w[c], s.v[c] + segment.a + i, s.v[c] + segment.b + i);
        } else {
          gathered_difference(n, d[c], s.x[c], list_a, list_b);
          if (internal > 0) gathered_difference(n, w[c], s.v[c], list_a, list_b);
        }
      }
      if (internal > 0) {
        spring::run_damped_forces(n, d[0], d[1], d[2], w[0], w[1], w[2], rest + i, scale + i, k, internal);
      } else {
        spring::run_forces(n, d[0], d[1], d[2], rest + i, scale + i, k);
      }
      for (size_t c = 0; c < 3; ++c) {
        if (run) {
          if (segment.ends != SpringEnds::b) add(n, s.f[c] + segment.a + i, d[c]);
          if (segment.ends != SpringEnds::a) subtract(n, s.f[c] + segment.b + i, d[c]);
        } else {
          for (size_t j = 0; j < n; ++j) {
            if (segment.ends != SpringEnds::b) s.f[c][list_a[j]] += d[c][j];
            if (segment.ends != SpringEnds::a) s.f[c][list_b[j]] -= d[c][j];
          }
        }
      }
    }
  }
}

// Every point adds up its own part of each of its bends.
void MassSpringField::bending_forces(const Rows& rows, const Scratch& s) const {
  const auto load = [&](size_t i) { return Vec3{s.x[0][i], s.x[1][i], s.x[2][i]}; };
  for (size_t i = rows.begin; i < rows.end; ++i) {
    for (uint32_t k = point_bends_begin_[i]; k < point_bends_begin_[i + 1]; ++k) {
      const Bend& b = network_.bends[point_bends_[k].bend];
      const auto links = bending::links(load(b.points[0]), load(b.points[1]), load(b.points[2]));
      const Vec3 f = bending::forces(links, b.stiffness)[point_bends_[k].corner];
      s.f[0][i] += f.x, s.f[1][i] += f.y, s.f[2][i] += f.z;
    }
  }
}

Vec3 MassSpringField::wind_at(const Phase& at) const {
  return air::gusty(load3(at.state.f64(Columns::wind).data(), 0), gust_, gust_period_, at.t);
}

void MassSpringField::air_forces(const Rows& rows, const Phase& at, const Scratch& s) const {
  const Vec3 wind = wind_at(at);
  const auto load = [](double* const c[3], size_t i) { return Vec3{c[0][i], c[1][i], c[2][i]}; };
  const auto add_force = [&](size_t i, const Vec3& f) {
    s.f[0][i] += f.x, s.f[1][i] += f.y, s.f[2][i] += f.z;
  };
  for (const auto& t : schedule_.triangles(rows.index)) {
    const Vec3 x0 = load(s.x, t[0]);
    const Vec3 normal = cross(load(s.x, t[1]) - x0, load(s.x, t[2]) - x0);
    const Vec3 u = wind - (load(s.v, t[0]) + load(s.v, t[1]) + load(s.v, t[2])) * (1.0 / 3);
    const Vec3 f = air::plate_force(normal, u, air_factor_) * (1.0 / 3);
    for (const uint32_t p : t) {
      if (p >= rows.begin && p < rows.end) add_force(p, f);
    }
  }
  if (section_.empty()) return;
  for (size_t i = rows.begin; i < rows.end; ++i) {
    add_force(i, air::cylinder_force(wind - load3(at.v.data(), i), air_factor_, section_[i]));
  }
}

// Drag springs and pushes, which commands add to the state.
void MassSpringField::hand_forces(const Rows& rows, const State& state, const Scratch& s,
                                  Forces which) const {
  const auto add_force = [&](size_t i, const Vec3& f) {
    if (i >= rows.begin && i < rows.end) s.f[0][i] += f.x, s.f[1][i] += f.y, s.f[2][i] += f.z;
  };
  for (size_t k = 0; k < Columns::kHands.drags(state) && which != Forces::dissipative; ++k) {
    const UserForces::Drag d = Columns::kHands.drag(state, k);
    const Vec3 x{s.x[0][d.who], s.x[1][d.who], s.x[2][d.who]};
    add_force(d.who, d.stiffness * (d.target - x));
  }
  for (size_t k = 0; k < Columns::kHands.pushes(state) && which != Forces::conservative; ++k) {
    const UserForces::Push p = Columns::kHands.push(state, k);
    add_force(p.who, p.force);
  }
}

double MassSpringField::strain(std::span<const double> x, size_t s) const {
  const double l = norm(load3(x.data(), schedule_.b[s]) - load3(x.data(), schedule_.a[s]));
  const double rest = schedule_.rest[s];
  return rest > 0 ? l / rest - 1 : l;
}

}  // namespace truestep::mass_spring
