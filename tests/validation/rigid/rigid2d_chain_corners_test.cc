// Contacts at the inner corners of a bent chain push away from it, not along it. (Which sides of a chain are
// solid is in tests/scenes/rigid/chain_*_2d.json.)
#include <gtest/gtest.h>

#include <cmath>

#include "engine/collision/flat/contact.h"

namespace truestep::testing {
namespace {

/// Over every inner corner of a bent chain, from either side, the normal is within the fan of the two faces.
/// The control: segments without neighbours push along the chain.
TEST(Rigid2dChain, ContactsAtBentCornersStayWithinTheFan) {
  using namespace flat;
  const Vec2 p[] = {{-2, -0.3}, {-1, 0.1}, {0, 0}, {1, 0.2}, {2, -0.2}};
  const auto links = chain(p, Ends::open, Outline::Side::both);
  int touched = 0, caught = 0;
  for (const double side : {1.0, -1.0}) {
    for (double x = -1.5; x < 1.5; x += 0.007) {
      // Its lowest point is 2 mm inside the chain.
      const auto line = [&](double at) {
        size_t k = 0;
        while (at > p[k + 1].x) ++k;
        const double u = (at - p[k].x) / (p[k + 1].x - p[k].x);
        return p[k].y + u * (p[k + 1].y - p[k].y);
      };
      double y = side * 10;
      for (double a = 0; a < 3.14159; a += 0.01) {
        const double reach = line(x + 0.2 * std::cos(a)) + side * 0.2 * std::sin(a);
        y = side > 0 ? (a == 0 ? reach : std::max(y, reach)) : (a == 0 ? reach : std::min(y, reach));
      }
      for (const Outline& link : links) {
        flat::Contact c;
        if (touch(link, circle(0.2), {{x, y - 0.002 * side}, {}}, 0.001, c)) {
          ++touched;
          EXPECT_GT(c.normal.y * side, 0.9) << x << " " << side;
        }
        const Outline alone = capsule(link.corner[0], link.corner[1], 0);
        if (touch(alone, box(0.2, 0.2), {{x, line(x) + 0.2 * side}, {}}, 0.01, c)) {
          caught += c.normal.y * side < 0.9;
        }
      }
    }
  }
  EXPECT_GT(touched, 400);
  EXPECT_GT(caught, 10);
}

}  // namespace
}  // namespace truestep::testing
