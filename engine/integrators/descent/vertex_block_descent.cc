// Vertex block descent (Chen, Liu, Yang, Yuksel 2024, ACM Trans. Graph. 43, 4, "Vertex Block Descent"): the
// incremental potential of descent.h is lowered point by point, colour by colour, by the Newton step of one
// point while all others are fixed (eq. 8 to 10),
//   x_i <- x_i - H_i^-1 r_i,   H_i = m_i / h^2 + K_i,   r_i = m_i (x_i - y_i) / h^2 - f_i,   y = x0 + h v0.
// Stiffness blocks are positive semidefinite, so no line search is needed. Iterations start from x0 + h v0 +
// h^2 a, a being the fraction of free fall that the point had in the last step (section 3.7), and are
// accelerated by Chebyshev weights (section 3.8, eq. 18) for a spectral radius `kRadius`. The previous step's
// velocities are part of the state.
#include <algorithm>
#include <cmath>

#include "engine/base/interrupt.h"
#include "engine/core/equations/point_forces.h"
#include "engine/integrators/descent/descent.h"
#include "engine/integrators/table/methods.h"
#include "engine/kernels/chebyshev.h"

namespace truestep {

namespace {

constexpr std::string_view kVelocityBefore = "integrator.velocity_before";
constexpr double kRadius = 0.95;  // as in the paper

// H d = b of a symmetric positive definite H (xx, xy, xz, yy, yz, zz) by its adjugate.
Vec3 solve(const double H[6], const Vec3& b) {
  const double c00 = H[3] * H[5] - H[4] * H[4], c01 = H[2] * H[4] - H[1] * H[5],
               c02 = H[1] * H[4] - H[2] * H[3];
  const double det = H[0] * c00 + H[1] * c01 + H[2] * c02;
  if (!(det > 0)) return {};
  const double c11 = H[0] * H[5] - H[2] * H[2], c12 = H[1] * H[2] - H[0] * H[4],
               c22 = H[0] * H[3] - H[1] * H[1];
  return Vec3{c00 * b.x + c01 * b.y + c02 * b.z, c01 * b.x + c11 * b.y + c12 * b.z,
              c02 * b.x + c12 * b.y + c22 * b.z} /
         det;
}

}  // namespace

std::optional<std::string> refuses_without_point_forces(const ForceField& field) {
  if (field.point_forces()) return std::nullopt;
  return "vertex block descent is for forces between a few points each";
}

void prepare_vertex_block_descent(const ForceField&, State& state) {
  state.add({std::string(kVelocityBefore), "m/s", Scalar::f64, 3}, state.rows(state.at("velocity")));
}

void step_vertex_block_descent(const ForceField& field, State& state, const StepInput& in,
                               const IntegratorOptions& options) {
  Motion m(field, state, in);
  Descent descent(m);
  const PointForces& forces = *field.point_forces();
  const PointColours& colours = forces.colours();
  const auto w = descent.inverse_mass(), x0 = descent.x0(), v0 = descent.v0();
  const size_t n = descent.size();
  const double h = in.h, per_h = 1 / h;
  const auto x = m.scratch("vertex_block_descent.x", n), u = m.scratch("vertex_block_descent.u", n);
  const auto older = m.scratch("vertex_block_descent.older", n),
             old = m.scratch("vertex_block_descent.old", n);
  auto& slopes = in.workspace.object<std::vector<PointSlope>>("vertex_block_descent.slopes");
  slopes.resize(colours.points.size());

  // Initial guess: the fraction of free fall in the last step.
  const auto last = state.f64(state.at(kVelocityBefore));
  const Vec3 g = forces.free_acceleration(state);
  const double fall = norm(g);
  for (size_t i = 0; i < w.size(); ++i) {
    Vec3 a;
    if (w[i] > 0 && fall > 0) {
      const double had = dot(load3(v0.data(), i) - load3(last.data(), i), g) * per_h / (fall * fall);
      a = forces.allowed(i, g * std::clamp(had, 0.0, 1.0));
    }
    const Vec3 v = load3(v0.data(), i) + a * h;
    store3(u.data(), i, v);
    store3(x.data(), i, load3(x0.data(), i) + v * h);
  }
  std::copy(v0.begin(), v0.end(), last.begin());

  const Phase at{descent.t_end(), x, u, state};
  double omega = 1;
  for (int iteration = 0; iteration < options.descent_iterations; ++iteration) {
    interruption_point();
    std::copy_n(old.begin(), n, older.begin());
    std::copy_n(x.begin(), n, old.begin());
    for (size_t c = 0; c < colours.count(); ++c) {
      const std::span<const uint32_t> points =
          std::span(colours.points).subspan(colours.begin[c], colours.begin[c + 1] - colours.begin[c]);
      in.arena.for_blocks(points.size(), kBlockRows, [&](size_t begin, size_t end) {
        const auto own = points.subspan(begin, end - begin);
        const auto out = std::span(slopes).subspan(begin, end - begin);
        forces.point_slopes(at, x0, h, own, out);
        for (size_t k = 0; k < own.size(); ++k) {
          const uint32_t i = own[k];
          if (!(w[i] > 0)) continue;
          const double inertia = per_h * per_h / w[i];
          double H[6];
          std::copy_n(out[k].stiffness, 6, H);
          H[0] += inertia, H[3] += inertia, H[5] += inertia;
          const Vec3 here = load3(x.data(), i), start = load3(x0.data(), i);
          const Vec3 aim = start + load3(v0.data(), i) * h;
          const Vec3 next = here + solve(H, out[k].force + (aim - here) * inertia);
          store3(x.data(), i, next);
          store3(u.data(), i, (next - start) * per_h);
        }
      });
    }
    if (iteration == 0) continue;
    omega = chebyshev_weight(iteration, kRadius, omega);
    m.loop(n, [&](size_t k) {
      x[k] = older[k] + omega * (x[k] - older[k]);
      u[k] = (x[k] - x0[k]) * per_h;
    });
  }
  descent.finish(x);
  m.project();
}

}  // namespace truestep
