// What a state holds matters: restores that lack a part of it take another course or are refused, and what
// does not belong to it changes nothing. (That runs of the same scenes have the same bits on any number of
// threads, without scratch memory and from snapshots is in tests/scenes/determinism.)
#include "tests/support/coupled.h"
#include "tests/support/scene_file.h"

namespace truestep {
namespace {

using testing_coupled::SceneRun;

boost::json::object file(const char* name) {
  return testing::scene_file(std::string("determinism/") + name);
}
struct Stepped : SceneRun {
  Stepped(const boost::json::object& scene, uint64_t steps) : SceneRun(write_json(scene)) {
    session.step(steps);
  }
};
boost::json::object& first_system(boost::json::object& scene) {
  return scene["systems"].as_array()[0].as_object();
}
/// The state after one more step from a state.
uint64_t next_of(const boost::json::object& scene, const WorldState& state) {
  SceneRun run(write_json(scene));
  run.session.restore(state);
  run.session.step(1);
  return run.session.hash();
}

TEST(AlteredStates, BodiesNeedTheImpulsesOfTheirContacts) {
  for (const char* precision : {"f32", "f64"}) {
    boost::json::object scene = file("collapse_2d");
    first_system(scene)["precision"] = precision;
    const Stepped run(scene, 150);
    WorldState forgetful = run.session.state();
    EXPECT_EQ(next_of(scene, forgetful), next_of(scene, run.session.state())) << "control";
    State& s = forgetful.systems[0];
    for (float& p : s.span<float>(s.at("contact.impulse"))) p = 0;
    EXPECT_NE(next_of(scene, forgetful), next_of(scene, run.session.state())) << precision;
  }
}

TEST(AlteredStates, ASleepingBodyElsewhereChangesNothing) {
  boost::json::object scene = file("collapse_2d");
  const Stepped alone(scene, 150);
  boost::json::array& bodies = first_system(scene)["bodies"].as_array();
  boost::json::object sleeper = bodies.back().as_object();
  sleeper.erase("velocity"), sleeper["position"] = {500, 5, 0}, sleeper["asleep"] = true;
  sleeper.erase("bullet");
  bodies.push_back(sleeper);
  const Stepped beside(scene, 150);
  const auto places = [](const SceneRun& run) {
    const State& s = run.session.state().systems[0];
    return s.f64(s.at("position"));
  };
  const auto x = places(alone), y = places(beside);
  ASSERT_EQ(y.size(), x.size() + 3);
  for (size_t i = 0; i < 9; ++i) EXPECT_EQ(x[i], y[i]);
  for (size_t i = 9; i < x.size(); ++i) EXPECT_EQ(x[i], y[i + 3]);
}

TEST(AlteredStates, ABodyInWaterNeedsTheImpulsesOnIt) {
  for (const char* solver : {"dfsph", "wcsph", "pbf"}) {
    boost::json::object scene = file("afloat");
    scene["systems"].as_array()[1].as_object()["solver"] = solver;
    const Stepped run(scene, 15);
    WorldState forgetful = run.session.state();
    forgetful.couplings[0] = run.world->initial_state().couplings[0];
    EXPECT_NE(next_of(scene, forgetful), next_of(scene, run.session.state())) << solver;
  }
}

TEST(AlteredStates, OfCouplingsAreSeenAndRefused) {
  for (const char* name : {"joined_points", "rain_on_a_cloth"}) {
    Stepped run(file(name), 60);
    const uint64_t hash = run.session.hash();
    WorldState altered = run.session.state();
    ASSERT_FALSE(altered.couplings.empty());
    altered.couplings[0].f64(0)[0] += 1;
    EXPECT_NE(altered.hash(), hash) << name;
    // A state without them belongs to another scene.
    altered.couplings.clear();
    EXPECT_THROW(run.session.restore(altered), Error) << name;
    // Seeking back repeats the run.
    run.session.step(20);
    run.session.seek(60);
    EXPECT_EQ(run.session.hash(), hash) << name;
  }
}

TEST(AlteredStates, ControlsThatAreSetAreOfTheState) {
  const auto scene = file("rain_on_keyframes");
  Stepped a(scene, 10), b(scene, 10), other(scene, 10);
  for (SceneRun* run : {&a, &b}) {
    WorldState s = run->session.state();
    run->world->apply(s, {.kind = CommandKind::set_parameter, .system = "k", .value = 0.5, .name = "a"});
    run->session.restore(s);
  }
  for (SceneRun* run : {&a, &b, &other}) run->session.step(10);
  EXPECT_EQ(a.session.hash(), b.session.hash());
  EXPECT_NE(a.session.hash(), other.session.hash());
}

TEST(AlteredStates, OfALiquidWithARowTooFewAreRefused) {
  Stepped run(file("liquid_that_comes_and_goes"), 20);
  WorldState bad = run.session.state();
  bad.systems[0].resize(1, bad.systems[0].rows(1) - 1);
  EXPECT_THROW(run.session.restore(bad), Error);
}

}  // namespace
}  // namespace truestep
