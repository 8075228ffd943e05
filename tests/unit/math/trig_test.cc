// Errors in units in the last place against references of 64-bit mantissa, whose own error
// is 2^-11 of such a unit. They serve as reference only, never in the engine.
#include "engine/math/trig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "engine/base/random.h"

namespace truestep {
namespace {

double ulps(double got, long double want) {
  if (std::isnan(got) && std::isnan(want)) return 0;
  const double size = std::abs(static_cast<double>(want));
  return std::abs(static_cast<double>((got - want) / (std::nextafter(size, HUGE_VAL) - size)));
}

using Function = std::function<double(double)>;
using Reference = std::function<long double(long double)>;

double worst(const Function& f, const Reference& r, double from, double to, int n = 200000) {
  double w = 0;
  for (int i = 0; i < n; ++i) {
    const double x = from + (to - from) * uniform4(7, 1, static_cast<uint64_t>(i))[0];
    w = std::max(w, ulps(f(x), r(x)));
  }
  return w;
}

#define REF(f) [](long double x) { return std::f(x); }
#define OURS(f) [](double x) { return trig::f(x); }

TEST(Trig, StaysWithinItsPromisedErrors) {
  struct Case {
    const char* name;
    Function ours;
    Reference reference;
    double from, to, promised;
  };
  const Case cases[] = {
      {"sin small", OURS(sin), REF(sin), -0.8, 0.8, 0.8},
      {"sin", OURS(sin), REF(sin), -100, 100, 0.8},
      {"sin large", OURS(sin), REF(sin), -1e9, 1e9, 0.8},
      {"sin huge", OURS(sin), REF(sin), 1e12, 1e15, 0.8},
      {"cos small", OURS(cos), REF(cos), -0.8, 0.8, 0.8},
      {"cos", OURS(cos), REF(cos), -100, 100, 0.8},
      {"cos huge", OURS(cos), REF(cos), 1e12, 1e15, 0.8},
      {"tan", OURS(tan), REF(tan), -20, 20, 2.5},
      {"exp", OURS(exp), REF(exp), -700, 700, 0.8},
      {"exp small", OURS(exp), REF(exp), -0.5, 0.5, 0.8},
      {"log", OURS(log), REF(log), 1e-6, 1e6, 0.9},
      {"log near 1", OURS(log), REF(log), 0.6, 1.5, 0.9},
      {"atan", OURS(atan), REF(atan), -4, 4, 0.8},
      {"atan large", OURS(atan), REF(atan), -1e4, 1e4, 0.8},
      {"acos", OURS(acos), REF(acos), -1, 1, 1.5},
      {"acos near 1", OURS(acos), REF(acos), 0.999999, 1, 1.5},
      {"asin", OURS(asin), REF(asin), -1, 1, 1.5},
  };
  for (const Case& c : cases) {
    const double w = worst(c.ours, c.reference, c.from, c.to);
    EXPECT_LT(w, c.promised) << c.name;
    RecordProperty(c.name, std::to_string(w));
    std::printf("%-12s %.3f ulp\n", c.name, w);
  }
  // Control: a cosine polynomial one term short must be caught.
  const auto short_cos = [](double x) {
    const double u = x * x;
    return 1 - u / 2 + u * u / 24 - u * u * u / 720 + u * u * u * u / 40320 - u * u * u * u * u / 3628800;
  };
  EXPECT_GT(worst(short_cos, REF(cos), -0.8, 0.8), 100);
}

TEST(Trig, PowAndAtan2StayWithinTheirErrors) {
  double pow_error = 0, atan2_error = 0;
  for (uint64_t i = 0; i < 200000; ++i) {
    const auto r = uniform4(9, 1, i);
    const double x = std::exp(20 * (r[0] - 0.5)), y = 60 * (r[1] - 0.5);
    pow_error = std::max(
        pow_error, ulps(trig::pow(x, y), std::pow(static_cast<long double>(x), static_cast<long double>(y))));
    const double a = r[2] - 0.5, b = r[3] - 0.5;
    atan2_error = std::max(atan2_error, ulps(trig::atan2(a, b), std::atan2(static_cast<long double>(a),
                                                                           static_cast<long double>(b))));
  }
  std::printf("pow          %.3f ulp\natan2        %.3f ulp\n", pow_error, atan2_error);
  EXPECT_LT(pow_error, 1.5);
  EXPECT_LT(atan2_error, 1.5);
}

TEST(Trig, ReducesTheHardestArguments) {
  // The double nearest to a multiple of pi/2 (Muller 2016, table 11.1) and the largest doubles, with values
  // from a 200-digit computation.
  EXPECT_EQ(trig::cos(6381956970095103.0 * 0x1p797), -4.687165924254627611e-19);
  EXPECT_EQ(trig::sin(0x1p1023), 0x1.205248cbdb760p-1);
  for (int k = 1; k < 2000; ++k) {
    const double x = k * (std::numbers::pi / 2);
    EXPECT_LT(ulps(trig::sin(x), std::sin(static_cast<long double>(x))), 0.8) << k;
    EXPECT_LT(ulps(trig::cos(x), std::cos(static_cast<long double>(x))), 0.8) << k;
  }
}

TEST(Trig, HandlesTheEndsOfTheRange) {
  const double inf = HUGE_VAL;
  EXPECT_TRUE(std::isnan(trig::sin(inf)) && std::isnan(trig::cos(-inf)) && std::isnan(trig::sin(NAN)));
  EXPECT_EQ(trig::exp(-inf), 0);
  EXPECT_EQ(trig::exp(inf), inf);
  EXPECT_TRUE(std::isnan(trig::exp(NAN)));
  EXPECT_EQ(trig::exp(0), 1);
  EXPECT_EQ(trig::log(1), 0);
  EXPECT_EQ(trig::log(0), -inf);
  EXPECT_EQ(trig::log(inf), inf);
  EXPECT_TRUE(std::isnan(trig::log(-1)));
  EXPECT_EQ(trig::log(0x1p-1074), std::log(0x1p-1074));
  const double values[] = {0.0, -0.0, 1, -1, 2, -2, 3, -3, 0.5, -0.5, inf, -inf, 1e300, -1e300, 0x1p-1074};
  for (const double a : values) {
    for (const double b : values) {
      EXPECT_EQ(trig::atan2(a, b), std::atan2(a, b)) << a << ' ' << b;
      const double p = std::pow(a, b);
      if (std::isnan(p)) {
        EXPECT_TRUE(std::isnan(trig::pow(a, b))) << a << ' ' << b;
      } else {
        EXPECT_DOUBLE_EQ(trig::pow(a, b), p) << a << ' ' << b;
        EXPECT_EQ(std::signbit(trig::pow(a, b)), std::signbit(p)) << a << ' ' << b;
      }
    }
  }
  EXPECT_EQ(trig::acos(1), 0);
  EXPECT_EQ(trig::acos(-1), std::numbers::pi);
  EXPECT_TRUE(std::isnan(trig::acos(1.1)));
}

#undef REF
#undef OURS

}  // namespace
}  // namespace truestep
