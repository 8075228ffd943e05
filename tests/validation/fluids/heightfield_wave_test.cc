// Shallow water against closed forms: standing waves, Stoker's and Ritter's dam breaks, Thacker's bowl, a
// lake at rest.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "tests/support/fluids/shallow_run.h"

namespace truestep::test {
namespace {

using namespace heightfield_wave;
constexpr double kG = 9.81;

// Linear theory: surface a cos(k x) cos(w t) over depth H between walls, w = k sqrt(g H), k = pi / L.
TEST(HeightfieldWave, StandingWavesSwingAtTheLinearPeriodWithSecondOrder) {
  const double period = 2 / std::sqrt(kG * 0.1);
  const auto run_of = [&](int64_t cells, const char* depth) {
    HeightfieldWaveDef d;
    d.cells = {cells};
    d.bed = std::string("-") + depth;
    // The square of 1e-6 / 0.1 is what linear theory leaves out.
    d.surface = "1e-6*cos(pi*x)";
    d.exact = "1e-6*cos(pi*x)*cos(pi*sqrt(9.81*0.1)*t)";
    auto run = std::make_unique<ShallowRun>(d, period / 100);
    run->steps(225);  // two periods and a quarter: the surface passes through 0
    return run->observed("error.exact") / 1e-6;
  };
  const double a = run_of(25, "0.1"), b = run_of(50, "0.1"), c = run_of(100, "0.1");
  std::printf("  error / amplitude %.2e %.2e %.2e, order %.2f %.2f\n", a, b, c, std::log2(a / b),
              std::log2(b / c));
  // The phase is off by error / (2 pi 2.25) of a period: here under a thousandth of one.
  EXPECT_LT(c, 0.002);
  EXPECT_NEAR(std::log2(b / c), 2, 0.4);  // limiters flatten crests, which passes slowly
  // Control: two hundredths more depth shift the phase by a hundredth of 2 pi 2.25.
  EXPECT_GT(run_of(100, "0.102"), 0.05);
}

// Stoker 1957, "Water Waves", section 10.8: water of depth 1 m runs into water of 0.1 m.
struct Stoker {
  double left = 1, right = 0.1, middle = 0, speed = 0, bore = 0;
  Stoker() {
    // The bore's jump condition gives the speed behind it, the fan the depth for that speed.
    const auto behind = [&](double h) {
      return (h - right) * std::sqrt(0.5 * kG * (h + right) / (h * right));
    };
    double low = right, high = left;
    for (int i = 0; i < 200; ++i) {
      middle = 0.5 * (low + high);
      const double fan = 2 * (std::sqrt(kG * left) - std::sqrt(kG * middle));
      (behind(middle) < fan ? low : high) = middle;
    }
    speed = behind(middle);
    bore = middle * speed / (middle - right);
  }
  double depth(double x, double t) const {
    const double c = std::sqrt(kG * left), s = x / t;
    if (s <= -c) return left;
    if (s <= speed - std::sqrt(kG * middle)) return (2 * c - s) * (2 * c - s) / (9 * kG);
    return s <= bore ? middle : right;
  }
};

double dam_error(int64_t cells, double right, const std::function<double(double, double)>& exact,
                 int* fronts) {
  HeightfieldWaveDef d;
  d.cells = {cells};
  d.size = {10};
  d.origin = Vec3{-5, 0, 0};
  d.surface = "x < 0 ? 1 : " + std::to_string(right);
  ShallowRun run(d, 0.01);
  run.steps(100);
  double sum = 0;
  for (size_t i = 0; i < size_t(cells); ++i) {
    const double x = -5 + 10 * (double(i) + 0.5) / double(cells);
    sum += std::abs(run.depth(i) - exact(x, 1)) / double(cells);
  }
  // Mass is kept to rounding.
  EXPECT_NEAR(run.observed("mass"), 1000 * 5 * (1 + right), 1e-9);
  if (fronts) {
    for (*fronts = int(cells); *fronts > 0 && run.depth(size_t(*fronts - 1)) < 1e-3 + right;) --*fronts;
  }
  return sum;
}

TEST(HeightfieldWave, ADamBreaksAsStokerAndRitterSay) {
  const Stoker stoker;
  const auto wet = [&](double x, double t) { return stoker.depth(x, t); };
  const double a = dam_error(100, 0.1, wet, nullptr), b = dam_error(400, 0.1, wet, nullptr);
  std::printf("  Stoker: middle %.4f m, bore %.4f m/s, mean error %.2e %.2e, order %.2f\n", stoker.middle,
              stoker.bore, a, b, 0.5 * std::log2(a / b));
  // A bore is one or two cells wide: 0.3 m high, 25 mm per cell in 10 m, plus the fan's corners.
  EXPECT_LT(b, 2e-3);
  EXPECT_NEAR(0.5 * std::log2(a / b), 1, 0.25);
  // Control: the same water with a bore that is 2 % too slow.
  Stoker slow = stoker;
  slow.bore *= 0.98;
  EXPECT_GT(dam_error(
                400, 0.1, [&](double x, double t) { return slow.depth(x, t); }, nullptr),
            2e-3);

  // Ritter 1892: onto dry ground.
  const auto dry = [](double x, double t) {
    const double c = std::sqrt(kG), s = x / t;
    return s <= -c ? 1 : s >= 2 * c ? 0 : (2 * c - s) * (2 * c - s) / (9 * kG);
  };
  const double ritter = dam_error(400, 0, dry, nullptr);
  std::printf("  Ritter: mean error %.2e\n", ritter);
  EXPECT_LT(ritter, 2e-3);
  // Control: the wet one is not the dry one.
  EXPECT_GT(dam_error(400, 0, wet, nullptr), 0.01);
}

// Thacker 1981, "Some exact solutions to the nonlinear shallow-water wave equations", section 4: a plane
// surface rotates in the bowl z = 0.1 (r^2 - 1) with w^2 = 2 g 0.1; the shoreline runs over dry ground.
TEST(HeightfieldWave, APlaneSurfaceTurnsRoundInThackersBowl) {
  const double w = std::sqrt(2 * kG * 0.1), period = 2 * std::numbers::pi / w;
  const auto run_of = [&](int64_t cells, const char* swing) {
    HeightfieldWaveDef d;
    d.cells = {cells, cells};
    d.size = {3, 3};
    d.origin = Vec3{-1.5, -1.5, 0};
    d.bed = "0.1*(x^2 + y^2 - 1)";
    d.surface = "0.03*(2*x - 0.3)";
    d.velocity = {"0", "0.3*sqrt(2*9.81*0.1)"};
    d.exact = std::string("0.03*(2*x*cos(w*t) + 2*y*sin(w*t) - 0.3)");
    for (size_t at; (at = d.exact.find("w*t")) != std::string::npos;)
      d.exact.replace(at, 3, std::string("sqrt(2*9.81*0.1)*") + swing + "*t");
    ShallowRun run(d, period / 100);
    run.steps(100);
    EXPECT_NEAR(
        run.observed("mass"),
        [&] {
          Observables o;
          run.system->observe(run.system->initial_state(), 0, o);
          return *o.find("mass");
        }(),
        1e-9);
    return run.observed("error.exact");
  };
  const double a = run_of(50, "1"), b = run_of(100, "1");
  std::printf("  mean error %.2e %.2e m, order %.2f\n", a, b, std::log2(a / b));
  EXPECT_LT(b, 2e-4);  // of a depth of 0.1 m; the shore's cells are of first order
  EXPECT_GT(std::log2(a / b), 1);
  // Control: rotated by two hundredths more.
  EXPECT_GT(run_of(100, "1.02"), 2e-4);
}

TEST(HeightfieldWave, ALakeStaysAtRestAroundIslands) {
  for (const char* bed : {"0.2*sin(7*x)*cos(5*y)", "0.8*exp(-20*(x-0.4)^2-20*(y-0.5)^2)", "floor(3*x)*0.1"}) {
    HeightfieldWaveDef d;
    d.cells = {20, 15};
    d.bed = bed;
    d.surface = "0.13";
    ShallowRun run(d, 0.05);
    run.steps(1200);  // 60 s
    // Rounding of heights of 0.1 m drives at most g 1e-16 / dx per stage.
    EXPECT_LT(run.observed("speed.max"), 1e-11) << bed;
  }
  // Control: a millimetre of slope does move.
  HeightfieldWaveDef d;
  d.cells = {40, 30};
  d.surface = "0.13 + 0.001*x";
  ShallowRun run(d, 0.05);
  run.steps(4);
  EXPECT_GT(run.observed("speed.max"), 1e-4);
}

}  // namespace
}  // namespace truestep::test
