// Implicit Euler with the field's sparse Jacobian (implicit_system.h); the full equations go to Newton's
// method (stage_newton.h), the linear ones are solved here:
//   (M - h df/dv - h^2 df/dx) dv = h (f + h df/dx v),  v' = v + dv,  x' = x + h v'
#include <algorithm>

#include "engine/integrators/implicit/implicit.h"
#include "engine/integrators/implicit/newton/stage_newton.h"

namespace truestep {

void implicit_euler_sparse(Motion& m, const IntegratorOptions& options) {
  if (m.v.empty()) return;
  const double h = m.input.h;
  const auto u = m.scratch("integrator.v", m.v.size());
  std::copy(m.v.begin(), m.v.end(), u.begin());
  const NewtonReport& report =
      StageNewton(m, options).solve({.t = m.input.t + h, .g = h, .s = h, .x0 = m.x, .u0 = m.v}, u);
  if (report.held) {
    if (const auto c = m.state.find(kHeldSteps)) ++m.state.span<uint64_t>(*c)[0];
  }
  m.loop(m.v.size(), [x = m.x.data(), v = m.v.data(), u = u.data(), h](size_t i) {
    v[i] = u[i];
    x[i] += h * v[i];
  });
}

void reserve_implicit_euler_sparse(Motion& m, const IntegratorOptions& options) {
  if (m.v.empty()) return;
  m.scratch("integrator.v", m.v.size());
  StageNewton(m, options);
}

namespace {

// dv = y + z: z is prescribed by surfaces, y is free, S A S y = S (b - A z); the surfaces' impulse is what is
// missing from A dv = b.
void solve_on_surfaces(Motion& m, ImplicitSystem& system, double h, std::span<double> b, std::span<double> dv,
                       double accuracy) {
  const RowContacts& on = *system.contacts();
  const auto w = system.inverse_mass();
  const size_t n = b.size();
  const auto z = m.scratch("integrator.given", n), az = m.scratch("integrator.given_a", n),
             rest = m.scratch("integrator.left", n);
  m.loop(w.size(), [&](size_t i) {
    const Vec3 v = load3(m.v.data(), i);
    const bool moves = w[i] > 0;
    store3(z.data(), i, moves ? on.given(i, v) - v : Vec3{});
    if (moves && on.kind[i] == RowContacts::kSlides)
      store3(b.data(), i, load3(b.data(), i) + load3(on.drag.data(), i));
  });
  system.multiply(z, az);
  m.loop(w.size(),
         [&](size_t i) { store3(rest.data(), i, on.left(i, load3(b.data(), i) - load3(az.data(), i))); });
  system.constrain();
  system.solve(rest, dv, accuracy);
  m.loop(n, [&](size_t k) { dv[k] += z[k]; });
  system.assemble(h, h);
  system.multiply(dv, az);
  m.loop(w.size(), [&](size_t i) {
    const Vec3 missing = load3(az.data(), i) - load3(b.data(), i);
    const Vec3 drag = on.kind[i] == RowContacts::kSlides ? load3(on.drag.data(), i) : Vec3{};
    store3(on.impulse.data(), i,
           on.kind[i] == RowContacts::kFree ? Vec3{} : missing - on.left(i, missing) + drag);
  });
}

}  // namespace

void linear_implicit_euler_sparse(Motion& m, const IntegratorOptions& options) {
  if (m.v.empty()) return;
  const double h = m.input.h, t = m.input.t + h;
  const size_t n = m.v.size();
  ImplicitSystem system(m);
  const auto a = m.scratch("integrator.k1", n), b = m.scratch("integrator.rhs", n),
             dv = m.scratch("integrator.dv", n);
  m.acceleration(t, m.x, m.v, a);
  // Not the exact Jacobian: a single step along an indefinite system would tear compressed cloth apart.
  system.differentiate(t, m.x, m.v, Derivatives::definite);
  // h (f + h df/dx v); the velocity of held rows counts on the right-hand side.
  const auto w = system.inverse_mass();
  m.input.arena.for_blocks(w.size(), kBlockRows, [&](size_t begin, size_t end) {
    system.force_slope().multiply_rows(m.v.data(), b.data(), begin, end);
    for (size_t i = begin; i < end; ++i) {
      for (size_t k = i * system.width(); k < (i + 1) * system.width(); ++k) {
        b[k] = w[i] > 0 ? h * (a[k] / w[i] + h * b[k]) : 0;
      }
    }
  });
  system.assemble(h, h);
  const double accuracy = std::clamp(options.newton_tolerance, 1e-14, 1e-2);
  if (system.contacts()) {
    solve_on_surfaces(m, system, h, b, dv, accuracy);
  } else {
    system.solve(b, dv, accuracy);
  }
  m.loop(n, [x = m.x.data(), v = m.v.data(), dv = dv.data(), h](size_t i) {
    v[i] += dv[i];
    x[i] += h * v[i];
  });
}

}  // namespace truestep
