// Which moments of inertia no body has.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/geometry/mass_properties.h"

namespace truestep {
namespace {

TEST(ImpossibleBodies, TheTestLooksAtPrincipalMoments) {
  // A disc rotated out of its axes: the diagonal alone does not reveal it.
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto turned = [&](double a, double b, double z) {
    return Symmetric3{a * c * c + z * s * s, b, a * s * s + z * c * c, 0, (z - a) * c * s, 0};
  };
  EXPECT_FALSE(inertia_fault(turned(1, 1, 2)));
  EXPECT_TRUE(inertia_fault(turned(1, 1, 2.01)));
}

}  // namespace
}  // namespace truestep
