// Neighbour lists against all pairs, in boxes with walls and periodic ones, and lists that are renewed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "engine/systems/sph/neighbours.h"
#include "engine/systems/sph/solvers/passes.h"
#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

SphDef shaken_water(Periodic periodic, Precision precision, int dimension) {
  SphDef d;
  d.dimension = dimension, d.spacing = 0.1, d.precision = precision, d.periodic = periodic;
  d.high = {1.2, 1.2, dimension == 3 ? 0.9 : 1};
  const double half = dimension == 3 ? 0.45 : 1;
  const double middle = d.wraps(1) ? 0.6 : 0.5;
  d.bodies = {{.center = {0.6, middle, 0.45}, .half_extents = {0.6, middle, half}}};
  return d;
}

template <int D, class T>
struct Listed {
  explicit Listed(const SphDef& d, bool wide = true) : run(d), near(run.system.setting()) {
    if (!wide) near.leave_out_wide();
    run.shake(0.03, 1);
    f.unit = near.unit(), f.renews = true, f.weighted = d.bodies[0].density.has_value();
    f.resize(run.system.setting().rows);
    for (size_t i = 0; f.weighted && i < f.n; ++i) f.light[i] = static_cast<T>(i % 3);
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
  for (const Periodic periodic : {Periodic::none, Periodic::x, Periodic::y, Periodic::xy, Periodic::z,
                                  Periodic::xz, Periodic::yz, Periodic::xyz}) {
    check<3, float>(periodic), check<3, double>(periodic);
  }
  for (const Periodic periodic : {Periodic::none, Periodic::x, Periodic::y, Periodic::xy}) {
    check<2, float>(periodic), check<2, double>(periodic);
  }
}

// What renewing makes of positions that have not moved is what listing made of them, to rounding of offsets
// across a side.
TEST(SphLists, AreRenewedAsTheyWere) {
  Listed<3, float> all(shaken_water(Periodic::xyz, Precision::f32, 3));
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

/// All that lists hold, and their sums.
template <int D>
std::vector<float> contents(const Listed<D, float>& all) {
  std::vector<float> out;
  for (const auto* sums : {&all.f.delta, &all.f.pull, &all.f.stiffness})
    out.insert(out.end(), sums->begin(), sums->end());
  for (size_t i = 0; i < all.f.n; ++i) {
    const Chunk<float>& c = all.f.chunks[i / kChunk];
    for (size_t k = c.first[i % kChunk]; k < c.first[i % kChunk + 1]; ++k) {
      const auto& row = c.group(k).g[k % 8];
      out.insert(out.end(),
                 {static_cast<float>(row[0]), static_cast<float>(row[1]), static_cast<float>(row[2])});
      out.push_back(static_cast<float>(c.base[k / 8] + c.group(k).above(k % 8)));
      for (const auto* kept : {&c.s, &c.w, &c.q}) out.push_back(kept->empty() ? 0 : (*kept)[k]);
    }
  }
  return out;
}

// Loops for wider registers make the plain loops' lists, to the bit: in every kernel, in boxes and across
// sides, for liquids of one density and of several, with all that lists can hold.
TEST(SphLists, EveryProcessorsLoopsMakeTheSame) {
  // Without wider registers the plain loops are compared with themselves.
  RecordProperty("wider_registers",
                 Listed<3, float>(shaken_water(Periodic::none, Precision::f32, 3)).near.wide());
  const auto same = [](const SphDef& d) {
    if (d.dimension == 3) {
      EXPECT_EQ(contents(Listed<3, float>(d, true)), contents(Listed<3, float>(d, false)));
    } else {
      EXPECT_EQ(contents(Listed<2, float>(d, true)), contents(Listed<2, float>(d, false)));
    }
  };
  for (const int dimension : {2, 3}) {
    for (const Smoothing kernel :
         {Smoothing::cubic, Smoothing::wendland_c2, Smoothing::wendland_c4, Smoothing::poly6_spiky}) {
      SphDef d = shaken_water(Periodic::none, Precision::f32, dimension);
      d.kernel = kernel;
      same(d);
      d.periodic = Periodic::x, d.surface_tension = 1;
      same(d);
      d.bodies[0].density = 500, d.surface_tension = 0, d.support = 3;
      same(d);
    }
  }
  // The control: other particles have other lists.
  SphDef d = shaken_water(Periodic::none, Precision::f32, 3);
  Listed<3, float> moved(d);
  const auto before = contents(moved);
  moved.f.x[0][7] += 1e-3f;
  moved.near.list(moved.f, moved.alone);
  EXPECT_NE(contents(moved), before);
}

/// Sums over all lists, as the passes make them.
template <int D, class T>
std::vector<T> sums_of(Listed<D, T>& all, bool wide) {
  if (!wide) all.f.wide_sums = nullptr;
  std::vector<T> out;
  Aligned<T> numbers(all.f.n), rows(4 * all.f.n);
  for (size_t i = 0; i < all.f.n; ++i) {
    const auto u = uniform4(3, 0, i);
    numbers[i] = static_cast<T>(u[3]);
    for (size_t a = 0; a < 3; ++a) rows[4 * i + a] = static_cast<T>(u[a] - 0.5);
  }
  all.f.each_sum(numbers, all.alone, [&](size_t, const T* sums) { out.insert(out.end(), sums, sums + 3); });
  all.f.tally_dots(rows, all.alone, [&](size_t, T dot) {
    out.push_back(dot);
    return std::array<double, 3>{0, 0, 0};
  });
  return out;
}

TEST(SphLists, EveryProcessorsLoopsSumTheSame) {
  for (const Periodic periodic : {Periodic::none, Periodic::xyz}) {
    Listed<3, float> all(shaken_water(periodic, Precision::f32, 3));
    const auto wide = sums_of(all, true), plain = sums_of(all, false);
    EXPECT_EQ(wide, plain);
    // The same sums one entry at a time: groups of eight differ by rounding alone.
    Listed<3, double> exact(shaken_water(periodic, Precision::f64, 3));
    const auto expected = sums_of(exact, false);
    ASSERT_EQ(wide.size(), expected.size());
    double most = 0, largest = 0;
    const double unit = double{all.f.unit} / exact.f.unit;
    for (size_t k = 0; k < wide.size(); ++k) {
      most = std::max(most, std::abs(unit * double{wide[k]} - expected[k]));
      largest = std::max(largest, std::abs(expected[k]));
    }
    // Gradients are rounded to 1 / 32,700 of the steepest; some forty of them are added up.
    EXPECT_LT(most, 1e-3 * largest);
    EXPECT_GT(largest, 0) << "control";
  }
}

/// m/s^2, of random velocities that neighbours blend: by slopes, and by slopes and weights.
template <int D, class T>
std::vector<T> blends_of(Listed<D, T>& all, bool wide) {
  if (!wide) all.f.wide_sums = nullptr;
  for (size_t i = 0; i < all.f.n; ++i) {
    const auto u = uniform4(3, 0, i);
    all.f.v[4 * i + 3] = 0;
    for (size_t a = 0; a < 3; ++a) all.f.v[4 * i + a] = a < D ? static_cast<T>(u[a] - 0.5) : T{0};
  }
  blend_velocities(all.f, T(-0.01), T(0), all.alone);
  std::vector<T> out(all.f.a.begin(), all.f.a.end());
  blend_velocities(all.f, T(-0.01), T(2), all.alone);
  out.insert(out.end(), all.f.a.begin(), all.f.a.end());
  return out;
}
template <int D>
void check_blends() {
  Listed<D, float> all(shaken_water(Periodic::none, Precision::f32, D));
  const auto wide = blends_of(all, true), plain = blends_of(all, false);
  EXPECT_EQ(wide, plain);
  Listed<D, double> exact(shaken_water(Periodic::none, Precision::f64, D));
  const auto expected = blends_of(exact, false);
  ASSERT_EQ(wide.size(), expected.size());
  double most = 0, largest = 0;
  for (size_t k = 0; k < wide.size(); ++k) {
    most = std::max(most, std::abs(double{wide[k]} - expected[k]));
    largest = std::max(largest, std::abs(expected[k]));
  }
  // Rounding of forty terms, and of the positions that slopes are taken at.
  EXPECT_LT(most, 1e-4 * largest);
  EXPECT_NE(std::vector<float>(wide.begin(), wide.begin() + static_cast<long>(wide.size() / 2)),
            std::vector<float>(wide.begin() + static_cast<long>(wide.size() / 2), wide.end()))
      << "control: weights count";
}

TEST(SphLists, EveryProcessorsLoopsBlendVelocitiesTheSame) {
  check_blends<2>(), check_blends<3>();
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
