// The largest stable step depends on Newmark's beta and gamma: without damping, for gamma >= 1/2,
//   omega h <= 1 / sqrt(gamma/2 - beta)  where 2 beta < gamma, no limit elsewhere
// (Hughes 1987, "The Finite Element Method", section 9.1). Every part of the product that states a limit must
// state this one. (Remedies, and that generalized alpha has no limit, are in tests/scenes/chains.)
#include <gtest/gtest.h>

#include <cmath>

#include "engine/integrators/table/integrators.h"
#include "engine/scene/json/json.h"
#include "engine/session/session.h"
#include "engine/studies/study.h"
#include "tests/validation/equations/stepping.h"

namespace truestep::test {
namespace {

constexpr double kOmega = 10;  // rad/s, of the scenes below

std::string scene(const std::string& method, const std::string& settings, double dt = 0.01) {
  return R"({"schema_version":"1.0","name":"one","time":{"dt":)" + std::to_string(dt) +
         R"(,"duration":2},"systems":[{"type":"oscillator","id":"o","mass":1,"stiffness":100,"position":1,
         "velocity":0,"integrator":")" +
         method + "\"" + settings + "}]}";
}
std::string settings(double beta, double gamma) {
  return ",\"newmark_beta\":" + std::to_string(beta) + ",\"newmark_gamma\":" + std::to_string(gamma);
}

// omega h at which an eigenvalue of one step's map leaves the unit circle; infinity: not below 1e4.
double border(double beta, double gamma) {
  IntegratorOptions options = kOneInternalStep;
  options.damping.newmark_beta = beta, options.damping.newmark_gamma = gamma;
  const auto holds = [&](double h) {
    const auto map = step_map(*find_integrator("newmark"), 1, 0, h, options);
    return std::abs(dominant_eigenvalue(map)) <= 1 + 1e-11;
  };
  double low = 0.3, high = low;
  while (holds(high)) {
    low = high, high *= 1.01;
    if (high > 1e4) return HUGE_VAL;
  }
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

std::optional<double> quoted(const std::string& text) {
  const World world(parse_scene(text));
  return world.stable_dt(world.initial_state());
}

struct Case {
  double beta, gamma, limit;  // limit 0: none
};
// Central differences, linear acceleration, average acceleration, two with damping.
const Case kCases[] = {{0, 0.5, 2},
                       {1.0 / 6, 0.5, 2 * std::sqrt(3.0)},
                       {0.25, 0.5, 0},
                       {0.2, 0.7, 1 / std::sqrt(0.15)},
                       {0.35, 0.7, 0}};

TEST(NewmarkLimit, TheQuotedStepIsTheOneThatBisectionFinds) {
  for (const Case& c : kCases) {
    const double found = border(c.beta, c.gamma);
    const auto dt = quoted(scene("newmark", settings(c.beta, c.gamma)));
    if (c.limit == 0) {
      EXPECT_TRUE(std::isinf(found)) << c.beta;
      EXPECT_FALSE(dt) << c.beta;
      continue;
    }
    // Bisection ends at 1e-6; std::to_string gives beta to 5e-7, which moves the limit by as much.
    EXPECT_NEAR(found, c.limit, 1e-5) << c.beta;
    ASSERT_TRUE(dt) << c.beta;
    EXPECT_NEAR(*dt * kOmega, found, 1e-4) << c.beta;
    // Control: the limit without beta, that of central differences, does not apply to the others.
    if (c.beta > 0) {
      EXPECT_GT(std::abs(found - 2), 0.1) << c.beta;
    }
  }
  for (const char* radius : {"0", "0.5", "1"})
    EXPECT_FALSE(quoted(scene("generalized_alpha", std::string(",\"spectral_radius\":") + radius, 5)))
        << radius;
}

TEST(NewmarkLimit, TheStudyComparesWithTheScenesOwnTheory) {
  const ThreadArena arena{1};
  std::atomic<bool> cancelled{false};
  StudyContext context{.arena = arena, .cancelled = cancelled, .progress = [](double, const std::string&) {}};
  const auto run = [&](const std::string& text) {
    return run_study(
        read_study_request(parse_json(
            R"({"kind":"stability","integrators":["newmark"],"steps":4000,"scene":)" + text + "}")),
        context);
  };
  const auto conditional = run(scene("newmark", settings(0, 0.5)));
  ASSERT_TRUE(std::holds_alternative<double>(conditional.table.rows[0][2]));
  EXPECT_NEAR(std::get<double>(conditional.table.rows[0][2]), 2 / kOmega, 1e-6);
  // The limit found by bisection over runs is accurate to what 4,000 steps can resolve.
  EXPECT_NEAR(std::get<double>(conditional.table.rows[0][3]), 1, 0.02);
  EXPECT_NEAR(conditional.summary.at("suggested_dt").as_double(), 0.9 * 2 / kOmega, 1e-6);
  // Control: for average acceleration there is no limit to report.
  const auto unlimited = run(scene("newmark", ""));
  EXPECT_FALSE(std::holds_alternative<double>(unlimited.table.rows[0][2]));
  EXPECT_TRUE(unlimited.summary.at("suggested_dt").is_null());
}

}  // namespace
}  // namespace truestep::test
