// Contacts found for later poses and brought back (foreseen_manifold.h): bodies are where their motion takes
// them, and separations are those of now but for the square of the way.
#include "engine/collision/pairs/foreseen_manifold.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/collision/pairs/collide.h"
#include "engine/kernels/rigid/free_rotation.h"
#include "tests/unit/collision/collision_rig.h"

namespace truestep {
namespace {

using namespace collision_rig;

TEST(ForeseenManifold, PlacesFollowTheMotion) {
  for (uint64_t i = 0; i < 100; ++i) {
    const Quat q = random_quat(1, i);
    const Vec3 x = random_unit(2, i), v = random_unit(3, i), w = random_unit(4, i);
    // 0.05 rad: the next term of the series is (0.05)^5 / 120 = 3e-9.
    const Transform later = place_after(transform_of({x, q}), {v, w}, 0.05);
    const Rotation exact = rotation(normalized(free_rotation::turn(w * 0.05) * q));
    EXPECT_LT(norm(later.position - x - v * 0.05), 1e-15);
    for (int k = 0; k < 3; ++k) EXPECT_LT(norm(axis(later.rotation, k) - axis(exact, k)), 4e-9) << i;
  }
}

// Points of the depth that bears; speeds and spins of 1 for 1e-4 s: on bodies of size 1 what curves has
// turned the normal by up to 1e-4 / r, r = 0.01 the roundest, so that separations differ by (1e-4)^2 / r =
// 1e-6. The control: those of the later poses differ by the way, 1e-4.
TEST(ForeseenManifold, SeparationsAreThoseOfNow) {
  constexpr double kAhead = 1e-4, kSame = 1e-6;
  int seen = 0, would_miss = 0;
  for (int ka = 0; ka < kSolids; ++ka) {
    for (int kb = 0; kb < kSolids; ++kb) {
      for (uint64_t i = 0; i < 60; ++i) {
        const Solid sa = sample_solid(ka, i, 1), sb = sample_solid(kb, i + 1000, 1);
        const Transform a = random_transform(1, i, 1);
        Transform b = random_transform(2, i, 0);
        b.position = a.position;
        const Vec3 along = random_unit(3, i);
        const Real s = separation_along({sa, a}, {sb, b}, {along.x, along.y, along.z});
        b.position += along * (0.001 - static_cast<double>(s));
        const SpaceMotion of_a{random_unit(4, i), random_unit(5, i)},
            of_b{random_unit(6, i), random_unit(7, i)};
        const Transform then_a = place_after(a, of_a, kAhead), then_b = place_after(b, of_b, kAhead);
        Manifold now, then;
        if (!collide(sa, a, sb, b, 0.02, now) || !collide(sa, then_a, sb, then_b, 0.02, then)) continue;
        if (now.count != then.count || norm(now.normal - then.normal) > 2e-3) continue;
        for (int p = 0; p < now.count; ++p) {
          const auto same = std::find_if(now.points, now.points + now.count,
                                         [&](const ContactPoint& q) { return q.id == then.points[p].id; });
          if (same == now.points + now.count) continue;
          const ContactPoint& q = then.points[p];
          // Where the outlines of tilted faces cross, a point slides over both of them.
          if (q.separation > 2e-3) continue;
          const double back =
              q.separation - kAhead * parting_speed(q.position, then.normal, then_a, of_a, then_b, of_b);
          ++seen;
          EXPECT_NEAR(back, same->separation, kSame) << ka << ' ' << kb << ' ' << i;
          would_miss += std::abs(q.separation - same->separation) > 10 * kSame;
        }
      }
    }
  }
  EXPECT_GT(seen, 50);
  EXPECT_GT(would_miss, seen / 2);
}

}  // namespace
}  // namespace truestep
