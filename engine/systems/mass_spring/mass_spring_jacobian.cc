// Derivatives of the forces of mass_spring_field.h and the stiffness bound read off them. Rows are assembled
// independently (each spring twice), because a row's blocks lie next to each other in memory: the diagonal
// block is minus the sum of the others plus the forces on the point alone. Left out, as usual, because they
// are not symmetric and vanish with the step: the derivatives of damping and air forces by position.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "engine/kernels/springs/air.h"
#include "engine/kernels/springs/spring.h"
#include "engine/math/block_sparse.h"
#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep::mass_spring {

using Columns = MassSpringColumns;

namespace {

// block += alpha I + beta d d^T
inline void add_symmetric(double* block, double alpha, double beta, const Vec3& d) {
  const double bx = beta * d.x, by = beta * d.y, bz = beta * d.z;
  block[0] += alpha + bx * d.x, block[1] += bx * d.y, block[2] += bx * d.z;
  block[3] += bx * d.y, block[4] += alpha + by * d.y, block[5] += by * d.z;
  block[6] += bx * d.z, block[7] += by * d.z, block[8] += alpha + bz * d.z;
}

}  // namespace

void MassSpringField::build_rows() {
  const size_t n = network_.x.size();
  for (size_t s = 0; s < schedule_.a.size(); ++s) pairs_.push_back({schedule_.a[s], schedule_.b[s]});
  for (const auto& t : network_.triangles) {
    for (size_t k = 0; k < 3; ++k) pairs_.push_back({t[k], t[(k + 1) % 3]});
  }
  for (const Bend& b : network_.bends) {
    for (size_t k = 0; k < 3; ++k) pairs_.push_back({b.points[k], b.points[(k + 1) % 3]});
  }
  BlockSparse pattern;
  pattern.set_pattern(n, 3, pairs_);
  build_bends(pattern);

  // One entry per spring at a point and one per block that only air needs, in the order of the slots.
  std::vector<std::vector<RowEntry>> rows(n);
  std::vector<uint8_t> used(pattern.blocks(), 0);
  const auto enter = [&](uint32_t i, uint32_t j, uint32_t spring) {
    const BlockSparse::Slot slot = pattern.slot(i, j);
    if (spring == RowEntry::kNoSpring && used[slot]) return;
    used[slot] = 1;
    rows[i].push_back({j, spring, slot});
  };
  for (uint32_t k = 0; k < pairs_.size(); ++k) {
    const uint32_t spring = k < schedule_.a.size() ? k : RowEntry::kNoSpring;
    enter(pairs_[k][0], pairs_[k][1], spring);
    enter(pairs_[k][1], pairs_[k][0], spring);
  }
  row_begin_.push_back(0);
  for (auto& row : rows) {
    std::stable_sort(row.begin(), row.end(),
                     [](const RowEntry& p, const RowEntry& q) { return p.slot < q.slot; });
    rows_.insert(rows_.end(), row.begin(), row.end());
    row_begin_.push_back(static_cast<uint32_t>(rows_.size()));
  }

  point_triangles_begin_.assign(n + 1, 0);
  for (const auto& t : network_.triangles) {
    for (const uint32_t p : t) ++point_triangles_begin_[p + 1];
  }
  for (size_t i = 0; i < n; ++i) point_triangles_begin_[i + 1] += point_triangles_begin_[i];
  point_triangles_.resize(point_triangles_begin_[n]);
  std::vector<uint32_t> next(point_triangles_begin_.begin(), point_triangles_begin_.end() - 1);
  for (uint32_t t = 0; t < network_.triangles.size(); ++t) {
    const auto& corners = network_.triangles[t];
    for (const uint32_t p : corners) {
      PointTriangle& entry = point_triangles_[next[p]++];
      entry.triangle = t;
      for (size_t k = 0; k < 3; ++k) entry.slots[k] = pattern.slot(p, corners[k]);
    }
  }
  colour_points();
}

void MassSpringField::build_bends(const BlockSparse& pattern) {
  if (network_.bends.empty()) return;
  const size_t n = network_.x.size();
  point_bends_begin_.assign(n + 1, 0);
  for (const Bend& b : network_.bends) {
    for (const uint32_t p : b.points) ++point_bends_begin_[p + 1];
  }
  for (size_t i = 0; i < n; ++i) point_bends_begin_[i + 1] += point_bends_begin_[i];
  point_bends_.resize(point_bends_begin_[n]);
  std::vector<uint32_t> next(point_bends_begin_.begin(), point_bends_begin_.end() - 1);
  for (uint32_t k = 0; k < network_.bends.size(); ++k) {
    const auto& p = network_.bends[k].points;
    auto& slots = bend_slots_.emplace_back();
    for (uint32_t i = 0; i < 3; ++i) {
      point_bends_[next[p[i]]++] = {k, i};
      for (uint32_t j = 0; j < 3; ++j) slots[3 * i + j] = pattern.slot(p[i], p[j]);
    }
  }
}

