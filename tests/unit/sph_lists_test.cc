// Neighbour lists against all pairs, in boxes with walls and periodic ones, and lists that are renewed.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "engine/systems/sph/neighbours.h"
#include "tests/unit/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

SphDef shaken_water(Periodic periodic, Precision precision, int dimension) {
  SphDef d;
  d.dimension = dimension, d.spacing = 0.1, d.precision = precision, d.periodic = periodic;
  d.high = {1.2, 1.2, dimension == 3 ? 0.9 : 1};
  const double half = dimension == 3 ? 0.45 : 1;
  d.bodies = {{.center = {0.6, 0.5, 0.45}, .half_extents = {0.6, 0.5, half}}};
  return d;
}

template <int D, class T>
struct Listed {
  explicit Listed(const SphDef& d) : run(d), near(run.system.setting()) {
    run.shake(0.03, 1);
    f.unit = near.unit(), f.renews = true;
    f.resize(run.system.setting().rows);
    near.sort(f, run.state.span<T>(columns::position).data(), alone);
    near.list(f, alone);
  }
  /// Slots of the neighbours of i.
  std::multiset<size_t> neighbours(size_t i) const {
    std::multiset<size_t> out;
    const Chunk<T>& c = f.chunks[i / kChunk];
    constexpr size_t kLanes = Wide<T>::kLanes;
    for (size_t k = c.first[i % kChunk]; k < c.first[i % kChunk + 1]; k += kLanes) {
      const auto none = c.group(k).padding();
      for (size_t lane = 0; lane < kLanes; ++lane) {
        if (!none[lane]) out.insert(c.base[k / kLanes] + c.group(k).above(lane));
      }
    }
    return out;
  }
  /// m^2, between nearest images.
  double square(size_t i, size_t j) const {
    double out = 0;
    for (size_t a = 0; a < D; ++a) {
      double way = std::abs(double{f.x[a][i]} - double{f.x[a][j]});
      if (f.cells.wraps[a]) way = std::min(way, f.cells.width[a] - way);
      out += way * way;
    }
    return out;
  }

  SphRun run;
  Neighbours<D, T> near;
  ThreadArena alone;
  Fluid<D, T> f;
};

template <int D, class T>
void check(Periodic periodic) {
  Listed<D, T> all(shaken_water(periodic, sizeof(T) == 4 ? Precision::f32 : Precision::f64, D));
  const double radius = all.run.system.setting().support;
  const size_t n = all.f.n;
  ASSERT_GT(n, 50u);
  size_t images = 0;
  for (size_t i = 0; i < n; ++i) {
    const std::multiset<size_t> found = all.neighbours(i);
    for (size_t j = 0; j < n; ++j) {
      const double distance = std::sqrt(all.square(i, j));
      // To rounding of positions.
      if (std::abs(distance - radius) < 1e-6 * radius) continue;
      EXPECT_EQ(found.count(j), i != j && distance < radius ? 1u : 0u) << i << ' ' << j;
      double straight = 0;
      for (size_t a = 0; a < D; ++a) {
        straight += std::pow(double{all.f.x[a][i]} - double{all.f.x[a][j]}, 2);
      }
      images += found.count(j) && std::sqrt(straight) > radius;
    }
  }
  EXPECT_EQ(images > 0, periodic != Periodic::none) << "control: neighbours across a side";
}

TEST(SphLists, HoldEveryNeighbourOnce) {
  for (const Periodic periodic : {Periodic::none, Periodic::x, Periodic::z, Periodic::xz}) {
    check<3, float>(periodic), check<3, double>(periodic);
  }
  check<2, float>(Periodic::none), check<2, double>(Periodic::x);
}

// What renewing makes of positions that have not moved is what listing made of them, to rounding of offsets
// across a side.
TEST(SphLists, AreRenewedAsTheyWere) {
  Listed<3, float> all(shaken_water(Periodic::xz, Precision::f32, 3));
  const auto density = all.f.delta, stiffness = all.f.stiffness;
  all.near.renew(all.f, all.alone);
  double most = 0;
  for (size_t i = 0; i < all.f.n; ++i) {
    EXPECT_NEAR(all.f.delta[i], density[i], 1e-5);
    EXPECT_NEAR(all.f.stiffness[i], stiffness[i], 1e-3 * stiffness[i]);
  }
  // The control: a particle that moves changes its density.
  all.f.x[0][7] += 0.02f;
  all.near.renew(all.f, all.alone);
  for (size_t i = 0; i < all.f.n; ++i) most = std::max(most, std::abs(double{all.f.delta[i] - density[i]}));
  EXPECT_GT(most, 1e-3);
}

// Where images make slots descend, groups end early; elsewhere lists need no such test.
TEST(SphLists, SlotsAscendInsideABox) {
  const auto in_order = [](Periodic periodic) {
    const Listed<3, float> all(shaken_water(periodic, Precision::f32, 3));
    return std::all_of(all.f.chunks.begin(), all.f.chunks.begin() + static_cast<long>(all.f.chunks_in_use()),
                       [](const Chunk<float>& c) { return c.around_in_order; });
  };
  EXPECT_TRUE(in_order(Periodic::none));
  EXPECT_FALSE(in_order(Periodic::xz)) << "control: the last cell's around crosses a side";
}

}  // namespace
}  // namespace truestep::sph
