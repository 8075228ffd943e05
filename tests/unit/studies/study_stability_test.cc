// Limits of stability are those of theory, and so are the frequencies and dampings behind them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "engine/base/errors.h"
#include "engine/core/equations/force_system.h"
#include "engine/integrators/control/spectrum.h"
#include "engine/studies/trajectory.h"
#include "tests/support/patience.h"
#include "tests/unit/studies/study_rig.h"

namespace truestep {
namespace {

using testing_rig::kCloth;
using testing_rig::Study;

TEST_F(Study, StabilityLimitsMatchTheory) {
  const std::string undamped = R"({"schema_version":"1.0","name":"undamped","time":{"dt":0.01,"duration":2},
    "systems":[{"type":"oscillator","id":"o","mass":1,"stiffness":100,"position":1,"velocity":0}]})";
  const auto r = run(with("stability", R"("integrators":["symplectic_euler","rk4"],"steps":4000)", undamped));
  EXPECT_NEAR(r.summary.at("omega_max").as_double(), 10, 1e-6);
  for (const auto& row : r.table.rows) {
    // A run counts as unstable once it is ten times farther than the motion: a fraction e beyond the limit,
    // 4,000 steps of symplectic Euler grow by exp(4000 * 2 sqrt(2 e)) and those of rk4 by about exp(4000 * 4
    // e). 2e-2 is enough for both.
    EXPECT_NEAR(std::get<double>(row[3]), 1, 0.02) << std::get<std::string>(row[0]);
  }
  // The plot identifies the methods by name, one line each.
  EXPECT_THAT(r.plot.y_names, ::testing::ElementsAre("symplectic_euler", "rk4"));
  EXPECT_THAT(result_svg(r.plot),
              ::testing::AllOf(::testing::HasSubstr(">symplectic_euler<"), ::testing::HasSubstr(">rk4<")));
}

TEST_F(Study, StabilityIsThatOfTheSystemItIsAbout) {
  // The second oscillator becomes unstable at 2 / 10 s whatever the limit of the first one's method: rk4 2.83
  // / 3 s.
  const std::string two = R"({"schema_version":"1.0","name":"two","time":{"dt":0.01,"duration":2},
    "systems":[{"type":"oscillator","id":"soft","mass":1,"stiffness":9,"position":1,"velocity":0},
               {"type":"oscillator","id":"stiff","mass":1,"stiffness":100,"position":1,"velocity":0,
                "integrator":"symplectic_euler"}]})";
  const auto r = run(with("stability", R"("integrators":["rk4"],"steps":4000)", two));
  EXPECT_NEAR(std::get<double>(r.table.rows[0][3]), 1, 0.02);
}

// Two masses on a spring, free to drift and to turn: implicit Euler only loses energy, whatever the step, and
// where the masses end up is no sign of instability.
constexpr const char* kTwoMasses = R"({"schema_version":"1.0","name":"two masses","gravity":[0,0,0],
  "time":{"dt":0.01,"duration":2},
  "systems":[{"type":"mass_spring","id":"m","stiffness":100,"integrator":"implicit_euler",
              "free":{"points":[[0,0,0],[1.2,0,0]],"masses":[1,1],
                      "springs":[{"a":0,"b":1,"rest_length":1}]}}]})";

TEST_F(Study, StabilityOfWhatOnlyLosesEnergyHasNoLimit) {
  const auto r =
      run(with("stability", R"("integrators":["implicit_euler","euler","symplectic_euler"])", kTwoMasses));
  const auto row = [&](const std::string& name) {
    return *std::ranges::find_if(r.table.rows,
                                 [&](const auto& x) { return std::get<std::string>(x[0]) == name; });
  };
  const auto implicit = row("implicit_euler"), euler = row("euler"), symplectic = row("symplectic_euler");
  EXPECT_TRUE(std::holds_alternative<std::monostate>(implicit[1]));
  EXPECT_THAT(std::get<std::string>(implicit[4]), ::testing::HasSubstr("no limit found up to"));
  // Theory: every step adds energy. A run that has not grown tenfold yet is no stable step.
  EXPECT_TRUE(std::holds_alternative<std::monostate>(euler[1]));
  EXPECT_EQ(std::get<double>(euler[2]), 0);
  EXPECT_THAT(std::get<std::string>(euler[4]), ::testing::HasSubstr("unstable at every step by theory"));
  // Control: a method with a limit still has it, 2 / sqrt(2 k / m).
  EXPECT_NEAR(std::get<double>(symplectic[3]), 1, 0.03);
  EXPECT_THAT(r.plot.y_names, ::testing::ElementsAre("symplectic_euler"));
}

