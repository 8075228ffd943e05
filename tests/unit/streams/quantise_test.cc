// 16-bit values: an error of at most half a quantum; values outside the box and non-finite ones are refused.
#include "engine/sinks/stream/quantise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace truestep {
namespace {

// Quanta. A box is at least 2^-10 of its distance from 0 wide, 2^-26 a quantum; doubles round 2^-53 of that
// distance.
constexpr double kRounding = 0x1p-26;

std::vector<float> random_values(std::mt19937& random, size_t n, float middle, float extent) {
  std::uniform_real_distribution<float> in(-extent, extent);
  std::vector<float> v(n);
  for (float& x : v) x = middle + in(random);
  return v;
}

// Largest |decoded - value| in quanta; `shift` is added to every element, 0 for the true decoding.
double worst_error(const std::vector<float>& v, uint32_t width, const QuantumBox& box,
                   const std::vector<uint16_t>& q, double shift) {
  double worst = 0;
  for (size_t i = 0; i < v.size(); ++i) {
    const double scale = box.scale[i % width];
    if (scale > 0)
      worst = std::max(worst, std::abs(box.offset[i % width] + scale * (q[i] + shift) - v[i]) / scale);
  }
  return worst;
}

TEST(Quantise, ErrorIsHalfAQuantumAtMost) {
  std::mt19937 random(1);
  for (uint32_t width = 1; width <= 6; ++width) {
    for (const size_t rows : {1u, 7u, 8u, 9u, 64u, 1001u}) {
      for (const float middle : {0.f, 1e-20f, -3e4f}) {
        const auto v = random_values(random, rows * width, middle, 0.3f * std::max(std::abs(middle), 1e-22f));
        ColumnBounds bounds;
        ASSERT_TRUE(column_bounds(v.data(), rows, width, bounds));
        for (const QuantumBox& box : {tight_box(bounds), roomy_box(bounds)}) {
          std::vector<uint16_t> q(v.size());
          ASSERT_TRUE(quantise(v.data(), rows, width, box, q.data()));
          EXPECT_LE(worst_error(v, width, box, q, 0), 0.5 + kRounding);
          // The control: elements rounded down, which decode half a quantum lower, violate the bound.
          if (rows > 1000) {
            EXPECT_GT(worst_error(v, width, box, q, -0.5), 0.9);
          }
        }
      }
    }
  }
}

TEST(Quantise, BoundsAreThoseOfEachComponent) {
  std::mt19937 random(2);
  for (uint32_t width = 1; width <= 5; ++width) {
    const auto v = random_values(random, 333 * width, 2, 5);
    ColumnBounds bounds;
    ASSERT_TRUE(column_bounds(v.data(), 333, width, bounds));
    for (uint32_t c = 0; c < width; ++c) {
      float low = v[c], high = v[c];
      for (size_t i = c; i < v.size(); i += width) low = std::min(low, v[i]), high = std::max(high, v[i]);
      EXPECT_EQ(bounds.low[c], low);
      EXPECT_EQ(bounds.high[c], high);
    }
  }
}

TEST(Quantise, WhatIsOutsideOrNotFiniteIsRefusedWhereverItStands) {
  const std::vector<float> good(3 * 37, 0.5f);
  const QuantumBox box{{0, 0, 0}, {1 / 65535.0, 1 / 65535.0, 1 / 65535.0}};
  std::vector<uint16_t> q(good.size());
  ASSERT_TRUE(quantise(good.data(), 37, 3, box, q.data()));
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float bad : {-1e-3f, 1.001f, -1e30f, 1e30f, kInf, -kInf, std::nanf("")}) {
    for (const size_t at : {0u, 1u, 50u, 95u, 96u, 110u}) {
      auto v = good;
      v[at] = bad;
      EXPECT_FALSE(quantise(v.data(), 37, 3, box, q.data())) << bad << " at " << at;
      ColumnBounds bounds;
      EXPECT_EQ(column_bounds(v.data(), 37, 3, bounds), std::isfinite(bad));
    }
  }
}

TEST(Quantise, ExtremesOfFloats) {
  constexpr float kMax = std::numeric_limits<float>::max();
  for (const std::vector<float>& v :
       {std::vector<float>{-kMax, kMax}, {0, std::numeric_limits<float>::denorm_min()}, {7, 7}}) {
    ColumnBounds bounds;
    ASSERT_TRUE(column_bounds(v.data(), 2, 1, bounds));
    for (const QuantumBox& box : {tight_box(bounds), roomy_box(bounds)}) {
      std::vector<uint16_t> q(2);
      EXPECT_TRUE(quantise(v.data(), 2, 1, box, q.data()));
      EXPECT_LE(worst_error(v, 1, box, q, 0), 0.5 + kRounding);
    }
  }
}

}  // namespace
}  // namespace truestep
