// 100,000 particles with gravity, drag and a few solids, beside hand-written loops over six separate arrays
// (x, y, z, vx, vy, vz) that do the same physics without an engine: no state, no plan, no fractions of a
// step. Error: distance of the falling cloud's mean height from the closed form (no drag) or from our rk4
// (drag).
#include <cmath>
#include <cstdio>
#include <vector>

#include "engine/systems/particles/particles.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;
using namespace truestep::particles;

constexpr size_t kCount = 100'000, kMany = 1'000'000;
constexpr double kStep = 1.0 / 60;

ParticlesDef cloud(const char* integrator, size_t count = kCount) {
  ParticlesDef d;
  FillDef f;
  f.count = static_cast<int64_t>(count), f.center = {0, 10.2, 0}, f.half_extents = {20, 10, 20};
  f.arrangement = FillDef::Arrangement::random;
  d.fill = {f};
  d.integrator = integrator;
  return d;
}

/// The engine's side.
struct Ours {
  explicit Ours(const ParticlesDef& d) {
    BuildContext context;
    context.dt = kStep, context.seed = 1;
    system = Particles::make(d, context);
    state = system->initial_state();
  }
  void step() {
    system->step(state, {static_cast<double>(n) * kStep, kStep, n, workspace, arena});
    ++n;
  }
  double mean_height() const {
    const auto x = state.f64(particles::columns::position);
    double sum = 0;
    for (size_t i = 1; i < x.size(); i += 3) sum += x[i];
    return sum / static_cast<double>(x.size() / 3);
  }
  std::unique_ptr<const Particles> system;
  State state;
  Workspace workspace;
  ThreadArena arena{1};
  uint64_t n = 0;
};

/// The plain side: symplectic Euler or leapfrog with linear drag c / m, and reflection at the plane y = 0.
struct Plain {
  explicit Plain(const Ours& ours) {
    const auto p = ours.state.f64(particles::columns::position);
    for (size_t i = 0; i < p.size(); i += 3) x.push_back(p[i]), y.push_back(p[i + 1]), z.push_back(p[i + 2]);
    vx.resize(x.size()), vy.resize(x.size()), vz.resize(x.size());
  }
  void euler(double c) {
    const double h = kStep;
    for (size_t i = 0; i < x.size(); ++i) {
      vx[i] += h * (-c * vx[i]);
      vy[i] += h * (-9.81 - c * vy[i]);
      vz[i] += h * (-c * vz[i]);
      x[i] += h * vx[i], y[i] += h * vy[i], z[i] += h * vz[i];
    }
  }
  void leapfrog_with_drag(double c) {
    const double h = kStep, half = 0.5 * h;
    for (size_t i = 0; i < x.size(); ++i) {
      const double px = vx[i] + half * (-c * vx[i]), py = vy[i] + half * (-9.81 - c * vy[i]),
                   pz = vz[i] + half * (-c * vz[i]);
      const double nx = vx[i] + h * (-c * px), ny = vy[i] + h * (-9.81 - c * py), nz = vz[i] + h * (-c * pz);
      x[i] += half * (vx[i] + nx), y[i] += half * (vy[i] + ny), z[i] += half * (vz[i] + nz);
      vx[i] = nx, vy[i] = ny, vz[i] = nz;
    }
  }
  void bounce(double e) {
    for (size_t i = 0; i < x.size(); ++i) {
      const bool below = y[i] < 0 && vy[i] < 0;
      vy[i] = below ? -e * vy[i] : vy[i];
      y[i] = below ? 0.0 : y[i];
    }
  }
  double mean_height() const {
    double sum = 0;
    for (const double v : y) sum += v;
    return sum / static_cast<double>(y.size());
  }
  std::vector<double> x, y, z, vx, vy, vz;
};