TEST_F(Study, StabilityBeyondTheBudgetIsNoMeasuredLimit) {
  const auto r = run(with("stability", R"("integrators":["rk4","velocity_verlet"],"budget":0.1)", kCloth));
  for (const auto& row : r.table.rows) {
    const auto& status = std::get<std::string>(row[4]);
    if (status == "ok") continue;
    EXPECT_TRUE(std::holds_alternative<std::monostate>(row[1])) << status;
    EXPECT_THAT(r.plot.y_names, ::testing::Not(::testing::Contains(std::get<std::string>(row[0]))));
  }
}

TEST_F(Study, StabilityOfFreeFlightIsRefusedWithTheReason) {
  const std::string ball = R"({"schema_version":"1.0","name":"ball","time":{"dt":0.01,"duration":1},
    "systems":[{"type":"particles","id":"b","positions":[[0,1,0]],"mass":1}]})";
  try {
    run(with("stability", "", ball));
    ADD_FAILURE() << "nothing can be unstable here";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "study_failed");
    EXPECT_THAT(e.what(), ::testing::HasSubstr("neither oscillate nor decay"));
  }
}

TEST_F(Study, StabilityOfALargeSceneEndsWithinItsBudget) {
  const double begin = thread_cpu_seconds();
  const auto r = run(with("stability", R"("integrators":["rk4","velocity_verlet"],"budget":0.4)", kCloth));
  // 1,000 steps per run would be some 2 s of this cloth; the spectrum and building the worlds are extra.
  EXPECT_LT(thread_cpu_seconds() - begin, std::chrono::duration<double>(patience(1.5)).count());
  EXPECT_THAT(std::string(r.summary.at("note").as_string()), ::testing::HasSubstr("of the 1000 steps"));
  // Control: a light scene runs all of them.
  EXPECT_FALSE(run(with("stability", R"("integrators":["rk4"])")).summary.contains("note"));
}

Spectrum spectrum_of(const char* scene) {
  const World world(parse_scene(scene));
  const auto& forces = dynamic_cast<const ForceSystem&>(world.system(0));
  return estimate_spectrum(forces.force_field(), world.initial_state().systems[0], 0);
}

TEST(Spectrum, FindsFrequencyAndDampingOfAnOscillator) {
  const auto s = spectrum_of(R"({"schema_version":"1.0","name":"one","gravity":[0,0,0],
    "systems":[{"type":"oscillator","id":"o","mass":2,"stiffness":50,"damping":3}]})");
  // sqrt(k / m) and c / m; central differences of linear forces are exact to rounding.
  EXPECT_NEAR(s.omega, 5, 1e-6);
  EXPECT_NEAR(s.damping, 1.5, 1e-6);
}

TEST(Spectrum, FindsTheHighestFrequencyOfAChain) {
  const auto s = spectrum_of(R"({"schema_version":"1.0","name":"chain","gravity":[0,0,0],
    "systems":[{"type":"mass_spring","id":"c","rope":{"from":[0,0,0],"to":[11,0,0],"links":11},"pinned":["ends"],
                "mass":1,"stiffness":1}]})");
  // Reference case ms.chain10: omega_10 = 2 sin(10 pi / 22). The iteration stops when the eigenvalue changes
  // by 1e-7; the next one is 0.94 of it, which leaves some 1e-6. The next lower mode, 1.919, would be far
  // off.
  EXPECT_NEAR(s.omega, 2 * std::sin(10 * 3.14159265358979 / 22), 1e-5);
}

}  // namespace
}  // namespace truestep
