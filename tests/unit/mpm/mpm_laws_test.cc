// Splines and laws of the material point method against their definitions.
#include <gtest/gtest.h>

#include "engine/kernels/mpm/laws.h"
#include "engine/kernels/mpm/spline.h"

namespace truestep::mpm {
namespace {

using W = Wide<double>;
template <int D>
using M = Square<D, double>;

template <int Nodes>
void moments() {
  using S = Spline<Nodes, double>;
  for (double f = S::kShift; f < S::kShift + 1; f += 0.07) {
    double w[4] = {}, sum = 0, first = 0, second = 0;
    S::weights(f, w);
    for (int k = 0; k < Nodes; ++k) {
      EXPECT_GE(w[k], 0);
      sum += w[k], first += w[k] * (k - f), second += w[k] * (k - f) * (k - f);
    }
    EXPECT_NEAR(sum, 1, 1e-15);
    EXPECT_NEAR(first, 0, 1e-15);
    EXPECT_NEAR(second, S::kSecond, 1e-15);
  }
}
TEST(MpmSpline, MomentsAreThoseOfBSplines) {
  moments<3>(), moments<4>();
}

Material material(Law law) {
  Material m;
  m.law = law, m.mu = 3e4, m.lambda = 5e4, m.cone = 0.3, m.yield = 500;
  return m;
}
template <int D>
M<D> deformation() {
  const double full[9] = {1.1, 0.2, -0.1, 0.05, 0.9, 0.15, 0.02, -0.12, 1.05};
  M<D> f;
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) f(r, c) = W(full[3 * r + c]);
  }
  return f;
}
template <int D>
Response<D, double> response(const Material& m, const M<D>& f) {
  return mpm::response<D, double>(m, f, determinant(f), W(0.95));
}

// tau = (d psi / dF) F^T by central differences: error h^2 of them and rounding over h, in all below 1e-6 of
// the moduli.
template <int D>
double stress_fault(Law law) {
  const Material m = material(law);
  const M<D> f = deformation<D>();
  const double h = 1e-5;
  M<D> p;
  for (int k = 0; k < D * D; ++k) {
    M<D> up = f, down = f;
    up.m[k] = f.m[k] + W(h), down.m[k] = f.m[k] - W(h);
    p.m[k] = (response<D>(m, up).energy - response<D>(m, down).energy) * W(0.5 / h);
  }
  const W one[3] = {W(1), W(1), W(1)};
  const M<D> expected = compose(p, one, f), got = response<D>(m, f).tau;
  double worst = 0;
  for (int k = 0; k < D * D; ++k) worst = std::max(worst, std::abs(expected.m[k][0] - got.m[k][0]));
  return worst / m.lambda;
}

TEST(MpmLaws, StressIsTheDerivativeOfTheEnergy) {
  for (const Law law : {Law::fluid, Law::corotated, Law::neo_hookean, Law::snow, Law::sand, Law::foam}) {
    EXPECT_LT((stress_fault<2>(law)), 1e-6) << static_cast<int>(law);
    EXPECT_LT((stress_fault<3>(law)), 1e-6) << static_cast<int>(law);
  }
}