void MassSpringField::add_bending_slopes(const Phase& at, BlockSparse& dfdx, BendSlope slope) const {
  const double* x = at.x.data();
  for (size_t k = 0; k < network_.bends.size(); ++k) {
    const Bend& b = network_.bends[k];
    const auto links = bending::links(load3(x, b.points[0]), load3(x, b.points[1]), load3(x, b.points[2]));
    const bending::Hessian h = slope(links, b.stiffness);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        dfdx.add_block(bend_slots_[k][static_cast<size_t>(3 * i + j)], bending::force_slope(h, i, j).data());
      }
    }
  }
}

uint64_t MassSpringField::pattern_version(const State& state) const {
  const bool air = state.span<uint32_t>(Columns::air)[0] != 0 && !network_.triangles.empty();
  return state.f64(Columns::damping)[1] > 0 || air ? 1 : 0;
}

void MassSpringField::jacobian_pattern(const State& state, BlockSparse& dfdx, BlockSparse& dfdv) const {
  dfdx.set_pattern(network_.x.size(), 3, pairs_);
  if (pattern_version(state) == 1) {
    dfdv = dfdx;
  } else {
    dfdv.set_pattern(network_.x.size(), 3, {});
  }
}

void MassSpringField::assemble_jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation& e,
                                        SpringStiffness stiffness, BendSlope slope) const {
  const State& state = at.state;
  const double* x = at.x.data();
  const double* k_family = state.f64(Columns::stiffness).data();
  const double viscous = state.f64(Columns::damping)[0], internal = state.f64(Columns::damping)[1];
  const bool air = state.span<uint32_t>(Columns::air)[0] != 0;
  const bool coupled = dfdv.blocks() > dfdv.block_rows();
  const Vec3 wind = wind_at(at);

  // alpha and beta of every spring, in one straight loop.
  const double* rest = rests(e).springs;
  const double* tension = held_tensions(e);
  const size_t springs = schedule_.a.size();
  const auto coefficients = e.workspace.doubles("mass_spring.coefficients", 2 * springs);
  e.arena.for_blocks(springs, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t s = begin; s < end; ++s) {
      const Vec3 d = load3(x, schedule_.b[s]) - load3(x, schedule_.a[s]);
      const double k = k_family[static_cast<size_t>(schedule_.family[s])] * schedule_.scale[s];
      // A tension belongs to the rest length l - T / k.
      const double l = tension && k > 0 ? norm(d) - tension[s] / k : rest[s];
      const spring::Stiffness c = stiffness(norm2(d), k, l);
      coefficients[2 * s] = c.alpha, coefficients[2 * s + 1] = c.beta;
    }
  });

  e.arena.for_blocks(network_.x.size(), kBlockRows, [&](size_t begin, size_t end) {
    double* out = dfdx.values().data();
    double* rate = dfdv.values().data();
    std::fill(out + 9 * size_t{dfdx.row_begin(begin)}, out + 9 * size_t{dfdx.row_begin(end)}, 0.0);
    std::fill(rate + 9 * size_t{dfdv.row_begin(begin)}, rate + 9 * size_t{dfdv.row_begin(end)}, 0.0);
    for (size_t i = begin; i < end; ++i) {
      const Vec3 xi = load3(x, i), vi = load3(at.v.data(), i);
      double own[9] = {}, own_rate[9] = {};
      for (uint32_t r = row_begin_[i]; r < row_begin_[i + 1]; ++r) {
        const RowEntry& entry = rows_[r];
        if (entry.spring == RowEntry::kNoSpring) continue;
        const Vec3 d = load3(x, entry.column) - xi;
        const double alpha = coefficients[2 * size_t{entry.spring}];
        const double beta = coefficients[2 * size_t{entry.spring} + 1];
        add_symmetric(out + 9 * size_t{entry.slot}, alpha, beta, d);
        add_symmetric(own, -alpha, -beta, d);
        if (internal > 0) {
          const double l2 = norm2(d), gamma = l2 > 0 ? internal / l2 : 0;
          add_symmetric(rate + 9 * size_t{entry.slot}, 0, gamma, d);
          add_symmetric(own_rate, 0, -gamma, d);
        }
      }
      add_symmetric(own_rate, -viscous, 0, {});
      if (air && !section_.empty()) {
        const Vec3 u = wind - vi;
        const auto [alpha, beta] = air::cylinder_slope(u, air_factor_, section_[i]);
        add_symmetric(own_rate, -alpha, -beta, u);
      }
      dfdx.add_block(dfdx.diagonal_slot(i), own);
      dfdv.add_block(dfdv.diagonal_slot(i), own_rate);
      // The derivative of a triangle's wind force is the same for all nine pairs of its corners.
      if (!air || !coupled) continue;
      for (uint32_t k = point_triangles_begin_[i]; k < point_triangles_begin_[i + 1]; ++k) {
        const auto& t = network_.triangles[point_triangles_[k].triangle];
        const double* v = at.v.data();
        const Vec3 normal = cross(load3(x, t[1]) - load3(x, t[0]), load3(x, t[2]) - load3(x, t[0]));
        const Vec3 u = wind - (load3(v, t[0]) + load3(v, t[1]) + load3(v, t[2])) * (1.0 / 3);
        const double slope = -air::plate_slope(normal, u, air_factor_) / 9;
        for (const uint32_t slot : point_triangles_[k].slots) {
          add_symmetric(rate + 9 * size_t{slot}, 0, slope, normal);
        }
      }
    }
  });
  add_bending_slopes(at, dfdx, slope);
  for (size_t k = 0; k < Columns::kHands.drags(at.state); ++k) {
    const UserForces::Drag d = Columns::kHands.drag(at.state, k);
    add_symmetric(dfdx.block(dfdx.diagonal_slot(static_cast<uint32_t>(d.who))).data(), -d.stiffness, 0, {});
  }
}

