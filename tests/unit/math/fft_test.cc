// Fourier and trigonometric transforms against their defining sums, and against the second differences that
// they diagonalize.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "engine/math/solvers/trig_transform.h"

namespace truestep {
namespace {

std::vector<double> noise(size_t n, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> between(-1, 1);
  std::vector<double> v(n);
  for (double& x : v) x = between(generator);
  return v;
}

TEST(FftTest, EveryLengthIsItsSum) {
  constexpr size_t kE = Fft::kElement, kL = Fft::kLanes;
  for (const size_t n : {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12,  13, 15,
                         16, 20, 23, 25, 27, 30, 36, 49, 60, 64, 97, 128, 254}) {
    const Fft fft(n);
    const auto x = noise(n * kE, static_cast<unsigned>(n));
    Fft::Buffer y(x.begin(), x.end()), scratch(fft.scratch_size());
    fft.run(y.data(), scratch.data());
    double worst = 0;
    for (const size_t lane : {size_t{0}, kL - 1}) {
      for (size_t k = 0; k < n; ++k) {
        double re = 0, im = 0;
        for (size_t j = 0; j < n; ++j) {
          const double a = -2 * std::numbers::pi * double(j * k % n) / double(n), c = std::cos(a),
                       s = std::sin(a);
          const double xr = x[j * kE + lane], xi = x[j * kE + kL + lane];
          re += xr * c - xi * s, im += xr * s + xi * c;
        }
        worst = std::max({worst, std::abs(re - y[k * kE + lane]), std::abs(im - y[k * kE + kL + lane])});
      }
    }
    // Roundings grow with the logarithm of n, those of the sum here with its root: some 1e-15 root(n) each.
    EXPECT_LT(worst, 1e-14 * std::sqrt(double(n)) + 1e-15) << n;
  }
}

using End = TrigTransform::End;
struct Ends {
  End low, high;
};

TEST(TrigTransform, ThereAndBackIsTheIdentity) {
  for (const auto& [low, high] :
       {Ends{End::zero, End::zero}, Ends{End::even, End::even}, Ends{End::zero, End::even},
        Ends{End::even, End::zero}, Ends{End::periodic, End::periodic}}) {
    for (const size_t n : {3, 4, 5, 7, 12, 32, 50}) {
      const TrigTransform t(low, high, n);
      for (const size_t count : {size_t{1}, size_t{5}, TrigTransform::kLines}) {
        const size_t lines = TrigTransform::kLines;
        auto x = noise(t.nodes() * lines, static_cast<unsigned>(n));
        const auto before = x;
        std::vector<double> scratch(t.scratch_size());
        t.forward(x.data(), lines, 1, count, scratch.data());
        EXPECT_NE(x, before);
        t.backward(x.data(), lines, 1, count, scratch.data());
        double worst = 0;
        for (size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - before[i]));
        EXPECT_LT(worst, 3e-15 * std::log2(8 * double(n))) << n << " " << count;
      }
    }
  }
}

TEST(TrigTransform, SecondDifferencesBecomeFactors) {
  for (const auto& [low, high] :
       {Ends{End::zero, End::zero}, Ends{End::even, End::even}, Ends{End::zero, End::even},
        Ends{End::even, End::zero}, Ends{End::periodic, End::periodic}}) {
    const size_t n = 12;
    const TrigTransform t(low, high, n);
    auto x = noise(t.nodes(), 3);
    if (low == End::zero) x[0] = 0;
    if (high == End::zero) x[n] = 0;
    std::vector<double> d(x.size()), scratch(t.scratch_size());
    for (size_t i = t.first(); i <= t.last(); ++i) {
      const double before = i > 0 ? x[i - 1] : low == End::periodic ? x[n - 1] : x[1];
      const double after = i + 1 < x.size() ? x[i + 1] : low == End::periodic ? x[0] : x[n - 1];
      d[i] = before - 2 * x[i] + after;
    }
    t.forward(x.data(), 1, t.nodes(), 1, scratch.data());
    t.forward(d.data(), 1, t.nodes(), 1, scratch.data());
    double worst = 0, largest = 0, wrong = 0;
    for (size_t i = t.first(); i <= t.last(); ++i) {
      worst = std::max(worst, std::abs(d[i] - (2 * std::cos(t.angle(i)) - 2) * x[i]));
      wrong = std::max(wrong, std::abs(d[i] - (2 * std::cos(t.angle(i) + 0.1) - 2) * x[i]));
      largest = std::max(largest, std::abs(x[i]));
    }
    EXPECT_LT(worst, 1e-14 * largest);
    EXPECT_GT(wrong, 1e-2 * largest) << "control: another angle";
  }
}

}  // namespace
}  // namespace truestep
