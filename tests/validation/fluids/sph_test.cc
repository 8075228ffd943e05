// Liquids of particles against closed forms and published runs.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::channel;
using testing_rig::middle_speed;
using testing_rig::SphRun;
constexpr Method kEvery[] = {Method::dfsph, Method::wcsph, Method::pbf};

double square_sum(const SphRun& run, int axis) {
  double sum = 0;
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    const Vec3 x = run.position(i);
    sum += (axis == 0 ? x.x : x.y) * (axis == 0 ? x.x : x.y);
  }
  return sum;
}

// Monaghan 1994 (case sph.elliptical_drop): a disk that is stretched stays an ellipse; at 7.6 ms its
// semi-axis is 1.94452. Taken from the particles' second moment, which an affine flow scales by its square.
TEST(SphValidation, ADiskIsPulledToAnEllipse) {
  for (const Method solver : kEvery) {
    SphDef d;
    d.dimension = 2, d.low = {-3, -3, 0}, d.high = {3, 3, 1}, d.spacing = 0.02, d.precision = Precision::f64;
    // In substeps of 50 us a compression of 1e-4 is a rate of 2/s, of 100/s that act.
    d.solver = solver, d.xsph = 0, d.viscosity = 0, d.density_error = 1e-6;
    // Particles under the cubic spline of two spacings come to lie such that the density of wcsph is no
    // longer their own: its diffusion then drives them apart, and the disk is 1.5 % too long.
    if (solver == Method::wcsph) d.kernel = Smoothing::wendland_c2, d.support = 3;
    d.bodies = {{.shape = Shape::ball, .center = {}, .strain = {-100, 100, 0}, .radius = 1}};
    SphRun run(d, 1e-4);
    const double before = square_sum(run, 1);
    run.seconds(0.0076);
    const double b = std::sqrt(square_sum(run, 1) / before);
    EXPECT_NEAR(b, 1.94451719071562, 0.01 * 1.9445) << static_cast<int>(solver);  // the case's tolerance
    EXPECT_GT(std::abs(b - 1 - 100 * 0.0076), 0.1) << "control: without pressure";
  }
}

// Cases sph.couette and sph.poiseuille, as published. Corrections of single positions (pbf) cannot be
// separated from a motion as slow as this.
TEST(SphValidation, ALidDragsAChannelAlong) {
  constexpr double kTimes[] = {0.0225, 0.045, 0.1125, 0.225};
  constexpr double kSpeeds[] = {2.30276568155e-7, 1.19475164053e-6, 3.62844098707e-6, 5.38628727324e-6};
  for (const Method solver : {Method::dfsph, Method::wcsph}) {
    SphDef d = channel(solver);
    d.lid_velocity = {1.25e-5, 0, 0};
    SphRun run(d, 5e-4);
    double t = 0;
    for (int k = 0; k < 4; ++k) {
      run.seconds(kTimes[k] - t), t = kTimes[k];
      EXPECT_NEAR(middle_speed(run), kSpeeds[k], 0.02 * 1.25e-5) << t;  // the case's tolerance
    }
  }
  SphDef thick = channel(Method::dfsph);
  thick.lid_velocity = {1.25e-5, 0, 0}, thick.viscosity = 2e-6;
  SphRun run(thick, 5e-4);
  run.seconds(0.045);
  EXPECT_GT(std::abs(middle_speed(run) - kSpeeds[1]), 0.04 * 1.25e-5) << "control: twice the viscosity";
}

TEST(SphValidation, AForceDrivesAChannel) {
  for (const Method solver : {Method::dfsph, Method::wcsph}) {
    SphRun run(channel(solver), 5e-4, {1e-4, 0, 0});
    double t = 0;
    constexpr double kTimes[] = {0.0225, 0.045, 0.1125, 0.225};
    constexpr double kSpeeds[] = {2.23273750702e-6, 4.23457055741e-6, 8.24991384479e-6, 1.10998016592e-5};
    for (int k = 0; k < 4; ++k) {
      run.seconds(kTimes[k] - t), t = kTimes[k];
      EXPECT_NEAR(middle_speed(run), kSpeeds[k], 0.02 * 1.25e-5) << t;
    }
  }
  SphRun slip(
      [] {
        SphDef d = channel(Method::dfsph);
        d.walls = Walls::slip;
        return d;
      }(),
      5e-4, {1e-4, 0, 0});
  slip.seconds(0.225);
  EXPECT_GT(middle_speed(slip), 2e-5) << "control: walls that do not hold it";
}

