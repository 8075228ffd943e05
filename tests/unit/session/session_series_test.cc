// The observables that a session retains: from the start, within a bound, and at a small fraction of the
// time.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/session/session.h"

namespace truestep {
namespace {

Session oscillator_session(const std::string& more) {
  return Session(
      std::make_shared<const World>(parse_scene(
          R"({"time": {"dt": 0.01}, "systems": [{"type": "oscillator", "id": "a"}])" + more + "}")),
      std::make_shared<const ThreadArena>(1));
}

Observables energy(double v) {
  Observables o;
  o.add("energy.total", v, "J");
  return o;
}

TEST(SessionSeries, EnergyIsKeptFromTheStart) {
  Session s = oscillator_session("");
  s.step(10);
  ASSERT_FALSE(s.series().steps().empty());
  EXPECT_EQ(s.series().steps().front(), 0u);
  for (const std::string& name : s.series().names()) EXPECT_EQ(name.rfind("energy.", 0), 0u) << name;
}

// Plots compare them; without their past a plot began where its page was opened.
TEST(SessionSeries, OfSeveralSystemsTheEnergyOfEachIsKept) {
  const auto kept = [](const std::string& more) {
    Session s(std::make_shared<const World>(parse_scene(
                  R"({"time": {"dt": 0.01}, "systems": [{"type": "oscillator", "id": "a"},
                    {"type": "oscillator", "id": "b"}])" +
                  more + "}")),
              std::make_shared<const ThreadArena>(1));
    s.step(3);
    return s.series().names();
  };
  const auto has = [](const std::vector<std::string>& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const std::vector<std::string> unasked = kept(""),
                                 asked = kept(R"(, "observables": ["a.energy.potential"])");
  for (const char* name : {"a.energy.total", "b.energy.kinetic", "b.energy.total", "energy.total"})
    EXPECT_TRUE(has(unasked, name)) << name;
  EXPECT_FALSE(has(unasked, "a.energy.potential"));
  // Controls: a scene that says what is to be kept; a single system (above).
  EXPECT_FALSE(has(asked, "b.energy.total"));
  EXPECT_TRUE(has(asked, "energy.total"));
}

TEST(SessionSeries, AScenesListIsWorthEveryStep) {
  Session s = oscillator_session(R"(, "observables": ["a"])");
  s.step(100);
  EXPECT_EQ(s.series().steps().size(), 101u);
}

TEST(SessionSeries, CostlyPointsLieFurtherApart) {
  Series sparing({"energy"}, Series::Rate::sparing, 64), strict({"energy"}, Series::Rate::every_step, 64);
  for (Series* series : {&sparing, &strict}) {
    for (uint64_t step = 0; step < 20; ++step) {
      if (!series->due(step)) continue;
      series->add(step, energy(1));
      series->spent(1, 2);  // half of the time
    }
  }
  EXPECT_EQ(sparing.steps(), (std::vector<uint64_t>{0, 2, 4, 8, 16}));
  EXPECT_EQ(strict.steps().size(), 20u);
  // Cheap again: every step, as long as there is room.
  for (uint64_t step = 20; step < 100; ++step) {
    if (!sparing.due(step)) continue;
    sparing.add(step, energy(1));
    sparing.spent(0.001, 2);
  }
  EXPECT_EQ(sparing.steps().back(), 99u);
  EXPECT_EQ(*(sparing.steps().end() - 2), 98u);
}

TEST(SessionSeries, TheBoundHoldsInPointsAndBytes) {
  Series series({"energy"}, Series::Rate::sparing, 64);
  for (uint64_t step = 0; step < 5000; ++step) {
    if (series.due(step)) series.add(step, energy(1));
  }
  EXPECT_LE(series.steps().size(), 64u);
  EXPECT_EQ(series.steps().front(), 0u);
  EXPECT_LE(series.memory_bytes(), series.most_bytes(energy(1).rows()));
  EXPECT_EQ(series.most_bytes(energy(1).rows()), 64u * 8 * 2);
}

TEST(SessionPace, SpeedIsWhatIsLeftAfterSkipping) {
  Session s = oscillator_session("");
  s.play(1);
  EXPECT_FALSE(s.achieved_speed());
  for (int k = 0; k < 100; ++k) s.advance(0.01);
  EXPECT_NEAR(s.achieved_speed().value(), 1, 1e-9);
  // 8 steps (0.08 s) of every 0.4 s: the bound on catching up, plus or minus a pending step.
  for (int k = 0; k < 10; ++k) s.advance(0.4);
  EXPECT_NEAR(s.achieved_speed().value(), 0.2, 0.02);
  s.pause();
  EXPECT_FALSE(s.achieved_speed());
}

TEST(SessionPace, StepsThatWereDueAndAreNotDoneAreSkipped) {
  Session s = oscillator_session("");
  s.play(1);
  const uint64_t before = s.skipped_steps();
  for (int k = 0; k < 100; ++k) {
    const uint64_t due = s.accrue(0.02);  // two steps, of which one is done
    s.step(due / 2);
    s.skip(due - due / 2);
    if (s.achieved_speed()) {
      EXPECT_NEAR(*s.achieved_speed(), 0.5, 0.03) << k;  // a step or two of the 50 of a look are pending
    }
  }
  ASSERT_TRUE(s.achieved_speed());
  EXPECT_NEAR(static_cast<double>(s.skipped_steps() - before), 100, 1);
}

// 17 of the 500 steps of each look are due and none is done, which the first reading knows as well.
TEST(SessionPace, StepsThatAreDueAreNotDone) {
  Session s = oscillator_session("");
  s.play(10);
  for (int k = 0; k < 10; ++k) {
    s.skip(s.accrue(0.5));
    EXPECT_NEAR(s.achieved_speed().value(), 0, 0.03) << k;  // a pending step of 0.01 s in a look of 0.5 s
  }
}

/// Takes every frame.
struct Watching : Sink {
  FrameRequest wanted;
  std::vector<FramePtr> frames;
  std::string said;
  bool due(uint64_t) override { return true; }
  const FrameRequest& request() const override { return wanted; }
  void accept(const FramePtr& frame) override { frames.push_back(frame); }
  void bye(std::string_view code, const std::string&) override { said = code; }
};

// A stream's client holds its session: a session that still held a removed client would keep both for ever.
TEST(SessionFrames, ARemovedSinkIsLetGoBeforeTheNextStep) {
  Session s(std::make_shared<const World>(parse_scene(
                R"({"time": {"dt": 0.01}, "systems": [{"type": "oscillator", "id": "a", "position": 1}]})")),
            std::make_shared<const ThreadArena>(1));
  auto sink = std::make_shared<Watching>();
  const std::weak_ptr<Watching> left = sink;
  s.add_sink(sink);
  s.step(1);
  ASSERT_EQ(sink->frames.size(), 1u);
  s.remove_sink(sink.get());
  sink.reset();
  EXPECT_TRUE(left.expired());
}

TEST(SessionFrames, HoldTheShapesOfTheirStep) {
  Session s(
      std::make_shared<const World>(parse_scene(
          R"({"time": {"dt": 0.01}, "systems": [{"type": "particles", "id": "p", "positions": [[0, 1, 0]],
                    "colliders": [{"type": "sphere", "id": "ball", "radius": 0.1, "center": [2, 0, 0],
                                   "motion": {"velocity": [1, 0, 0]}}]}]})")),
      std::make_shared<const ThreadArena>(1));
  const auto sink = std::make_shared<Watching>();
  sink->wanted.wishes = Wish::constant | Wish::obstacles;
  s.add_sink(sink);
  s.step(5);
  ASSERT_EQ(sink->frames.size(), 5u);
  for (const FramePtr& frame : sink->frames) {
    ASSERT_TRUE(frame->constant);
    ASSERT_EQ(frame->moving.obstacles.size(), 1u);
    EXPECT_NEAR(frame->moving.obstacles[0].position.x, 2 + frame->time, 1e-12);  // rounding
  }
  s.say_bye("draining", "");
  EXPECT_EQ(sink->said, "draining");
}

}  // namespace
}  // namespace truestep