std::optional<ForceField::Stiffness> MassSpringField::stiffness(const State& state) const {
  const auto x = state.f64(Columns::position);
  const auto k_family = state.f64(Columns::stiffness);
  const auto w = state.f64(Columns::inverse_mass);
  const double viscous = state.f64(Columns::damping)[0], internal = state.f64(Columns::damping)[1];
  const size_t n = network_.x.size();
  // u^T K u <= 2 sum_i u_i^T K_ii u_i holds for every spring, hence for all: only diagonal blocks matter. A
  // spring that ends at a point that does not move has u^T K u = u_i^T K_ii u_i, half of that.
  std::vector<double> sum_k(9 * n, 0.0), sum_n(9 * n, 0.0);
  for (size_t s = 0; s < schedule_.a.size(); ++s) {
    const Vec3 d = load3(x.data(), schedule_.b[s]) - load3(x.data(), schedule_.a[s]);
    const double k = k_family[static_cast<size_t>(schedule_.family[s])] * schedule_.scale[s];
    const double l2 = norm2(d), per_l2 = l2 > 0 ? 1 / l2 : 0;
    const double across = std::max(0.0, spring::stiffness(l2, k, schedule_.rest[s]).alpha);
    const double part = w[schedule_.a[s]] > 0 && w[schedule_.b[s]] > 0 ? 1 : 0.5;
    for (const uint32_t p : {schedule_.a[s], schedule_.b[s]}) {
      add_symmetric(&sum_k[9 * size_t{p}], part * across, part * (k - across) * per_l2, d);
      add_symmetric(&sum_n[9 * size_t{p}], 0, part * per_l2, d);
    }
  }
  // Three points: u^T K u <= 3 sum_i u_i^T K_ii u_i, half as much again as for two.
  for (const Bend& b : network_.bends) {
    const auto l = bending::links(load3(x.data(), b.points[0]), load3(x.data(), b.points[1]),
                                  load3(x.data(), b.points[2]));
    const double s = -1.5 * bending::slope(l, b.stiffness), both = l.per_a + l.per_b;
    add_symmetric(&sum_k[9 * size_t{b.points[0]}], s * l.per_a * l.per_a, 0, {});
    add_symmetric(&sum_k[9 * size_t{b.points[1]}], s * both * both, 0, {});
    add_symmetric(&sum_k[9 * size_t{b.points[2]}], s * l.per_b * l.per_b, 0, {});
  }
  for (size_t k = 0; k < Columns::kHands.drags(state); ++k) {
    const UserForces::Drag d = Columns::kHands.drag(state, k);
    add_symmetric(&sum_k[9 * d.who], 0.5 * d.stiffness, 0, {});
  }
  const auto largest = [](const double* block) {
    // Not computeDirect: that calls libm's atan2 and cos.
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.compute(Eigen::Map<const Eigen::Matrix3d>(block), Eigen::EigenvaluesOnly);
    return std::max(0.0, solver.eigenvalues()[2]);
  };
  Stiffness bound;
  double omega2 = 0;
  for (size_t i = 0; i < n; ++i) {
    if (!(w[i] > 0)) continue;
    omega2 = std::max(omega2, 2 * w[i] * largest(&sum_k[9 * i]));
    bound.damping = std::max(bound.damping, w[i] * (viscous + 2 * internal * largest(&sum_n[9 * i])));
  }
  bound.omega = std::sqrt(omega2);
  return bound;
}

}  // namespace truestep::mass_spring
