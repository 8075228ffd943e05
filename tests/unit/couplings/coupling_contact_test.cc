#include <cmath>

#include "engine/base/random.h"
#include "engine/couplings/contact/contact.h"
#include "engine/kernels/contact/point_hull.h"
#include "tests/support/coupled.h"

namespace truestep {
using namespace contact;
namespace {

using namespace testing_coupled;

Vec3 random_vec(uint64_t stream, uint64_t i) {
  const auto u = uniform4(11, stream, i);
  return {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
}

// The weights give the nearest point: no point of a fine sampling is nearer.
TEST(PointHull, NearestPlaceIsTheNearest) {
  for (uint64_t i = 0; i < 200; ++i) {
    std::array<Vec3, 3> c{random_vec(1, i), random_vec(2, i), random_vec(3, i)};
    if (i % 10 == 0) c[2] = c[0] + (c[1] - c[0]) * 0.3;  // no area
    const Vec3 p = random_vec(4, i) * 2;
    for (size_t corners = 1; corners <= 3; ++corners) {
      const HullWeights w = nearest_on_hull(p, c, corners);
      EXPECT_NEAR(w[0] + w[1] + w[2], 1, 1e-14);
      const double d = norm(p - blend(c, w, corners));
      constexpr int kParts = 40;
      for (int a = 0; a <= (corners > 1 ? kParts : 0); ++a) {
        for (int b = 0; b <= (corners > 2 ? kParts - a : 0); ++b) {
          const double u = double(a) / kParts, v = double(b) / kParts;
          // Rounding of distances of size 3.
          ASSERT_GE(norm(p - blend(c, {1 - u - v, u, v}, corners)), d - 1e-14);
        }
      }
    }
  }
}

// The contact is where a fine search along the paths first comes within reach.
TEST(PointHull, FirstContactIsTheFirst) {
  int hits = 0;
  for (uint64_t i = 0; i < 500; ++i) {
    const size_t corners = 1 + i % 3;
    std::array<HullPath, 3> c;
    for (uint64_t k = 0; k < 3; ++k) {
      c[k] = {random_vec(10 + k, i), random_vec(20 + k, i) * 0.5, random_vec(30 + k, i) * 0.5};
    }
    const Vec3 from = normalized(random_vec(5, i)) * 3;
    const HullPath p{from, random_vec(6, i) * 0.5 - from * 1.5, random_vec(7, i)};
    const double reach = i % 2 ? 0.1 : 1e-9;
    const auto hit = first_hull_contact(p, c, corners, reach);
    const auto apart = [&](double s) {
      std::array<Vec3, 3> at;
      for (size_t k = 0; k < 3; ++k) at[k] = c[k].at(s);
      return norm(p.at(s) - blend(at, nearest_on_hull(p.at(s), at, corners), corners));
    };
    const double until = hit ? hit->s : 1;
    // Until the contact the point is outside; the last hundredth of the path is left to rounding.
    for (int k = 0; k < 400; ++k) {
      const double s = until * k / 400 * 0.9999;
      ASSERT_GE(apart(s), reach * (1 - 1e-6)) << i << " at " << s;
      if (hit && hit->s == 0) break;
    }
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(norm(hit->n), 1, 1e-12);
    if (hit->s > 0) {
      EXPECT_NEAR(hit->apart, reach, 2e-3 * reach + 2e-12) << i;
    }
  }
  EXPECT_GT(hits, 50);
}

// A point at the target to the last bit, sliding along a face: a touch is within the step or does not exist.
TEST(PointHull, TouchesOfWhatRestsAreWithinTheStep) {
  int hits = 0;
  for (uint64_t i = 0; i < 3000; ++i) {
    const double reach = 0.04;
    const Vec3 n = normalized(random_vec(40, i)), at = random_vec(41, i);
    const Vec3 e = normalized(cross(n, random_vec(42, i))), f = cross(n, e);
    const std::array<HullPath, 3> c{
        {{at + e * 0.1, {}, {}}, {at - e * 0.05 + f * 0.08, {}, {}}, {at - e * 0.05 - f * 0.08, {}, {}}}};
    HullPath p;
    p.x = at + n * reach;
    p.v = e * (1e-3 * random_vec(43, i).x) + n * (1e-12 * random_vec(43, i).y * double(i % 2));
    p.a = n * (-1e-12 * double(i % 3));
    const auto hit = first_hull_contact(p, c, 3, reach);
    if (!hit) continue;
    ++hits;
    ASSERT_GE(hit->s, 0) << i;
    ASSERT_LE(hit->s, 1) << i;
    ASSERT_NEAR(hit->apart, reach, 2e-3 * reach) << i;
  }
  EXPECT_GT(hits, 1000);
}

// Particles rain on a free, tumbling cloth; no other forces.
std::string rain(const char* law, double gravity = 0) {
  std::string positions, velocities;
  for (uint64_t i = 0; i < 200; ++i) {
    const Vec3 x = random_vec(1, i), v = random_vec(2, i);
    char text[128];
    std::snprintf(text, sizeof text, "%s[%.3f, %.3f, %.3f]", i ? ", " : "", 0.5 + 0.6 * x.x, 0.5 + 0.3 * x.y,
                  0.5 + 0.6 * x.z);
    positions += text;
    std::snprintf(text, sizeof text, "%s[%.3f, %.3f, %.3f]", i ? ", " : "", v.x, -3 + v.y, v.z);
    velocities += text;
  }
  return R"({"gravity": [0, )" + std::to_string(gravity) + R"(, 0], "time": {"dt": 0.004}, "systems": [
      {"type": "mass_spring", "id": "cloth", "cloth_grid": {"nx": 12, "ny": 10}, "mass": 0.02, "stiffness": 60,
       "velocity": [0.3, 0.4, 0.1], "integrator": "velocity_verlet"},
      {"type": "particles", "id": "dust", "mass": 0.005, "radius": 0.02, "positions": [)" +
         positions + R"(], "velocities": [)" + velocities + R"(]}],
    "couplings": [{"type": "contact", "id": "c", "a": "cloth", "b": "dust", )" +
         law + "}]}";
}

TEST(Contact, KeepsMomentumWithBounceAndFriction) {
  for (const char* law : {R"("restitution": 1, "friction": 0)", R"("restitution": 0.4, "friction": 0.6)",
                          R"("restitution": 0)"}) {
    SceneRun run(rain(law));
    const Sums before = sums(*run.world, run.session.state());
    double contacts = 0;
    for (int i = 0; i < 200; ++i) {
      run.session.step(1);
      contacts += run.observe("c.contacts");
    }
    const Sums after = sums(*run.world, run.session.state());
    EXPECT_GT(contacts, 100) << law;
    EXPECT_LT(norm(after.linear - before.linear), 1e-12 * before.scale) << law;
    // The centre of mass moves on unperturbed: positions are corrected on both sides, too.
    const Vec3 expected = before.center + before.linear * (200 * 0.004 / before.mass);
    EXPECT_LT(norm(after.center - expected), 1e-12) << law;
    // What the particles gave is what the cloth received; the control: one side alone is off by exactly this
    // much.
    const Vec3 given = run.observe3("c.impulse");
    Vec3 cloth = run.observe3("cloth.momentum") - Vec3{0.3, 0.4, 0.1} * (120 * 0.02);
    EXPECT_LT(norm(cloth + given), 1e-12 * before.scale) << law;
    EXPECT_GT(norm(given), 0.05 * before.scale) << law;
    EXPECT_GE(run.observe("c.energy.lost"), -1e-9) << law;
  }
}

// What falls freely together meets as if nothing pulled: the acceleration of a triangle is the mean of its
// corners'.
TEST(Contact, FallingChangesNothingBetweenThem) {
  constexpr double g = -20, t = 75 * 0.004;
  // What slides or rests on the cloth is held over the rest of a step by a mean acceleration.
  for (const auto& [law, tolerance] :
       {std::pair(R"("restitution": 0.4, "friction": 0.6)", 1e-4), {R"("restitution": 0)", 1e-5}}) {
    SceneRun floats(rain(law)), falls(rain(law, g));
    double contacts = 0;
    for (int i = 0; i < 75; ++i) {
      floats.session.step(1), falls.session.step(1);
      contacts += floats.observe("c.contacts");
    }
    EXPECT_GT(contacts, 30) << law << ", control";
    for (size_t k = 0; k < 2; ++k) {
      const State &a = floats.session.state().systems[k], &b = falls.session.state().systems[k];
      const auto x = a.f64(a.at("position")), y = b.f64(b.at("position"));
      double worst = 0;
      for (size_t i = 0; i < x.size() / 3; ++i) {
        worst = std::max(worst, norm(load3(y.data(), i) - load3(x.data(), i) - Vec3{0, 0.5 * g * t * t, 0}));
      }
      EXPECT_LT(worst, tolerance) << law << ", system " << k;
    }
  }
}

// Free points, no friction: impulses act along the line between them, at the time of the touch, so that
// angular momentum is conserved to rounding as well. The control: with friction at a distance it is not.
TEST(Contact, KeepsAngularMomentumWithoutFriction) {
  const auto run_with = [](const char* law) {
    SceneRun run(std::string(R"({"gravity": [0, 0, 0], "time": {"dt": 0.01}, "systems": [
        {"type": "particles", "id": "a", "radius": 0.03, "fill": [{"count": 600, "arrangement": "random",
         "speed_spread": 2}]}],
      "couplings": [{"type": "contact", "id": "c", "a": "a", "b": "a", "restitution": 0.8, )") +
                 law + "}]}");
    // Balls that overlap at first are moved apart, which is not a collision: wait for that.
    run.session.step(4);
    const Sums before = sums(*run.world, run.session.state());
    const double impulse = run.observe("c.impulse.sum");
    run.session.step(60);
    const Sums after = sums(*run.world, run.session.state());
    EXPECT_GT(run.observe("c.impulse.sum"), impulse + 0.05 * before.scale);
    EXPECT_LT(norm(after.linear - before.linear), 1e-12 * before.scale);
    const double change = norm(after.angular - before.angular) / before.scale;
    return change;
  };
  EXPECT_LT(run_with(R"("friction": 0)"), 1e-12);
  EXPECT_GT(run_with(R"("friction": 0.5)"), 1e-4);
}

}  // namespace
}  // namespace truestep
