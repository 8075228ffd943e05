// A scene that blows up is caught while its numbers are still meaningful, keeps the last good state and
// suggests remedies. (That they work is in tests/scenes/chains/remedies_*.json.)
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/session/session.h"

namespace truestep {
namespace {

// omega = 100 rad/s: symplectic Euler holds up to dt = 0.02 s.
std::string scene(double dt, const std::string& integrator) {
  return R"({"schema_version":"1.0","name":"stiff","time":{"dt":)" + std::to_string(dt) +
         R"(,"duration":1},"systems":[{"type":"oscillator","id":"o","mass":1,"stiffness":10000,"position":1,
         "velocity":0,"integrator":")" +
         integrator + "\"}]}";
}

Session session(double dt, const std::string& integrator) {
  return Session(std::make_shared<const World>(parse_scene(scene(dt, integrator))),
                 std::make_shared<const ThreadArena>(1));
}

TEST(Instability, ExplosionIsCaughtBeforeTheNumbersOverflow) {
  Session s = session(0.03, "symplectic_euler");
  const uint64_t done = s.step(2000);
  ASSERT_TRUE(s.failure());
  const Failure& f = *s.failure();
  EXPECT_EQ(f.system, "o");
  EXPECT_EQ(f.quantity, "energy");
  EXPECT_EQ(f.last_good_step, done);
  EXPECT_THAT(f.detail,
              ::testing::AllOf(::testing::HasSubstr("system \"o\": energy rose from 5"),
                               ::testing::HasSubstr("in step " + std::to_string(done + 1) + " (t = ")));
  // The last good state is kept, and it can be plotted.
  const double v = s.state().systems[0].f64(s.state().systems[0].at("velocity"))[0];
  EXPECT_LT(std::abs(v), 1e8);
  EXPECT_EQ(s.step_index(), done);
}

TEST(Instability, BadValuesAreFoundByColumnAndRow) {
  const World world(parse_scene(scene(0.001, "rk4")));
  State s = world.initial_state().systems[0];
  EXPECT_FALSE(s.first_bad(1e3));
  const auto v = s.at("velocity");
  s.f64(v)[0] = 2e3;
  EXPECT_FALSE(s.first_bad());
  ASSERT_TRUE(s.first_bad(1e3));
  EXPECT_EQ(s.first_bad(1e3)->column, v);
  s.f64(v)[0] = NAN;
  EXPECT_TRUE(s.first_bad());
  EXPECT_TRUE(s.first_bad(1e3));
  s.f64(v)[0] = 1e200;  // its square overflows, it does not
  EXPECT_FALSE(s.first_bad());
  EXPECT_FALSE(s.first_bad(1e300));
}

TEST(Instability, RemediesWereTriedOnTheStateThatFailed) {
  Session s = session(0.03, "symplectic_euler");
  s.step(2000);
  ASSERT_TRUE(s.failure());
  for (const std::string& remedy : s.failure()->remedies)
    EXPECT_THAT(remedy, ::testing::HasSubstr("held when tried for ")) << remedy;
}

// Loops whose bars all come into one line, in steps in which they turn by a radian: Newton's method diverges
// although these methods have no limit in theory.
struct Linkage {
  const char* method;
  double dt;
};
class InstabilityOfALinkage : public ::testing::TestWithParam<Linkage> {
 protected:
  static Session linkage(const std::string& method, double dt) {
    boost::json::value d = parse_json(std::string(find_gallery_scene("four_bars")->text));
    d.as_object()["time"].as_object()["dt"] = dt;
    d.as_object()["systems"].as_array()[0].as_object()["integrator"] = method;
    return Session(std::make_shared<const World>(require_scene(read_scene(d))),
                   std::make_shared<const ThreadArena>(1));
  }
};

TEST_P(InstabilityOfALinkage, RemediesHold) {
  const auto [method, dt] = GetParam();
  Session s = linkage(method, dt);
  s.step(200);
  ASSERT_TRUE(s.failure());
  size_t methods = 0;
  for (const std::string& remedy : s.failure()->remedies) {
    const std::string prefix = "the integrator ";
    if (!remedy.starts_with(prefix)) continue;
    const std::string name = remedy.substr(prefix.size(), remedy.find(' ', prefix.size()) - prefix.size());
    Session other = linkage(name, dt);
    other.step(s.failure()->step + 50);
    EXPECT_FALSE(other.failure()) << name << ": " << other.failure()->detail;
    ++methods;
  }
  EXPECT_GT(methods, 0u);
}
INSTANTIATE_TEST_SUITE_P(Methods, InstabilityOfALinkage,
                         ::testing::Values(Linkage{"newmark", 0.05}, Linkage{"implicit_midpoint", 0.1}),
                         [](const auto& info) { return std::string(info.param.method); });

TEST(Instability, EveryFloatingColumnIsLookedAt) {
  State s;
  const auto x = s.add({"position", "m", Scalar::f32, 3, Role::position}, 40);
  const auto hidden = s.add({"memory", "1", Scalar::f64, 2, Role::internal}, 40);
  const auto never = s.add({"death", "s", Scalar::f64, 1, Role::sentinel}, 1);
  s.f64(never)[0] = HUGE_VAL;
  EXPECT_FALSE(s.first_bad(1e3, State::Look::everything));
  s.f64(hidden)[7] = NAN;
  EXPECT_FALSE(s.first_bad());  // not at every step
  ASSERT_TRUE(s.first_bad(1e3, State::Look::everything));
  EXPECT_EQ(s.first_bad(1e3, State::Look::everything)->row, 3u);
  s.f64(hidden)[7] = 0;
  s.span<float>(x)[100] = INFINITY;
  ASSERT_TRUE(s.first_bad());
  EXPECT_EQ(s.first_bad()->column, x);
  EXPECT_EQ(s.first_bad()->row, 33u);
}

TEST(EnergyWatch, KnowsWhatWasThereAndWhatCommandsBrought) {
  using Exchange = Energy::Exchange;
  const auto energy = [](double kinetic, double potential, Exchange exchange = Exchange::closed) {
    return Energy{.kinetic = kinetic, .potential = potential, .exchange = exchange, .swing = 2};
  };
  EnergyWatch w;
  EXPECT_TRUE(w.holds(energy(0, 0)));  // the first look
  // A fall from a potential of 0: 20 J are converted, so that an excess of 17 J is still within twice that
  // ...
  EXPECT_TRUE(w.holds(energy(20, -20)));
  EXPECT_TRUE(w.holds(energy(37, -20)));
  EXPECT_FALSE(w.holds(energy(61, -20)));  // ... and 41 J are.
  // A command may supply any energy.
  w.command(energy(20, -20), energy(1020, -20));
  EXPECT_TRUE(w.holds(energy(1000, 0)));
  EXPECT_FALSE(w.holds(energy(5000, 0)));
  // A system driven from outside starts afresh when the drive ends.
  EXPECT_TRUE(w.holds(energy(1e9, 0, Exchange::open)));
  EXPECT_TRUE(w.holds(energy(1e9, 0)));
  EXPECT_FALSE(w.holds(energy(4e9, 0)));
  EXPECT_FALSE(w.holds(energy(0, NAN)));
}

TEST(Instability, AResetBeforeTheDiagnosisLeavesNoFailureBehind) {
  Session s = session(0.03, "symplectic_euler");
  const auto explode = [&s] {
    StepOutcome outcome = StepOutcome::done;
    while (outcome == StepOutcome::done) outcome = s.step_in_place(Session::Output::aloud);
    return outcome;
  };
  ASSERT_EQ(explode(), StepOutcome::unstable);
  ASSERT_TRUE(s.computing_aside());
  s.reset();
  EXPECT_FALSE(s.computing_aside());
  EXPECT_EQ(s.step(1), 1u);
  // The control: with nothing in between, the failure is detected.
  ASSERT_EQ(explode(), StepOutcome::unstable);
  s.compute_aside();
  EXPECT_EQ(s.commit_aside(Session::Output::aloud), StepOutcome::failed);
  EXPECT_TRUE(s.failure());
}

TEST(Instability, AWatchThatIsRestoredJudgesAlike) {
  Session s = session(0.001, "rk4");
  s.step(40);
  const WorldState copy = WorldState::deserialize(s.state().serialize());
  EXPECT_EQ(copy, s.state());
  ASSERT_EQ(copy.watch.size(), 1u);
  EXPECT_DOUBLE_EQ(copy.watch[0].reference, 5000);  // 1/2 k x^2
}

}  // namespace
}  // namespace truestep
