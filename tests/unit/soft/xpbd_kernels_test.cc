// Constraints of position-based dynamics against finite differences and against the formulas of the papers.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "engine/kernels/xpbd/chain.h"
#include "engine/kernels/xpbd/linear.h"
#include "engine/kernels/xpbd/volume.h"
#include "tests/unit/soft/xpbd_numbers.h"

namespace truestep::xpbd {
namespace {

using testing_numbers::Numbers;
using testing_numbers::slope;

template <class T>
class XpbdKernels : public ::testing::Test {
 protected:
  static constexpr int kLanes = Wide<T>::kLanes;
  // A sum of a few products, each rounded once.
  static constexpr double kRounding = 40 * std::numeric_limits<T>::epsilon();
};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(XpbdKernels, Scalars);

template <class T>
Vec3 place(const std::vector<T>& rows, size_t i) {
  return {rows[4 * i], rows[4 * i + 1], rows[4 * i + 2]};
}

TYPED_TEST(XpbdKernels, RowsComeBackFromTheirLanes) {
  using T = TypeParam;
  constexpr int kLanes = Wide<T>::kLanes;
  std::vector<T> rows(4 * 3 * kLanes), copy(rows.size());
  for (size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<T>(i);
  uint32_t index[kLanes];
  for (uint32_t i = 0; i < kLanes; ++i) index[i] = (5 * i + 2) % (3 * kLanes);
  Wide<T> x[4];
  gather_rows4(rows.data(), index, x);
  for (int i = 0; i < kLanes; ++i) {
    for (int k = 0; k < 4; ++k) EXPECT_EQ(x[k][i], rows[4 * index[i] + k]);
  }
  scatter_rows4(copy.data(), index, x);
  for (int i = 0; i < kLanes; ++i) {
    for (int k = 0; k < 4; ++k) EXPECT_EQ(copy[4 * index[i] + k], rows[4 * index[i] + k]);
  }
}

/// Chains of `links` links, one per lane, with random shape, weights, stiffness and damping.
template <class T>
struct RandomChains {
  static constexpr int kLanes = Wide<T>::kLanes;
  RandomChains(size_t links, double alpha_scale) {
    Numbers r;
    const size_t points = links + 1;
    for (size_t p = 0; p < points * kLanes; ++p) {
      const size_t along = p % points;
      for (const double c : {static_cast<double>(along) + 0.3 * r(), 0.3 * r(), 0.3 * r(), 1.2 + r()}) {
        rows.push_back(static_cast<T>(c));
      }
      const Vec3 drift = 0.05 * r.vector();
      for (const double c :
           {rows[4 * p] + drift.x, rows[4 * p + 1] + drift.y, rows[4 * p + 2] + drift.z, 0.0})
        before.push_back(static_cast<T>(c));
    }
    for (size_t s = 0; s <= links; ++s) {
      for (size_t lane = 0; lane < kLanes; ++lane) index.push_back(static_cast<uint32_t>(lane * points + s));
    }
    for (size_t k = 0; k < links * kLanes; ++k) {
      rest.push_back(static_cast<T>(1 + 0.2 * r()));
      alpha.push_back(static_cast<T>(alpha_scale * (1.1 + r())));
      gamma.push_back(static_cast<T>(0.6 + 0.5 * r()));
      lambda.push_back(static_cast<T>(0.1 * r()));
    }
    chains = {links, index.data(), rest.data(), alpha.data(), gamma.data(), lambda.data()};
    scratch.resize(links);
  }
  /// d_lambda of one lane by a dense solve of the system in compliance.h.
  Eigen::VectorXd reference(size_t lane) const {
    const size_t n = chains.links;
    const auto row = [&](size_t s) { return size_t{index[s * kLanes + lane]}; };
    const auto at = [&](size_t s) { return s * kLanes + lane; };
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(n, 3 * (n + 1)),
                    w = Eigen::MatrixXd::Zero(3 * (n + 1), 3 * (n + 1));
    Eigen::VectorXd b(n);
    for (size_t s = 0; s <= n; ++s) {
      for (size_t k = 0; k < 3; ++k) w(3 * s + k, 3 * s + k) = rows[4 * row(s) + 3];
    }
    for (size_t s = 0; s < n; ++s) {
      const Vec3 d = place(rows, row(s + 1)) - place(rows, row(s)), u = d / norm(d);
      const double components[3] = {u.x, u.y, u.z};
      for (size_t k = 0; k < 3; ++k) j(s, 3 * s + k) = -components[k], j(s, 3 * s + 3 + k) = components[k];
      const Vec3 change = d - (place(before, row(s + 1)) - place(before, row(s)));
      b(s) = -(norm(d) - rest[at(s)]) - double{alpha[at(s)]} * lambda[at(s)] - gamma[at(s)] * dot(u, change);
    }
    Eigen::MatrixXd a = j * w * j.transpose();
    for (size_t s = 0; s < n; ++s) a.row(s) *= 1 + double{gamma[at(s)]}, a(s, s) += alpha[at(s)];
    return a.fullPivLu().solve(b);
  }
  std::vector<T> rows, before, rest, alpha, gamma, lambda;
  std::vector<uint32_t> index;
  Chains<T> chains;
  std::vector<ChainRow<T>> scratch;
};

TYPED_TEST(XpbdKernels, ChainSolvesTheWholeSystem) {
  using T = TypeParam;
  constexpr int kLanes = Wide<T>::kLanes;
  for (const size_t links : {1u, 2u, 9u}) {
    for (const double softness : {0.0, 0.3, 100.0}) {
      RandomChains<T> run(links, softness);
      std::vector<Eigen::VectorXd> expected;
      for (int lane = 0; lane < kLanes; ++lane) expected.push_back(run.reference(lane));
      const auto lambda = run.lambda;
      const auto rows = run.rows;
      solve_chains<T>(run.chains, {}, run.before.data(), T(1), run.rows.data(), run.scratch.data());
      // The condition of the matrix, some hundreds for ten random links, multiplies the rounding.
      const double tolerance = 100 * TestFixture::kRounding;
      for (int lane = 0; lane < kLanes; ++lane) {
        for (size_t s = 0; s < links; ++s) {
          EXPECT_NEAR(run.lambda[s * kLanes + lane] - lambda[s * kLanes + lane], expected[lane](s), tolerance)
              << links << " links, softness " << softness;
        }
        // The last point moves by w grad C d_lambda of the last link alone.
        const size_t last = lane * (links + 1) + links;
        const Vec3 d = place(rows, last) - place(rows, last - 1),
                   moved = place(run.rows, last) - place(rows, last);
        EXPECT_LT(norm(moved - d / norm(d) * (rows[4 * last + 3] * expected[lane](links - 1))), tolerance);
      }
    }
  }
}

TYPED_TEST(XpbdKernels, OneLinkIsThePaper) {
  using T = TypeParam;
  RandomChains<T> run(1, 0.5);
  const auto lambda = run.lambda;
  const auto rows = run.rows;
  solve_chains<T>(run.chains, {}, run.before.data(), T(1), run.rows.data(), run.scratch.data());
  for (size_t lane = 0; lane < size_t(TestFixture::kLanes); ++lane) {
    const Vec3 d = place(rows, 2 * lane + 1) - place(rows, 2 * lane);
    const Vec3 change = d - (place(run.before, 2 * lane + 1) - place(run.before, 2 * lane));
    const double step = multiplier_step<double>(
        norm(d) - run.rest[lane], lambda[lane], dot(d / norm(d), change),
        double{rows[8 * lane + 3]} + rows[8 * lane + 7], {run.alpha[lane], run.gamma[lane]});
    EXPECT_NEAR(run.lambda[lane] - lambda[lane], step, TestFixture::kRounding);
  }
}

TYPED_TEST(XpbdKernels, DisplacementsAreTheSameAsPlaces) {
  using T = TypeParam;
  RandomChains<T> places(6, 0.3), shifts(6, 0.3);
  constexpr size_t kLanes = Wide<T>::kLanes;
  std::vector<T> base(3 * 6 * kLanes);
  const auto start = places.rows;
  for (size_t s = 0; s < 6; ++s) {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const Vec3 d =
          place(start, shifts.index[(s + 1) * kLanes + lane]) - place(start, shifts.index[s * kLanes + lane]);
      base[(3 * s) * kLanes + lane] = static_cast<T>(d.x),
                              base[(3 * s + 1) * kLanes + lane] = static_cast<T>(d.y);
      base[(3 * s + 2) * kLanes + lane] = static_cast<T>(d.z);
    }
  }
  for (size_t k = 0; k < start.size(); ++k) {
    if (k % 4 < 3) shifts.rows[k] = 0, shifts.before[k] -= start[k];
  }
  shifts.chains.base = base.data();
  solve_chains<T>(places.chains, {}, places.before.data(), T(1), places.rows.data(), places.scratch.data());
  solve_chains<T>(shifts.chains, {}, shifts.before.data(), T(1), shifts.rows.data(), shifts.scratch.data());
  for (size_t p = 0; p < start.size() / 4; ++p) {
    EXPECT_LT(norm(place(places.rows, p) - place(start, p) - place(shifts.rows, p)),
              100 * TestFixture::kRounding);
  }
}

TYPED_TEST(XpbdKernels, ChainsSayHowFastTheyTurn) {
  using T = TypeParam;
  constexpr size_t kLanes = Wide<T>::kLanes;
  // Three points in line, the first held; both links 0.1 m too long for 1 m, rigid, h = 1/2 s.
  const T w[3] = {0, T(0.5), 1}, x[3] = {0, T(1.1), T(2.2)};
  std::vector<T> rows, rest(2 * kLanes, T(1)), compliance(2 * kLanes, T(0));
  std::vector<uint32_t> index;
  for (size_t s = 0; s < 3; ++s) {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      index.push_back(static_cast<uint32_t>(rows.size() / 4));
      for (const T c : {x[s], T(0), T(0), w[s]}) rows.push_back(c);
    }
  }
  std::vector<ChainRow<T>> scratch(2);
  const T q = solve_chains<T>({2, index.data(), rest.data(), compliance.data()}, per_step<T>(0.5), nullptr,
                              T(1), rows.data(), scratch.data());
  // 0.5 a - 0.5 b = -0.1 and -0.5 a + 1.5 b = -0.1 give the multipliers a = -0.4, b = -0.2.
  EXPECT_NEAR(q, 0.5 * (0.4 + 0.2) / 1.1, TestFixture::kRounding);
}

TYPED_TEST(XpbdKernels, HeldAndMeetingPointsStayFinite) {
  using T = TypeParam;
  constexpr size_t kLanes = Wide<T>::kLanes;
  // Links 0 and 1 without length or between held ends, a rigid straight chain held at both ends.
  const T w[5] = {0, 0, 1, 1, 0}, x[5] = {0, 1, 1, 2, 3};
  std::vector<T> rows, rest(4 * kLanes, T(1)), alpha(4 * kLanes, T(0));
  std::vector<uint32_t> index;
  for (size_t s = 0; s < 5; ++s) {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      index.push_back(static_cast<uint32_t>(rows.size() / 4));
      for (const T c : {x[s], T(0), T(0), w[s]}) rows.push_back(c);
    }
  }
  std::vector<ChainRow<T>> scratch(4);
  solve_chains<T>({4, index.data(), rest.data(), alpha.data()}, {}, nullptr, T(1), rows.data(),
                  scratch.data());
  for (const T c : rows) EXPECT_TRUE(std::isfinite(c)) << c;
  EXPECT_EQ(rows[4 * kLanes], T(1));
  EXPECT_EQ(rows[16 * kLanes], T(3));
}

