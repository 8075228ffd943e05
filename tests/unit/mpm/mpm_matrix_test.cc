// Singular values and vectors of 2 x 2 and 3 x 3 matrices in lanes, for difficult matrices.
#include <gtest/gtest.h>

#include <limits>

#include "engine/kernels/mpm/small_matrix.h"

namespace truestep::mpm {
namespace {

// Largest deviation of U diag(s) V^T from A, of U^T U and V^T V from 1 and of their determinants from 1, over
// the largest singular value.
template <int D, class T>
double fault(const Square<D, T>& a, int lane = 0) {
  const Svd<D, T> d = svd(a);
  const Square<D, T> back = compose(d.u, d.s, d.v);
  const double scale = std::max(1e-30, std::abs(double{d.s[0][lane]}));
  double worst = 0;
  for (int k = 0; k < D * D; ++k)
    worst = std::max(worst, std::abs(double{back.m[k][lane]} - double{a.m[k][lane]}) / scale);
  const Wide<T> one[3] = {Wide<T>(1), Wide<T>(1), Wide<T>(1)};
  for (const auto* m : {&d.u, &d.v}) {
    const Square<D, T> unit = compose(*m, one, *m);
    for (int k = 0; k < D * D; ++k)
      worst = std::max(worst, std::abs(double{unit.m[k][lane]} - (k % (D + 1) == 0 ? 1 : 0)));
    worst = std::max(worst, std::abs(double{determinant(*m)[lane]} - 1));
  }
  for (int k = 0; k + 1 < D; ++k) {
    const double next = std::abs(double{d.s[k + 1][lane]});
    worst = std::max(worst, (next - double{d.s[k][lane]}) / scale);
  }
  return std::isfinite(worst) ? worst : std::numeric_limits<double>::infinity();
}

// A dozen roundings of products of unit vectors.
template <class T>
constexpr double kTolerance = 40 * std::numeric_limits<T>::epsilon();

template <int D, class T>
Square<D, T> filled(const double* m) {
  Square<D, T> a;
  for (int k = 0; k < D * D; ++k) a.m[k] = Wide<T>(m[k]);
  return a;
}

template <int D, class T>
void hard_matrices() {
  const double list3[][9] = {{0, 0, 0, 0, 0, 0, 0, 0, 0},         {1, 0, 0, 0, 1, 0, 0, 0, 1},
                             {-1, 0, 0, 0, 1, 0, 0, 0, 1},        {-1, 0, 0, 0, -1, 0, 0, 0, -1},
                             {1, 1, 1, 1, 1, 1, 1, 1, 1},         {1, 2, 3, 2, 4, 6, 3, 6, 9.0000001},
                             {1, 0, 0, 0, 1e-12, 0, 0, 0, 1e-15}, {0, 1, 0, 0, 0, 1, 1, 0, 0},
                             {1, 1e-7, 0, -1e-7, 1, 0, 0, 0, 1},  {0, 0, 0, 0, 0, 0, 0, 0, 2},
                             {1e3, 1, 0, 0, 1e-3, 1, 0, 0, 1e3},  {3, 4, 5, -4, 3, 1, 2, -2, 7}};
  for (const auto& m : list3) {
    const auto a = filled<D, T>(m);
    EXPECT_LT((fault<D, T>(a)), kTolerance<T>) << m[0] << ' ' << m[1] << ' ' << m[2] << ' ' << m[3];
  }
}

TEST(MpmMatrix, HardMatricesComeApartAndTogether) {
  hard_matrices<2, float>(), hard_matrices<2, double>();
  hard_matrices<3, float>(), hard_matrices<3, double>();
}

TEST(MpmMatrix, AMirroredMatrixHasItsSignInTheLastValue) {
  const double mirror[9] = {1, 0, 0, 0, 2, 0, 0, 0, -3};
  const auto d = svd(filled<3, double>(mirror));
  EXPECT_NEAR(d.s[0][0], 3, 1e-14);
  EXPECT_NEAR(d.s[2][0], -1, 1e-14);
}

// Largest deviation of the nearest rotation from U V^T. Where singular values s and t of opposite sign, or
// both near 0, meet, rounding is divided by s + t: the matrices are such that the smallest is at least a
// hundredth of the largest, or a tenth on the far side of the plane of reflections.
template <int D, class T>
double rotation_fault(const Square<D, T>& a, int lane) {
  const Svd<D, T> d = svd(a);
  const Wide<T> one[3] = {Wide<T>(1), Wide<T>(1), Wide<T>(1)};
  const Square<D, T> expected = compose(d.u, one, d.v), got = nearest_rotation(a);
  double worst = 0;
  for (int k = 0; k < D * D; ++k)
    worst = std::max(worst, std::abs(double{expected.m[k][lane]} - double{got.m[k][lane]}));
  const double gap = double{d.s[D - 2][lane]} + double{d.s[D - 1][lane]};
  return worst * std::min(1.0, gap / double{d.s[0][lane]});
}

template <int D, class T>
void hard_rotations() {
  const double list[][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                            {0, -1, 0, 1, 0, 0, 0, 0, 1},
                            {1, 2, 0, 0, 0.5, 1, 0.3, 0, 2},
                            {0.01, 0, 0, 0, 1, 0, 0, 0, 1},
                            {-1, 0.2, 0, 0, 3, 0.4, 0, 0, 2},
                            {1, 0, 0, 0, 1e-6, 0, 0, 0, 1},
                            {50, 3, 1, 0, 40, 2, 0.5, 0, 60},
                            {-1, 0, 0, 0, -2, 0, 0, 0, 1},
                            {1e-3, 2e-4, 0, 0, 1e-3, 1e-4, 0, 0, 2e-3}};
  for (const auto& m : list) {
    EXPECT_LT((rotation_fault<D, T>(filled<D, T>(m), 0)), kTolerance<T>)
        << m[0] << ' ' << m[1] << ' ' << m[4];
  }
}
TEST(MpmMatrix, TheNearestRotationIsThatOfSingularVectors) {
  hard_rotations<2, float>(), hard_rotations<2, double>();
  hard_rotations<3, float>(), hard_rotations<3, double>();
}

// A matrix that needs singular values next to some that do not: no lane may change another.
TEST(MpmMatrix, LanesDoNotChangeEachOther) {
  const double plain[9] = {1, 0.1, 0, 0, 1.2, 0.3, 0, 0.1, 0.9}, mirror[9] = {-1, 0, 0, 0, 2, 0, 0, 0, 3};
  Square<3, double> mixed = filled<3, double>(plain);
  for (int k = 0; k < 9; ++k) mixed.m[k].set(2, mirror[k]);
  const auto alone = nearest_rotation(filled<3, double>(plain)),
             other = nearest_rotation(filled<3, double>(mirror)), both = nearest_rotation(mixed);
  for (int k = 0; k < 9; ++k) {
    EXPECT_EQ(both.m[k][0], alone.m[k][0]);
    EXPECT_EQ(both.m[k][2], other.m[k][0]);
  }
}

template <int D, class T>
double random_fault() {
  double worst = 0;
  uint64_t state = 12345;
  for (int k = 0; k < 20'000; ++k) {
    Square<D, T> a;
    for (int i = 0; i < D * D; ++i) {
      for (int lane = 0; lane < Wide<T>::kLanes; ++lane) {
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        a.m[i].set(lane, static_cast<T>(static_cast<double>(state >> 40) / (1 << 23) - 1));
      }
    }
    for (int lane = 0; lane < Wide<T>::kLanes; ++lane) worst = std::max(worst, fault<D, T>(a, lane));
  }
  return worst;
}

TEST(MpmMatrix, RandomMatricesComeApartAndTogether) {
  EXPECT_LT((random_fault<2, float>()), kTolerance<float>);
  EXPECT_LT((random_fault<2, double>()), kTolerance<double>);
  EXPECT_LT((random_fault<3, float>()), kTolerance<float>);
  EXPECT_LT((random_fault<3, double>()), kTolerance<double>);
}

}  // namespace
}  // namespace truestep::mpm