// Viscosity makes substeps short in which the flow hardly moves. Corrected at once, compressions of a
// millionth in such a substep took pressures that made the rows buckle: particles at 3 mm/s in a channel of
// 12 um/s.
TEST(SphValidation, AFineChannelKeepsItsRows) {
  SphDef d = channel(Method::dfsph);
  d.spacing = 1.25e-5;
  SphRun run(d, 1.25e-4, {1e-4, 0, 0});
  run.seconds(0.0225);
  EXPECT_NEAR(middle_speed(run), 2.23273750702e-6, 0.02 * 1.25e-5);
  EXPECT_LT(run.observe("speed.max"), 1.25e-5);
  EXPECT_GT(run.observe("substeps"), 1) << "control: viscosity divides its steps";
}

// Case fluid.standing_wave: the first mode of a tank half a wavelength long. It starts with the velocities of
// the linear theory, and crosses the middle after half a period.
constexpr double kOmega = 5.541131018081737392457494;
/// Half a period over that of waves of infinitesimal height.
double half_period(Method solver, double artificial = 0) {
  SphDef d;
  d.dimension = 2, d.high = {1, 1.5, 1}, d.spacing = 0.025, d.precision = Precision::f64, d.solver = solver;
  d.xsph = 0, d.viscosity = 0;
  // The rows of a lattice under the cubic spline of two spacings buckle, which costs or gives 1 to 3 %.
  d.kernel = Smoothing::wendland_c2, d.support = 3;
  d.artificial_pressure = artificial;
  if (solver == Method::dfsph) d.spacing = 0.02, d.density_error = 1e-5;
  d.bodies = {{.center = {0.5, 0.5, 0}, .half_extents = {0.5, 0.5, 1}}};
  SphRun run(d, 0.002, {0, -9.81, 0});
  RealColumn<double> v(run.state, columns::velocity);
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    const Vec3 x = run.position(i);
    v.set_vector(i, Vec3{std::sin(std::numbers::pi * x.x) * std::cosh(std::numbers::pi * x.y),
                         -std::cos(std::numbers::pi * x.x) * std::sinh(std::numbers::pi * x.y), 0} *
                        (0.15 / std::cosh(std::numbers::pi)));
  }
  double before = run.observe("centre.x"), middle = before, crossed = 0;
  for (int k = 1; k < 500 && crossed == 0; ++k) {
    run.step();
    const double now = run.observe("centre.x");
    if (k > 100 && (now - middle) * (before - middle) <= 0) {
      crossed = 0.002 * (k - 1 + (before - middle) / (before - now));
    }
    before = now;
  }
  return crossed * kOmega / std::numbers::pi;
}

// The case's 1 %.
TEST(SphValidation, AStandingWaveKeepsItsPeriod) {
  for (const Method solver : kEvery) EXPECT_NEAR(half_period(solver), 1, 0.01) << static_cast<int>(solver);
  EXPECT_GT(std::abs(half_period(Method::pbf, 0.05) - 1), 0.03)
      << "control: pushes apart that nothing balances";
}

/// Straight line through values over height, by least squares.
class Line {
 public:
  void add(double y, double value) { n_ += 1, y_ += y, yy_ += y * y, q_ += value, yq_ += y * value; }
  double at_zero() const { return (q_ * yy_ - y_ * yq_) / (n_ * yy_ - y_ * y_); }

 private:
  double n_ = 0, y_ = 0, yy_ = 0, q_ = 0, yq_ = 0;
};

/// Pa, on the floor under a metre of water after a second, mean over starts a millionth of a metre apart.
double floor_pressure(Method solver, double gravity, int starts) {
  constexpr int kSamples = 5;
  double floor = 0;
  for (int start = 0; start < starts; ++start) {
    SphDef d;
    d.dimension = 2, d.high = {1, 1.5, 1}, d.spacing = 0.025, d.solver = solver;
    d.bodies = {{.center = {0.5, 0.5, 0}, .half_extents = {0.5, 0.5, 1}}};
    SphRun run(d, 1.0 / 120, {0, -gravity, 0});
    run.shake(1e-6, static_cast<uint64_t>(start));
    run.seconds(1);
    // Pressure falls linearly with height: its value on the floor, over a quarter of a second.
    for (int k = 0; k < kSamples; ++k) {
      run.step(6);
      Line line;
      const std::vector<double> p = run.pressures();
      for (size_t i = 0; i < p.size(); ++i) {
        const double y = run.position(i).y;
        if (y < 0.8 && y > 0.15) line.add(y, p[i]);
      }
      floor += line.at_zero() / (kSamples * starts);
    }
    // pbf of four iterations is compressed by 2 %.
    const double sunk = solver == Method::pbf ? 0.02 : 0.01;
    EXPECT_NEAR(run.observe("centre.y"), 0.5, sunk) << static_cast<int>(solver);
  }
  return floor;
}