TYPED_TEST(XpbdKernels, VolumeMovesAlongItsGradient) {
  using T = TypeParam;
  constexpr size_t kLanes = Wide<T>::kLanes;
  Numbers r;
  std::vector<T> rows, rest, alpha, lambda;
  std::vector<uint32_t> index(4 * kLanes);
  for (size_t lane = 0; lane < kLanes; ++lane) {
    for (size_t i = 0; i < 4; ++i) {
      index[i * kLanes + lane] = static_cast<uint32_t>(rows.size() / 4);
      const Vec3 corner{i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0, i == 3 ? 1.0 : 0.0},
          x = corner + 0.2 * r.vector();
      for (const double c : {x.x, x.y, x.z, 1.1 + r()}) rows.push_back(static_cast<T>(c));
    }
    rest.push_back(static_cast<T>(0.15 + 0.05 * r()));
    alpha.push_back(static_cast<T>(0.02 * (1.1 + r())));
    lambda.push_back(static_cast<T>(0.1 * r()));
  }
  const auto old = rows;
  const auto old_lambda = lambda;
  solve_volumes<T>({index.data(), rest.data(), alpha.data(), lambda.data()}, {}, T(1), rows.data());
  const auto v = [](const std::vector<Vec3>& x) { return volume(x[0], x[1], x[2], x[3]); };
  for (size_t lane = 0; lane < kLanes; ++lane) {
    std::vector<Vec3> x;
    for (size_t i = 0; i < 4; ++i) x.push_back(place(old, 4 * lane + i));
    double weight = 0;
    for (size_t i = 0; i < 4; ++i) weight += old[16 * lane + 4 * i + 3] * norm2(slope(v, x, i));
    const double step =
        multiplier_step<double>(v(x) - rest[lane], old_lambda[lane], 0, weight, {alpha[lane], 0});
    // Central differences of a cubic are exact but for rounding, 1e-16 / 1e-5.
    EXPECT_NEAR(lambda[lane] - old_lambda[lane], step, 1e-9 + 10 * TestFixture::kRounding);
    for (size_t i = 0; i < 4; ++i) {
      const Vec3 moved = place(rows, 4 * lane + i) - x[i];
      EXPECT_LT(norm(moved - slope(v, x, i) * (old[16 * lane + 4 * i + 3] * step)),
                1e-9 + 10 * TestFixture::kRounding);
    }
  }
}

