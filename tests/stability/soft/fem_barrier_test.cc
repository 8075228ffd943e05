// Soft bodies dropped at random on each other and on obstacles, including needles and edges: with a barrier
// no edge of the surface ever passes through a triangle, and no energy is created.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/unit/fem/fem_rig.h"
#include "tests/unit/soft/xpbd_numbers.h"

namespace truestep::fem {
namespace {

using testing_rig::FemRun;
using xpbd::testing_numbers::Numbers;

struct Drop {
  FemDef def;
  double dt;
  Vec3 gravity{0, -9.81, 0};
};

double between(Numbers& r, double low, double high) {
  return low + (high - low) * 0.5 * (1 + r());
}

// Bodies start apart in a column, each rotated and thrown at random; below them are a floor and one obstacle.
Drop random_drop(uint64_t seed) {
  Numbers r{88172645463325252ull ^ (seed * 0x9e3779b97f4a7c15ull)};
  for (int k = 0; k < 8; ++k) r();
  Drop out;
  FemDef& d = out.def;
  const auto side = [&] { return between(r, 0.1, 0.3); };
  const auto cells = [&] { return 1 + static_cast<int>(between(r, 0, 2.999)); };
  const Vec3 size{side(), side(), side()};
  d.block = SoftBlockShape{-0.5 * size, size, cells(), cells(), cells()};
  constexpr Cell kCells[] = {Cell::tet4, Cell::hex8};
  d.element = kCells[static_cast<size_t>(between(r, 0, 1.999))];
  constexpr Law kLaws[] = {Law::corotated, Law::neo_hookean, Law::stable_neo_hookean};
  d.material = kLaws[static_cast<size_t>(between(r, 0, 2.999))];
  d.youngs_modulus = std::pow(10, between(r, 4, 7));
  d.poisson_ratio = between(r, 0, 0.45);
  d.friction = between(r, 0, 1);
  const double reach = norm(size);
  const auto count = 1 + static_cast<size_t>(between(r, 0, 2.999));
  const double speed = std::pow(10, between(r, -1, 1.7));
  for (size_t k = 0; k < count; ++k) {
    d.copies.push_back({{0.1 * r(), 0.3 + reach * (0.55 + 1.05 * double(k)), 0.1 * r()},
                        r.vector(),
                        Vec3{0, -speed, 0} + 0.3 * speed * r.vector(),
                        between(r, 0, 3)});
  }
  d.colliders.push_back(PlaneColliderDef{});
  switch (static_cast<int>(between(r, 0, 3.999))) {
    case 0: {
      CapsuleColliderDef needle;
      needle.from = {0, 0, 0}, needle.to = {0.02, 0.28, 0}, needle.radius = 1e-3;
      d.colliders.push_back(needle);
      break;
    }
    case 1: {
      BoxColliderDef edge;
      edge.half_extents = {0.4, 0.1, 0.002}, edge.center = {0, 0.15, 0};
      d.colliders.push_back(edge);
      break;
    }
    case 2: {
      SphereColliderDef ball;
      ball.radius = 0.1, ball.center = {0.02, 0.12, 0};
      d.colliders.push_back(ball);
      break;
    }
    default:
      break;
  }
  d.contact = Meeting::barrier;
  out.dt = std::pow(10, between(r, -3, -1.5));
  return out;
}

uint64_t asked(const char* name, uint64_t usual) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : usual;
}

// As many seeds as TRUESTEP_BARRIER_DROPS asks for, from TRUESTEP_BARRIER_FIRST on.
TEST(FemBarrier, NothingEverGoesThroughAnything) {
  const uint64_t first = asked("TRUESTEP_BARRIER_FIRST", 1), count = asked("TRUESTEP_BARRIER_DROPS", 30);
  size_t met = 0;
  for (uint64_t seed = first; seed < first + count; ++seed) {
    const Drop drop = random_drop(seed);
    FemRun run(drop.def, drop.dt, drop.gravity);
    // The contact potential is not part of the total, from which friction, barriers and implicit Euler can
    // only take.
    const auto energy = [&] { return run.observe("energy.total") + run.observe("energy.contact"); };
    const double start = energy(), kinetic = run.observe("energy.kinetic");
    const int steps = static_cast<int>(std::min(60.0, 0.5 / drop.dt));
    for (int k = 0; k < steps; ++k) {
      try {
        run.step();
      } catch (const Instability& failure) {
        ADD_FAILURE() << seed << " step " << k << ": " << failure.what();
        break;
      }
      const auto through = run.system->barrier()->surface().entangled(run.state.f64(FemColumns::position), 0);
      ASSERT_FALSE(through.has_value()) << seed << " step " << k << ": " << *through;
    }
    met += run.observe("contact.pairs") > 0;
    // The bound at a minimum of the incremental potential; a millionth is Newton's tolerance.
    EXPECT_LE(energy(), start + 1e-6 * (std::abs(start) + kinetic)) << seed;
  }
  // Most of them are in contact when judged.
  EXPECT_GT(2 * met, count);
}

// The control: nodes that are kept out one by one let edges pass.
TEST(FemBarrier, NodesAloneLetEdgesThrough) {
  size_t through = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    Drop drop = random_drop(seed);
    drop.def.contact = Meeting::nodes;
    FemRun run(drop.def, drop.dt, drop.gravity);
    const std::vector<Surface> rough(run.system->colliders().colliders().size());
    const BarrierSurface surface(run.system->body(), run.system->colliders(), rough, 0);
    for (int k = 0; k < 60; ++k) {
      run.step();
      if (surface.entangled(run.state.f64(FemColumns::position), 0)) {
        ++through;
        break;
      }
    }
  }
  EXPECT_GE(through, 3u);
}

// A bar whose ends are pushed together until it has folded onto itself, and further.
TEST(FemBarrier, WhatIsCrushedFoldsButDoesNotPassItself) {
  FemDef d;
  d.block = SoftBlockShape{{-0.5, -0.05, -0.1}, {1, 0.1, 0.2}, 20, 2, 2};
  d.element = Cell::tet4, d.material = Law::stable_neo_hookean, d.youngs_modulus = 1e5;
  d.holds = {{"x0", "0.4*min(t,1)", "0.02*t", "0"}, {"x1", "-0.4*min(t,1)", "0", "0"}};
  d.contact = Meeting::barrier, d.damping = 2;
  FemRun run(d, 1.0 / 50, {0, -1, 0});
  for (int k = 0; k < 60; ++k) {
    run.step();
    const auto through = run.system->barrier()->surface().entangled(run.state.f64(FemColumns::position), 0);
    ASSERT_FALSE(through.has_value()) << k << ": " << *through;
  }
  EXPECT_GT(run.observe("contact.pairs"), 0);
  // Ends that would have to be in the same place are refused with an explanation.
  d.holds = {{"x0", "0.6*t", "0", "0"}, {"x1", "-0.6*t", "0", "0"}};
  FemRun crushed(d, 1.0 / 50);
  EXPECT_THROW(crushed.step(60), Instability);
}

}  // namespace
}  // namespace truestep::fem