// Case fluid.hydrostatic: a metre of water presses on the floor with 9,810 Pa, to the case's 2 %. How it
// settles hangs on the last bit: of twelve starts the standard deviation is 0.7 % (dfsph), 0.3 % (wcsph) and
// 0.02 % (pbf) around means that are 0.4 % too small, right, and 1 % too large. The bound is at least five
// standard errors away from means of so many: 5.6, 9 and 50. The own pressures of wcsph would be 2.1 % too
// large.
TEST(SphValidation, StillWaterPressesByItsWeight) {
  constexpr std::pair<Method, int> kStarts[] = {{Method::dfsph, 6}, {Method::wcsph, 2}, {Method::pbf, 1}};
  for (const auto& [solver, starts] : kStarts) {
    EXPECT_NEAR(floor_pressure(solver, 9.81, starts), 9810, 0.02 * 9810) << static_cast<int>(solver);
  }
  EXPECT_LT(floor_pressure(Method::pbf, 0.96 * 9.81, 1), 0.98 * 9810) << "control: 4 % less weight";
}

// Martin & Moyce 1952 (case fluid.dam_break): the front of a column twice as high as wide. What is released
// at once leads water behind a membrane that has to give way first, in every method alike and at every
// resolution: a lag of the experiment's clock, 0.2 to 0.3 of its unit of 54 ms, accounts for it.
TEST(SphValidation, ADamBreakRunsAsMeasured) {
  constexpr double kFront[][2] = {{0.832, 1.217}, {1.219, 1.474}, {1.997, 2.292}, {2.547, 2.995},
                                  {3.345, 4.134}, {4.034, 4.944}, {4.418, 5.881}, {5.091, 6.98}};
  constexpr double kA = 0.05715;
  for (const Method solver : kEvery) {
    SphDef d;
    d.dimension = 2, d.high = {9 * kA, 3 * kA, 1}, d.spacing = kA / 25, d.solver = solver;
    d.bodies = {{.center = {kA / 2, kA, 0}, .half_extents = {kA / 2, kA, 1}}};
    SphRun run(d, 0.002, {0, -9.81, 0});
    const double unit = 1 / std::sqrt(2 * 9.81 / kA);
    std::vector<double> fronts = {1};
    while (static_cast<double>(fronts.size()) * run.h < 5.2 * unit) {
      run.step();
      fronts.push_back((run.observe("high.x") + 0.5 * d.spacing) / kA);
    }
    const auto rms = [&](double lag) {
      double squares = 0;
      for (const auto& [when, where] : kFront) {
        const double at = std::max(when - lag, 0.0) * unit / run.h;
        const auto k = static_cast<size_t>(at);
        const double z = fronts[k] + (at - static_cast<double>(k)) * (fronts[k + 1] - fronts[k]);
        squares += (z - where) * (z - where);
      }
      return std::sqrt(squares / 8);
    };
    double still = 0, lag = 0;
    for (const auto& [when, where] : kFront) still += (1 - where) * (1 - where);
    for (double other = 0; other < 1; other += 0.01) lag = rms(other) < rms(lag) ? other : lag;
    // The case's tolerance, once the clocks agree; 22 ms are allowed for that, more than any run wanted.
    EXPECT_LT(rms(lag), 0.25) << static_cast<int>(solver);
    EXPECT_LT(lag, 0.4) << static_cast<int>(solver);
    EXPECT_GT(rms(lag + 0.4), 0.25) << "control: a front that is as far behind";
    // Simulations lead the experiment, whose gate takes its time and whose floor holds water back, by 5 to
    // 10 %: 0.2 to 0.4 of 4, and here the foremost of all particles counts.
    EXPECT_LT(rms(0), 0.6) << static_cast<int>(solver);
    EXPECT_GT(std::sqrt(still / 8), 2) << "control: water that stays";
  }
}

}  // namespace
}  // namespace truestep::sph