template <class Step>
void compare(const char* metric, const char* peer_name, const ParticlesDef& d, const ParticlesDef& exact,
             Step&& plain_step) {
  constexpr int kRounds = 41;
  Ours ours(d), reference(exact);
  Plain plain(ours);
  const auto times = bench::interleaved(
      kRounds, [&] { ours.step(); }, [&] { plain_step(plain); });
  for (int k = 0; k < kRounds; ++k) reference.step();
  bench::report({.bench = "particles",
                 .metric = metric,
                 .ours = times.ours,
                 .peer = times.peer,
                 .peer_name = peer_name,
                 .error_ours = std::abs(ours.mean_height() - reference.mean_height()),
                 .error_peer = std::abs(plain.mean_height() - reference.mean_height())});
}

/// Beside memory bandwidth: bytes that a step must move (x and v read and written, masses read) over its
/// time, beside the triad a = b + s c of three arrays of 48 MB, 24 bytes per element.
void share_of_memory(const char* metric, const ParticlesDef& d) {
  constexpr int kRounds = 21;
  constexpr size_t kTriad = 6'000'000;
  Ours ours(d);
  std::vector<double> a(kTriad), b(kTriad, 1.0), c(kTriad, 2.0);
  const auto times = bench::interleaved(
      kRounds, [&] { ours.step(); },
      [&] {
        for (size_t i = 0; i < kTriad; ++i) a[i] = b[i] + 0.5 * c[i];
        b[0] = a[kTriad - 1];
      });
  const double mine = 104e-9 * kMany / times.ours, triad = 24e-9 * kTriad / times.peer;
  std::printf("%s: %.2f ms, %.1f GB/s of %.1f GB/s by the triad, %.0f %%\n", metric, 1e3 * times.ours, mine,
              triad, 100 * mine / triad);
}

}  // namespace

int main() {
  ParticlesDef drag = cloud("symplectic_euler"), exact = cloud("rk4");
  drag.linear_drag = exact.linear_drag = 0.1;
  compare("seconds per step, 1e5 particles, gravity and drag, symplectic Euler", "six plain arrays", drag,
          exact, [](Plain& p) { p.euler(0.1); });
  drag.integrator = "leapfrog";
  compare("seconds per step, 1e5 particles, gravity and drag, leapfrog", "six plain arrays", drag, exact,
          [](Plain& p) { p.leapfrog_with_drag(0.1); });

  ParticlesDef many = cloud("leapfrog", kMany);
  share_of_memory("1e6 particles, gravity, leapfrog", many);
  many.linear_drag = 0.1;
  share_of_memory("1e6 particles, gravity and linear drag, leapfrog", many);
  many.linear_drag = 0, many.quadratic_drag = 0.01;
  share_of_memory("1e6 particles, gravity and quadratic drag, leapfrog", many);
  many.integrator = "velocity_verlet", many.quadratic_drag = 0, many.linear_drag = 0.1;
  share_of_memory("1e6 particles, gravity and linear drag, velocity Verlet, not in one pass", many);

  PlaneColliderDef ground;
  ground.friction = 0;
  SphereColliderDef ball;
  ball.center = {0, 4, 0}, ball.radius = 2;
  BoxColliderDef box;
  box.center = {8, 2, 0}, box.half_extents = {1, 2, 1};
  CapsuleColliderDef bar;
  bar.from = {-8, 3, -3}, bar.to = {-8, 3, 3};
  exact = drag;
  exact.integrator = "rk4";
  drag.colliders = exact.colliders = {ground};
  compare("seconds per step, 1e5 particles, gravity, drag, plane, leapfrog",
          "six plain arrays, clamped at the plane", drag, exact,
          [](Plain& p) { p.leapfrog_with_drag(0.1), p.bounce(0.5); });
  drag.colliders = exact.colliders = {ground, ball, box, bar};
  compare("seconds per step, 1e5 particles, gravity, drag, plane, ball, box, capsule, leapfrog",
          "six plain arrays, plane only", drag, exact,
          [](Plain& p) { p.leapfrog_with_drag(0.1), p.bounce(0.5); });
}