TYPED_TEST(XpbdKernels, LinearConstraintsTakeTheirExactStep) {
  using T = TypeParam;
  constexpr size_t kLanes = Wide<T>::kLanes;
  Numbers r;
  std::vector<T> rows, k, alpha, lambda;
  std::vector<uint32_t> index(4 * kLanes);
  for (size_t lane = 0; lane < kLanes; ++lane) {
    for (size_t i = 0; i < 4; ++i) {
      index[i * kLanes + lane] = static_cast<uint32_t>(rows.size() / 4);
      const Vec3 x = r.vector();
      for (const double c : {x.x, x.y, x.z, 1.1 + r()}) rows.push_back(static_cast<T>(c));
    }
  }
  for (size_t i = 0; i < 4 * kLanes; ++i) k.push_back(static_cast<T>(r()));
  for (size_t i = 0; i < kLanes; ++i) alpha.push_back(static_cast<T>(1.1 + r()));
  for (size_t i = 0; i < 3 * kLanes; ++i) lambda.push_back(static_cast<T>(r()));
  solve_linear<T, 4>({index.data(), k.data(), alpha.data(), lambda.data()}, {}, T(1), rows.data());
  // After the step C + alpha lambda = 0: it is linear, so once is enough.
  for (size_t lane = 0; lane < kLanes; ++lane) {
    Vec3 c;
    for (size_t i = 0; i < 4; ++i) c += place(rows, 4 * lane + i) * double{k[i * kLanes + lane]};
    const double a = alpha[lane];
    EXPECT_LT(norm(c + Vec3{a * lambda[lane], a * lambda[kLanes + lane], a * lambda[2 * kLanes + lane]}),
              TestFixture::kRounding);
  }
}

}  // namespace
}  // namespace truestep::xpbd
