// Smoothing kernels and the contributions of walls to the sums over them.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "engine/kernels/sph/cohesion.h"
#include "engine/kernels/sph/half_space.h"
#include "engine/systems/sph/lists/pair_list.h"

namespace truestep::sph {
namespace {

constexpr Smoothing kAll[] = {Smoothing::cubic, Smoothing::wendland_c2, Smoothing::wendland_c4,
                              Smoothing::poly6_spiky};

// The integral over the support is one: the midpoint rule with 4,000 shells is good to 1e-6.
TEST(SphKernels, IntegrateToOne) {
  constexpr int kShells = 4000;
  for (const Smoothing kind : kAll) {
    for (const int dimension : {2, 3}) {
      double sum = 0;
      for (int k = 0; k < kShells; ++k) {
        const double q = (k + 0.5) / kShells;
        sum += smoothing_at(kind, q).w[0] *
               (dimension == 2 ? 2 * std::numbers::pi * q : 4 * std::numbers::pi * q * q) / kShells;
      }
      EXPECT_NEAR(sum * smoothing_sigma(kind, dimension), 1, 1e-6);
      EXPECT_GT(std::abs(sum * smoothing_sigma(kind, 5 - dimension) - 1), 0.1)
          << "control: the other dimension";
    }
  }
}

// s is the derivative of w over q, of the pair that of (1 - q)^3; central differences over 2e-5 are good to
// 1e-8.
TEST(SphKernels, SlopesAreDerivatives) {
  for (const Smoothing kind : kAll) {
    const auto value = [kind](double q) {
      return slopes_of_values(kind) ? smoothing_at(kind, q).w[0] : (1 - q) * (1 - q) * (1 - q);
    };
    for (double q = 0.05; q < 1; q += 0.0931) {
      const double d = (value(q + 1e-5) - value(q - 1e-5)) / 2e-5;
      EXPECT_NEAR(smoothing_at(kind, q).s[0] * q, d, 1e-7);
    }
    EXPECT_EQ(smoothing_at(kind, 1.0).w[0], 0);
    EXPECT_GT(std::abs(smoothing_at(kind, 0.4).s[0]), 0.1) << "control";
  }
}

// Mueller, Charypar & Gross 2003, equations 20 and 21, in space with h = 1: poly6 is 315 / (64 pi) in the
// middle and 27/64 of that at a half, the gradient of spiky there -45 / (4 pi). Spiky too has the integral 1:
// by parts, that of -q dW/dq over the dimension. Where two particles meet the gradient is as large as ever.
TEST(SphKernels, ThePairIsPoly6AndSpiky) {
  constexpr Smoothing kPair = Smoothing::poly6_spiky;
  EXPECT_NEAR(smoothing_sigma(kPair, 3) * smoothing_at(kPair, 0).w[0], 1.566681471060845, 1e-12);
  EXPECT_NEAR(smoothing_sigma(kPair, 3) * smoothing_at(kPair, 0.5).w[0], 0.660943745603794, 1e-12);
  EXPECT_NEAR(slope_sigma(kPair, 3) * 0.5 * smoothing_at(kPair, 0.5).s[0], -3.580986219567645, 1e-12);
  constexpr int kShells = 4000;
  for (const int dimension : {2, 3}) {
    double sum = 0;
    for (int k = 0; k < kShells; ++k) {
      const double q = (k + 0.5) / kShells,
                   shell = dimension == 2 ? 2 * std::numbers::pi * q : 4 * std::numbers::pi * q * q;
      sum -= smoothing_at(kPair, q).s[0] * q * q * shell / kShells / dimension;
    }
    // The midpoint rule, and the thousandth of the radius within which the gradient is let fall to 0.
    EXPECT_NEAR(sum * slope_sigma(kPair, dimension), 1, 1e-5);
    EXPECT_GT(std::abs(sum * smoothing_sigma(kPair, dimension) - 1), 0.1) << "control: the sigma of poly6";
  }
  const auto steep = [](Smoothing kind, double q) { return -q * smoothing_at(kind, q).s[0]; };
  EXPECT_NEAR(steep(kPair, 0.002), 3, 0.02);
  EXPECT_LT(steep(Smoothing::wendland_c2, 0.002), 0.05) << "control: a kernel that is smooth there";
}

// Layers half a spacing, three halves, ... behind a wall continue those before it: rows of particles at a
// half, three halves, ... from the wall then have the same sums as in the bulk of the fluid.
TEST(SphWalls, CompleteTheFluid) {
  for (const Smoothing kind : kAll) {
    for (const int dimension : {2, 3}) {
      HalfSpace wall;
      wall.set(kind, dimension, 2.5, 1);
      // In the bulk, half of everything outside a particle's own layer lies below that layer.
      const double own = 1 - 2 * wall.at(0.5).share;
      EXPECT_GT(own, 0.2);
      EXPECT_LT(own, 0.8);
      EXPECT_NEAR(wall.at(3).share, 0, 1e-12) << "out of reach";
      // The slope is the derivative of the share: tables of 512 intervals, linear between.
      for (double d = 0.1; d < 2.4 && slopes_of_values(kind); d += 0.37) {
        const double change = (wall.at(d - 0.02).share - wall.at(d + 0.02).share) / 0.04;
        EXPECT_NEAR(wall.at(d).slope, change, 0.01 * wall.at(0.5).slope);
      }
      // All layers of a straight line through the wall, those before it too, find the line's slope: the sum
      // of depths (1 and 2 spacings, on either side) times slopes is 1, to what the layers of a kernel of
      // this width leave of the integral; exactly so where slopes are not of the values.
      const double nearest = wall.at(0.5).slope - wall.at(1.5).slope, second = wall.at(1.5).slope;
      EXPECT_NEAR(2 * (nearest + 2 * second), 1, slopes_of_values(kind) ? 0.06 : 1e-3);
      EXPECT_GT(wall.at(0.5).slope, 10 * wall.at(2.3).slope) << "control: slopes differ";
    }
  }
}

// Akinci, Akinci & Teschner 2013: the work that separates a pair is the integral of the force along the way,
// and the bonds of a lattice much finer than the kernel have the tension of a continuum (Fowler 1937): in
// space pi / 2 n^2 times the integral of r^3 and the work, in the plane n^2 times that of r^2.
TEST(SphCohesion, IsStrongAsTheTensionSays) {
  for (double q = 0.02; q < 1; q += 0.07) {
    const double slope = (cohesion_work(q - 1e-4) - cohesion_work(q + 1e-4)) / 2e-4;
    EXPECT_NEAR(slope, cohesion(Wide<double>::all(q))[0], 1e-6) << q;
  }
  EXPECT_EQ(cohesion_work(1), 0);
  EXPECT_LT(cohesion(Wide<double>::all(0.1))[0], 0) << "too close";
  constexpr double kTension = 0.07, kRho = 1000, kSupport = 0.1;
  for (const int dimension : {2, 3}) {
    const auto tension_of = [&](double spacing) {
      const double strength = cohesion_strength(kTension, kRho, dimension, spacing, kSupport);
      const double n = dimension == 2 ? 1 / (spacing * spacing) : 1 / (spacing * spacing * spacing);
      double sum = 0;
      for (double q = 0.0005; q < 1; q += 0.001) {
        const double r = q * kSupport, bond = kRho / n * strength * kSupport * cohesion_work(q);
        sum += (dimension == 2 ? r * r : std::numbers::pi / 2 * r * r * r) * bond * 0.001 * kSupport;
      }
      return n * n * sum;
    };
    EXPECT_NEAR(tension_of(kSupport / 10), kTension, 0.01 * kTension) << dimension;
    EXPECT_GT(std::abs(tension_of(kSupport / 1.5) - kTension), 0.05 * kTension)
        << "control: a coarse lattice";
  }
}

// What passes read of a list: gradients in steps of the steepest, opposite to the bit for opposite offsets,
// lanes that a comparison picks, and sums.
TEST(SphLists, RoundedGradientsAreOppositeAndWhole) {
  for (const float x : {0.4f, 0.5f, 1.5f, 2.6f, 1234.5f, 32'699.7f}) {
    const Wide<float> up = nearest(Wide<float>::all(x)), down = nearest(Wide<float>::all(-x));
    EXPECT_EQ(up[3], -down[3]) << x;
    EXPECT_NEAR(up[0], x, 0.5f);
    EXPECT_EQ(up[5], std::nearbyint(x));
    int16_t kept[8][4] = {};
    const Wide<float> axes[3] = {down, up, down};
    store_rows3(kept, axes);
    EXPECT_EQ(load_as<float>(kept[2])[5], std::nearbyint(x)) << x;
  }
  for (const Smoothing kind : kAll) {
    // No gradient is out of the range of its steps.
    for (double q = 0.0005; q < 1; q += 0.00071) {
      EXPECT_LT(-q * smoothing_at(kind, q).s[0], 1.001 * steepest(kind));
    }
  }
}

TEST(SphLists, LanesAreStoredSideBySide) {
  const auto check = [](auto one) {
    using T = decltype(one);
    Wide<T> a;
    T total = 0;
    for (int i = 0; i < Wide<T>::kLanes; ++i) a.set(i, T(1) + static_cast<T>(i * i)), total += a[i];
    EXPECT_EQ(sum(a), total);
    const Wide<T> four[4] = {a, a + a, -a, Wide<T>::zero()};
    T sums[4];
    sum_each(four, sums);
    for (int k = 0; k < 4; ++k) EXPECT_EQ(sums[k], sum(four[k])) << k;
    const Wide<T> low = smallest(-a), high = largest(a);
    for (int i = 0; i < Wide<T>::kLanes; ++i) {
      EXPECT_EQ(low[i], -a[Wide<T>::kLanes - 1]);
      EXPECT_EQ(high[i], a[Wide<T>::kLanes - 1]);
    }
    for (const uint32_t bits : {1u, 6u, 9u, 15u}) {
      T out[8] = {};
      uint32_t places[8] = {};
      const LanesOf<T> lanes(bits);
      lanes.store(out, a);
      EXPECT_EQ(store_lanes<Wide<T>::kLanes>(places, 100, bits), lanes.count());
      size_t k = 0;
      for (int i = 0; i < 4; ++i) {
        if (!(bits >> i & 1)) continue;
        EXPECT_EQ(out[k], a[i]) << bits;
        EXPECT_EQ(places[k++], 100u + static_cast<uint32_t>(i)) << bits;
      }
      EXPECT_EQ(lanes.count(), k);
    }
  };
  check(1.0f), check(1.0);
}

// Rows of four: what is last in them stays, each number is found again where it was put, and sums over rows
// that lie side by side are those of one after the other.
TEST(SphLists, RowsOfFourAreKeptAndSummed) {
  const auto check = [](auto one, auto kept) {
    using T = decltype(one);
    using Kept = decltype(kept);
    constexpr size_t kLanes = Wide<T>::kLanes;
    Kept rows[kLanes][4] = {};
    Wide<T> in[3], out[3];
    for (size_t i = 0; i < kLanes; ++i) {
      rows[i][3] = static_cast<Kept>(100 + i);
      for (size_t k = 0; k < 3; ++k) in[k].set(static_cast<int>(i), static_cast<T>(10 * i + k) - T(35));
    }
    store_rows3(rows, in), load_rows3(rows, out);
    for (size_t i = 0; i < kLanes; ++i) {
      EXPECT_EQ(rows[i][3], static_cast<Kept>(100 + i));
      for (size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(rows[i][k], static_cast<Kept>(10 * i + k) - Kept(35));
        EXPECT_EQ(out[k][static_cast<int>(i)], in[k][static_cast<int>(i)]);
      }
    }
    alignas(32) const T table[20] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19};
    Wide<T> columns[4];
    for (size_t i = 0; i < kLanes; ++i) {
      for (size_t k = 0; k < 4; ++k) columns[k].set(static_cast<int>(i), static_cast<T>(10 * i + k));
    }
    T put[4 * kLanes];
    put_rows4(put, columns);
    for (size_t k = 0; k < 4 * kLanes; ++k) EXPECT_EQ(put[k], static_cast<T>(10 * (k / 4) + k % 4)) << k;
    const size_t slots[2] = {4, 1};
    const Wide<T> side = rows_side_by_side(table, slots), fours = numbers_by_fours(table, slots);
    const bool two = kRowsSide<T> == 2;
    T sums[4];
    sum_rows(side, sums);
    for (size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(sums[k], table[16 + k] + (two ? table[4 + k] : T{0}));
      EXPECT_EQ(fours[static_cast<int>(k)], T(4));
    }
    EXPECT_EQ(fours[static_cast<int>(kLanes) - 1], two ? T(1) : T(4));
  };
  check(1.0f, int16_t{1}), check(1.0, 1.0);
}

// A slot that is more than 2^15 above the first of its group, or below it, begins another group.
TEST(SphLists, SlotsFarApartAreInGroupsOfTheirOwn) {
  const auto check = [](auto one) {
    using T = decltype(one);
    constexpr size_t kLanes = Wide<T>::kLanes;
    Chunk<T> c;
    const uint32_t slots[] = {7, 9, 70'000, 70'001, 70'002, 3, 4, 32'770, 32'771};
    constexpr size_t kCount = 9, kBegin = 16;
    c.need(kBegin + kLanes * kCount, 0);
    c.around_rows.resize(4 * kCount), c.near.resize(kCount + kLanes);
    for (size_t k = 0; k < kCount; ++k) {
      using Slot = std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>;
      c.near[k] = static_cast<uint32_t>(k), c.around_rows[4 * k] = static_cast<T>(slots[k]);
      c.around_rows[4 * k + 3] = std::bit_cast<T>(Slot{slots[k]});
    }
    std::vector<uint32_t> found;
    size_t end = kBegin;
    for (size_t at = 0; at < kCount; end += kLanes) {
      Wide<T> there[4];
      const auto taken = c.template take<false>(at, kCount, there);
      c.base[end / kLanes] = taken.base;
      Group<T>& g = c.group(end);
      g.set(there, typename Wide<T>::Mask{});
      EXPECT_EQ(g.above(1), 0) << "control: slots are those that are set";
      g.set(there, taken.above);
      for (size_t lane = 0; lane < kLanes; ++lane) {
        EXPECT_EQ(taken.inside[lane] != 0, lane < taken.count);
        if (lane < taken.count) {
          found.push_back(c.base[end / kLanes] + g.above(lane));
          EXPECT_EQ(there[0][static_cast<int>(lane)], static_cast<T>(found.back()));
        } else {
          EXPECT_EQ(g.above(lane), 0) << "what fills a group up is its first slot";
        }
      }
      at += taken.count;
    }
    // 7 9 | 70000 70001 70002 | 3 4 32770 | 32771 - 3 is too much.
    EXPECT_EQ(end, kBegin + 4 * kLanes);
    EXPECT_EQ(found, std::vector<uint32_t>(std::begin(slots), std::end(slots)));
  };
  check(1.0f), check(1.0);
}

}  // namespace
}  // namespace truestep::sph
