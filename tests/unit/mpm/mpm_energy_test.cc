// Elastic laws given as texts against the same laws built in, and invalid texts.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "tests/unit/mpm/mpm_rig.h"

namespace truestep::mpm {
namespace {

template <int D>
Square<D, double> bent() {
  const double full[9] = {1.1, 0.2, -0.1, 0.05, 0.9, 0.15, 0.02, -0.12, 1.05};
  Square<D, double> f;
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) f(r, c) = Wide<double>(full[3 * r + c]);
  }
  return f;
}

Material rubber() {
  Material m;
  m.law = Law::neo_hookean, m.mu = 3e4, m.lambda = 5e4;
  return m;
}

/// Largest difference of stresses and energies, over lambda.
template <int D>
double fault(const std::string& text, Law law) {
  Material m = rubber();
  m.law = law;
  const EnergyLaw own(text, D, m, "/energy");
  const auto f = bent<D>();
  const auto a = own.response(f), b = response<D, double>(m, f, determinant(f), Wide<double>(1));
  double worst = std::abs(a.energy[0] - b.energy[0]);
  for (int k = 0; k < D * D; ++k) worst = std::max(worst, std::abs(a.tau.m[k][0] - b.tau.m[k][0]));
  return worst / m.lambda;
}

// Rounding of a singular value decomposition and a few dozen operations: 1e-12 of the modulus.
TEST(MpmEnergy, TheBuiltInLawsComeOutWhenTheyAreWritten) {
  const std::string volume = "-mu*log(J)+lambda/2*log(J)^2";
  EXPECT_LT(fault<2>("mu/2*(I1-2)" + volume, Law::neo_hookean), 1e-12);
  EXPECT_LT(fault<3>("mu/2*(I1-3)" + volume, Law::neo_hookean), 1e-12);
  EXPECT_LT(fault<3>("mu*((s1-1)^2+(s2-1)^2+(s3-1)^2)+lambda/2*(J-1)^2", Law::corotated), 1e-12);
  EXPECT_LT(fault<3>("mu*(log(s1)^2+log(s2)^2+log(s3)^2)+lambda/2*log(s1*s2*s3)^2", Law::sand), 1e-12)
      << "Hencky";
  EXPECT_GT(fault<3>("mu/2*(I1-3)-mu*log(J)+lambda/2*(J-1)^2", Law::neo_hookean), 1e-3) << "control";
}

// The Mooney-Rivlin law has no built-in counterpart: its stress against central differences of its energy,
// whose error is the square of their width.
TEST(MpmEnergy, StressIsTheDerivativeOfTheEnergy) {
  const EnergyLaw law("mu/4*(I1-3)+mu/4*(I2-3)-1.5*mu*log(J)+lambda/2*log(J)^2", 3, rubber(), "/energy");
  const auto f = bent<3>();
  const double h = 1e-5;
  Square<3, double> p;
  for (int k = 0; k < 9; ++k) {
    auto up = f, down = f;
    up.m[k] = f.m[k] + Wide<double>(h), down.m[k] = f.m[k] - Wide<double>(h);
    p.m[k] = (law.response(up).energy - law.response(down).energy) * Wide<double>(0.5 / h);
  }
  const Wide<double> one[3] = {Wide<double>(1), Wide<double>(1), Wide<double>(1)};
  const auto expected = compose(p, one, f), got = law.response(f).tau;
  for (int k = 0; k < 9; ++k) EXPECT_NEAR(expected.m[k][0] / 5e4, got.m[k][0] / 5e4, 1e-6);
}

// The modulus that determines substeps is that of the built-in law at rest, and not below it elsewhere.
TEST(MpmEnergy, KnowsHowFastItsWavesAre) {
  const EnergyLaw law("mu/2*(I1-3)-mu*log(J)+lambda/2*log(J)^2", 3, rubber(), "/energy");
  const auto rest = law.response(Square<3, double>::identity());
  EXPECT_NEAR(rest.modulus[0], 2 * 3e4 + 5e4, 1e-6);
  for (const double s : {0.3, 0.7, 1.5, 3.0}) {
    auto f = Square<3, double>::identity();
    f(0, 0) = Wide<double>(s);
    // Along the stretched axis waves run at s^2 times the second derivative.
    const double l = std::log(s), exact = (3e4 + (3e4 + 5e4 * (1 - l)) / (s * s)) * s * s;
    EXPECT_GE(law.response(f).modulus[0], exact * (1 - 1e-9)) << s;
  }
}

TEST(MpmEnergy, SaysWhatIsNoElasticEnergy) {
  const auto refusal = [](const std::string& text) -> std::string {
    MpmDef d;
    BodyDef b;
    b.center = {0.5, 0.5, 0}, b.material = Law::elastic, b.energy = text;
    d.bodies = {b};
    try {
      const testing_rig::MpmRun run(d);
    } catch (const Error& e) {
      EXPECT_EQ(e.issues().at(0).pointer, "/bodies/0/energy");
      return e.what();
    }
    return "";
  };
  const auto says = [&](const std::string& text, const std::string& what) {
    EXPECT_NE(refusal(text).find(what), std::string::npos) << text << ": " << refusal(text);
  };
  const std::string rest = "mu/2*(I1-2)-mu*log(J)+lambda/2*log(J)^2";
  EXPECT_EQ(refusal(rest), "");
  says(rest + "+", "value is expected");
  says("nu*(I1-2)", "nu");
  says("mu*(s3-1)^2", "s3");
  says(rest + "+mu*abs(J-1)^3", "abs");
  says(rest + "+max(J-1,0)", "max");
  says(rest + "+(J>1?1:0)", "condition");
  says("mu*(2*(s1-1)^2+(s2-1)^2)", "isotropic");
  says("mu/2*(I1-2)", "stress");
  says("mu/2*(J-1)^2*0", "stiffness");
  says("mu*log(J-1)", "no number");
  MpmDef d;
  BodyDef b;
  b.center = {0.5, 0.5, 0}, b.energy = rest;
  d.bodies = {b};
  std::string where;
  mpm_table().check(&d, [&](const std::string& pointer, const std::string&) { where += pointer; });
  EXPECT_EQ(where, "/bodies/0/energy") << "of corotated";
}

// Two cubes that fall, one by its text, in steps of one substep: rounding of the stresses, which grows by
// some orders of magnitude at the impact.
TEST(MpmEnergy, MovesAsTheBuiltInLawDoes) {
  const auto fall = [](Law law) {
    MpmDef d;
    BodyDef b;
    b.center = {0.5, 0.25, 0}, b.half_extents = {0.1, 0.1, 1}, b.material = law;
    if (law == Law::elastic) b.energy = "mu/2*(I1-2)-mu*log(J)+lambda/2*log(J)^2";
    d.bodies = {b}, d.cell = 0.05, d.precision = Precision::f64;
    testing_rig::MpmRun run(d, 0.001, {0, -9.81, 0});
    run.step(330);
    EXPECT_LT(run.observe("jacobian.min"), 0.99) << "control: it is pressed";
    return run.observe("centre.y");
  };
  EXPECT_NEAR(fall(Law::elastic), fall(Law::neo_hookean), 1e-9);
}

}  // namespace
}  // namespace truestep::mpm
