// Boris's pusher against closed forms: gyration, drift across fields, energy, order, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/systems/particles/boris.h"
#include "tests/support/runs/particles_run.h"

namespace truestep {
using namespace particles;
namespace {

using testing::ParticlesRun;

constexpr double kTurns = 6.283185307179586;

/// Charge over mass 2 C/kg: omega = 2 |B|.
ParticlesDef charged(const Vec3& x, const Vec3& v, const char* integrator = "boris") {
  ParticlesDef d;
  d.positions = {x};
  d.velocities = {v};
  d.integrator = integrator;
  d.gravity = Vec3{};
  d.mass = 0.5, d.charge = 1;
  return d;
}

ExpressionDef force(const char* fx, const char* fy, const char* fz) {
  ExpressionDef e;
  e.fx = fx, e.fy = fy, e.fz = fz;
  return e;
}

TEST(ParticlesBoris, GyratesExactlyForAThousandTurns) {
  // omega = 2 about z, radius 0.5, ten steps per turn; v along z is conserved. Rounding only: 1e4 steps of
  // 1e-16 each way, at random; the period's own rounding times 1000 turns is 6e-13 in the phase.
  ParticlesDef d = charged({0, 0.5, 0}, {1, 0, 0.25});
  d.magnetic_field = {0, 0, 1};
  ParticlesRun r(d, kTurns / 2 / 10);
  r.run(10'000);
  EXPECT_LT(norm(r.x(0) - Vec3{0, 0.5, 0.25 * r.t()}), 8e-10);  // 1e-12 of the 785 m along B
  EXPECT_NEAR(std::hypot(r.x(0).x, r.x(0).y), 0.5, 1e-12);
  EXPECT_NEAR(std::atan2(r.x(0).x, r.x(0).y), 0, 2e-12);
  EXPECT_LT(norm(r.v(0) - Vec3{1, 0, 0.25}), 2e-12);
  // A tenth of a turn later: the sense of rotation is that of q v x B.
  r.run(1);
  EXPECT_NEAR(r.x(0).x, 0.5 * std::sin(kTurns / 10), 2e-12);
  EXPECT_NEAR(r.x(0).y, 0.5 * std::cos(kTurns / 10), 2e-12);
  // Control: the tangent in place of its angle, as in Boris's first form, would give 2 atan(0.314) per step,
  // 3 % slow.
  EXPECT_GT(std::fabs(2 * std::atan(kTurns / 20) - kTurns / 10), 0.01);
}

TEST(ParticlesBoris, DriftsAcrossFieldsExactly) {
  // E x B / B^2 plus free flight along B with (q E/m) t^2/2, after whole turns; gravity drifts too.
  ParticlesDef d = charged({}, {0.3, -0.2, 0.1});
  d.magnetic_field = {0, 2, 0}, d.electric_field = {0.5, 0.125, -1.5};
  d.gravity = Vec3{0.4, 0, 0};
  ParticlesRun r(d, kTurns / 4 / 7);  // omega = 4
  r.run(7 * 50);
  const double t = r.t();
  const Vec3 b = d.magnetic_field, e = d.electric_field + *d.gravity * (d.mass / d.charge);
  const Vec3 drift = cross(e, b) / norm2(b);
  const Vec3 expected = drift * t + Vec3{0, -0.2 * t + 0.5 * 2 * 0.125 * t * t, 0};
  EXPECT_LT(norm(r.x(0) - expected), 1e-11 * norm(expected));  // rounding of 350 steps of lengths up to 800
  EXPECT_LT(norm(r.v(0) - Vec3{0.3, -0.2 + 0.25 * t, 0.1}), 1e-11);
  // Control: kicks by E around an exact rotation, without correcting their size, drift by
  // (theta/2)/tan(theta/2).
  const double half = kTurns / 14;
  EXPECT_GT(std::fabs(half / std::tan(half) - 1), 0.05);
}

TEST(ParticlesBoris, KeepsEnergyWhereRk4LosesIt) {
  const auto drift = [](const char* method) {
    ParticlesDef d = charged({0, 0.5, 0}, {1, 0, 0}, method);
    d.magnetic_field = {0.3, -0.4, 1.2};  // |B| 1.3
    ParticlesRun r(d, 0.1);
    r.run(100'000);
    return r.observed("energy.kinetic") / 0.25 - 1;
  };
  EXPECT_LT(std::fabs(drift("boris")), 1e-11);  // 1e5 roundings
  // rk4 loses (omega h)^6/72 of the energy a step: (0.26)^6/72 is 4e-6, times the share across B.
  EXPECT_LT(drift("rk4"), -0.05);
}

TEST(ParticlesBoris, IsOfSecondOrderWithALinearField) {
  // A Penning trap's middle: E outwards across B and twice as much back along it; against itself at a 40th of
  // the step.
  const auto end = [](double h, int steps) {
    ParticlesDef d = charged({0.4, 0.2, 0}, {0.1, 0.3, -0.2});
    d.magnetic_field = {0, 2, 0};
    d.expression = force("0.3*x", "-0.6*y", "0.3*z");
    ParticlesRun r(d, h);
    r.run(static_cast<uint64_t>(steps));
    return r.x(0);
  };
  const Vec3 exact = end(0.1 / 40, 8000);
  const double coarse = norm(end(0.1, 200) - exact), fine = norm(end(0.05, 400) - exact);
  EXPECT_GT(coarse / fine, 3.8);
  EXPECT_LT(coarse / fine, 4.2);
}

TEST(ParticlesBoris, TurnIsSmoothWhereItsSeriesTakesOver) {
  // Both forms of the coefficients meet at theta = 0.02.
  const auto end = [](double rate) {
    Vec3 x{1, 2, 3}, v{0.5, -1, 2};
    UniformTurn({0, 0.6, 0.8}, rate, 1).apply(x, v, {2, 1, -1});
    return x + v;
  };
  const Vec3 below = end(0.02), above = end(std::nextafter(0.02, 1.0));
  EXPECT_LT(norm(below - above), 1e-13);
  EXPECT_LT(norm(end(0) - Vec3{5, 1.5, 5.5}), 1e-14) << "no field: a parabola";
}

TEST(ParticlesBoris, RefusesWhatDependsOnVelocity) {
  const auto why = [](const ParticlesDef& d) -> std::string {
    try {
      ParticlesRun r(d);
    } catch (const Error& e) {
      return e.issues().at(0).pointer + " " + e.issues().at(0).message;
    }
    return "";
  };
  ParticlesDef d = charged({}, {1, 0, 0});
  EXPECT_EQ(why(d), "");
  d.linear_drag = 0.1;
  EXPECT_EQ(why(d), "/integrator drag depends on the velocity");
  d.linear_drag = 0;
  d.expression = force("0.1*y", "0", "-vy");
  EXPECT_EQ(why(d), "/integrator the expression depends on vy");
  d.expression->fz = "velocity";
  d.expression->constants = {{"velocity", 2}};
  EXPECT_EQ(why(d), "");
  d.charge = 0;
  EXPECT_EQ(why(d), "/integrator the particles have no charge");
  d = charged({}, {1, 0, 0});
  ParticlesRun r(d);
  Command drag;
  drag.kind = CommandKind::set_parameter, drag.name = "linear_drag", drag.value = 1;
  EXPECT_THROW(r.system->apply(r.state, drag), Error);
}

TEST(ParticlesBoris, SameBitsForAnyNumberOfThreads) {
  const auto bits = [](int threads) {
    ParticlesDef d = charged({}, {1, 0, 0});
    d.magnetic_field = {0, 0, 1};
    FillDef f;
    f.count = 5000, f.speed_spread = 1;
    d.fill = {f};
    d.expression = force("cos(t)", "0", "-z");
    ParticlesRun r(d, 0.05, threads);
    r.run(10);
    const auto x = r.state.f64(particles::columns::position);
    return std::vector<double>(x.begin(), x.end());
  };
  EXPECT_EQ(bits(1), bits(3));
}

}  // namespace
}  // namespace truestep