TEST(MpmLaws, ATurnChangesNoEnergyAndTurnsTheStress) {
  const double c = 0.6, s = 0.8;
  const double turn[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  M<3> r;
  for (int k = 0; k < 9; ++k) r.m[k] = W(turn[k]);
  const W one[3] = {W(1), W(1), W(1)};
  for (const Law law : {Law::fluid, Law::corotated, Law::neo_hookean, Law::snow, Law::sand, Law::foam}) {
    const M<3> f = deformation<3>();
    const auto a = response<3>(material(law), f), b = response<3>(material(law), r * f);
    // Rounding of a few hundred operations.
    EXPECT_NEAR(a.energy[0] / b.energy[0], 1, 1e-12);
    const M<3> turned = compose(r * a.tau, one, r);
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(turned.m[k][0], b.tau.m[k][0], 1e-11 * 5e4);
  }
}

// Floats in lanes against doubles: two units in the last place, relative to 1 where ln is near 0.
TEST(MpmLaws, LogarithmsAndExponentialsOfFloatsAreThoseOfDoubles) {
  for (double x = 1e-6; x < 1e6; x *= 1.0007) {
    const auto a = static_cast<float>(x);
    const double exact = trig::log(double{a}), got = double{log(Wide<float>(a))[3]};
    EXPECT_LT(std::abs(got - exact),
              2.4e-7 * std::max(std::abs(exact), 1e-1 * std::abs(double{a} - 1)) + 1e-12)
        << x;
  }
  for (double x = -80; x < 80; x += 0.0173) {
    const auto a = static_cast<float>(x);
    const double exact = trig::exp(double{a});
    EXPECT_LT(std::abs(double{exp(Wide<float>(a))[5]} / exact - 1), 3.6e-7) << x;
  }
  EXPECT_EQ(log(Wide<float>(1))[0], 0);
  EXPECT_EQ(exp(Wide<float>(0))[0], 1);
}

// Reference case mpm.snow_unit: F = diag(0.9, 1.02) with Stomakhin's parameters; closed forms, so rounding.
TEST(MpmLaws, SnowFlowsAsPublished) {
  Material m;
  m.law = Law::snow, m.mu = 1.4e5 / 2.4;
  M<2> f = M<2>::identity();
  f(0, 0) = W(0.9), f(1, 1) = W(1.02);
  auto d = svd(f);
  W jp(1);
  return_map(m, d, jp);
  const M<2> fe = compose(d.u, d.s, d.v);
  EXPECT_NEAR(fe(0, 0)[0], 0.975, 1e-12);
  EXPECT_NEAR(fe(1, 1)[0], 1.0075, 1e-12);
  EXPECT_NEAR(jp[0], 0.934529490360755869, 1e-12);
  EXPECT_NEAR(hardening(m, jp)[0], 1.92457486960772505, 2e-12);
  EXPECT_NEAR(m.mu * hardening(m, jp)[0], 112266.867393784, 1e-7);
}

template <int D>
M<D> stretched(double a, double b, double c) {
  M<D> f = M<D>::identity();
  const double s[3] = {a, b, c};
  for (int k = 0; k < D; ++k) f(k, k) = W(s[k]);
  return f;
}

TEST(MpmLaws, SandComesBackToItsCone) {
  const Material m = material(Law::sand);
  auto d = svd(stretched<3>(1.1, 0.8, 1));
  W volume(0);
  return_map(m, d, volume);
  double e[3], trace = 0, norm2 = 0;
  for (int k = 0; k < 3; ++k) e[k] = std::log(d.s[k][0]), trace += e[k];
  for (const double x : e) norm2 += (x - trace / 3) * (x - trace / 3);
  // Klar et al. 2016, eq. 27: on the cone, with its previous trace.
  EXPECT_NEAR(std::sqrt(norm2) + (3 * m.lambda + 2 * m.mu) / (2 * m.mu) * m.cone * trace, 0, 1e-13);
  EXPECT_NEAR(trace, std::log(1.1 * 0.8), 1e-13);
  EXPECT_EQ(volume[0], 0);
  const double before = d.s[0][0];
  return_map(m, d, volume);
  EXPECT_NEAR(d.s[0][0], before, 1e-13) << "and stays there";
}

TEST(MpmLaws, SandThatIsPulledApartHasNoStressAndRemembersItsVolume) {
  const Material m = material(Law::sand);
  auto d = svd(stretched<3>(1.1, 1.05, 1));
  W volume(0);
  return_map(m, d, volume);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(d.s[k][0], 1, 1e-15);
  EXPECT_NEAR(volume[0], std::log(1.1 * 1.05), 1e-14);
  // Compressed by the same amount it is back where it was: without the correction it would have gained
  // volume.
  auto pressed = svd(stretched<3>(1 / 1.1, 1 / 1.05, 1));
  return_map(m, pressed, volume);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(pressed.s[k][0], 1, 0.03);
}

TEST(MpmLaws, FoamComesBackToItsCylinder) {
  const Material m = material(Law::foam);
  auto d = svd(stretched<3>(1.2, 0.9, 1));
  W strain(0);
  return_map(m, d, strain);
  double e[3], trace = 0, norm2 = 0;
  for (int k = 0; k < 3; ++k) e[k] = std::log(d.s[k][0]), trace += e[k];
  for (const double x : e) norm2 += 4 * m.mu * m.mu * (x - trace / 3) * (x - trace / 3);
  EXPECT_NEAR(std::sqrt(norm2), std::sqrt(2.0 / 3) * m.yield, 1e-8);
  EXPECT_GT(strain[0], 0.05);
  auto little = svd(stretched<3>(1.001, 1, 1));
  W none(0);
  return_map(m, little, none);
  EXPECT_EQ(none[0], 0) << "below the limit it is elastic";
}

// Where the bound of the largest stretch is not sharp, it costs a shorter substep, never a longer one.
TEST(MpmLaws, ModulusOfNeoHookeanSolidsIsNoSmallerThanTheFastestWaves) {
  const Material m = material(Law::neo_hookean);
  const M<3> f = deformation<3>();
  const double stretch = svd(f).s[0][0], j = determinant(f)[0], got = response<3>(m, f).modulus[0];
  const double exact = (2 * m.mu + m.lambda * (1 + std::abs(trig::log(j)))) * stretch * stretch;
  EXPECT_GE(got, exact);
  EXPECT_LT(got, 1.5 * exact);
  EXPECT_NEAR(response<3>(m, M<3>::identity()).modulus[0], 2 * m.mu + m.lambda, 1e-9) << "sharp at rest";
}

}  // namespace
}  // namespace truestep::mpm
