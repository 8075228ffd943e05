// The same scene, seed and commands give the same bits: through snapshots, seeks, journals, sinks and dropped
// scratch memory.
#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/session/session.h"

namespace truestep {
namespace {

std::shared_ptr<const World> rope_world() {
  return std::make_shared<const World>(parse_scene(R"({
    "schema_version": "1.0", "time": {"dt": 0.004, "substeps": 2},
    "systems": [{"type": "oscillator", "id": "a", "stiffness": 40, "damping": 0.1, "position": 1},
                {"type": "pendulum", "id": "p"}]})"));
}

std::shared_ptr<const ThreadArena> serial() {
  static const auto kArena = std::make_shared<const ThreadArena>(1);
  return kArena;
}

Command impulse(double x) {
  Command c;
  c.kind = CommandKind::impulse;
  c.system = "a";
  c.index = 0;
  c.vector = {x, 0, 0};
  return c;
}

// Accepts every frame and ignores it.
class CountingSink : public Sink {
 public:
  CountingSink() { request_ = {{{0, 0, Scalar::f64}}, FrameRequest::Extras::state_hash}; }
  bool due(uint64_t step) override { return step % 3 == 0; }
  const FrameRequest& request() const override { return request_; }
  void accept(const FramePtr& frame) override { hashes.push_back(frame->state_hash.value()); }
  std::vector<uint64_t> hashes;

 private:
  FrameRequest request_;
};

// 200 steps with an impulse at steps 20 and 90, the per-step hashes.
std::vector<uint64_t> reference_run(const std::shared_ptr<const World>& world) {
  Session s(world, serial());
  std::vector<uint64_t> hashes{s.hash()};
  for (int n = 0; n < 200; ++n) {
    if (n == 20 || n == 90) s.command(impulse(n * 0.1));
    s.step(1);
    hashes.push_back(s.hash());
  }
  return hashes;
}

TEST(SessionReplay, SeekingRepeatsTheRunWithItsCommands) {
  const auto world = rope_world();
  const auto hashes = reference_run(world);
  Session s(world, serial());
  for (int n = 0; n < 200; ++n) {
    if (n == 20 || n == 90) s.command(impulse(n * 0.1));
    s.step(1);
  }
  // 20 steps drawn from the counter-based generator, forwards and backwards over both commands.
  for (uint64_t k = 0; k < 20; ++k) {
    const auto target = static_cast<uint64_t>(uniform4(1, 2, k)[0] * 200);
    EXPECT_EQ(s.frame_at(target > s.step_index() ? s.step_index() : target, {})->step,
              std::min(target, s.step_index()));
    s.seek(target);
    EXPECT_EQ(s.step_index(), target);
    // At the steps of the commands, a seek has already executed them.
    if (target != 20 && target != 90) {
      EXPECT_EQ(s.hash(), hashes[target]) << "step " << target;
    }
  }
  // The control: without the commands the run is different.
  Session plain(world, serial());
  plain.step(200);
  EXPECT_NE(plain.hash(), hashes[200]);
}

TEST(SessionReplay, EarlierStatesAreComputedWithoutMovingTheSession) {
  const auto world = rope_world();
  const auto hashes = reference_run(world);
  Session s(world, serial());
  for (int n = 0; n < 200; ++n) {
    if (n == 20 || n == 90) s.command(impulse(n * 0.1));
    s.step(1);
  }
  for (const uint64_t step : {0, 1, 64, 65, 100, 199}) {
    EXPECT_EQ(s.state_at(step).hash(), hashes[step]);
    EXPECT_EQ(s.hash(), hashes[200]);
  }
}

TEST(SessionReplay, SnapshotRestoredElsewhereContinuesTheTrajectory) {
  const auto world = rope_world();
  Session a(world, serial());
  a.step(57);
  const auto bytes = a.state().serialize();
  // Another world from the same scene, another number of threads.
  Session b(rope_world(), std::make_shared<const ThreadArena>(4));
  b.restore(WorldState::deserialize(bytes));
  for (int n = 0; n < 100; ++n) {
    a.step(1);
    b.step(1);
    ASSERT_EQ(a.hash(), b.hash()) << "step " << n;
  }
}

TEST(SessionReplay, SinksAndDroppedScratchChangeNothing) {
  const auto world = rope_world();
  Session a(world, serial()), b(world, serial());
  const auto sink = std::make_shared<CountingSink>();
  b.add_sink(sink);
  for (int n = 0; n < 60; ++n) {
    a.step(1);
    b.step(1);
    b.drop_workspace();
    ASSERT_EQ(a.hash(), b.hash());
  }
  EXPECT_EQ(sink->hashes.size(), 20u);
}

TEST(SessionReplay, FramesNobodyAsksForAreNotBuilt) {
  const auto world = rope_world();
  Session s(world, serial());
  s.step(100);
  EXPECT_EQ(s.frames_built(), 0u);
  const auto sink = std::make_shared<CountingSink>();
  s.add_sink(sink);
  s.step(99);
  EXPECT_EQ(s.frames_built(), 33u);  // steps 102, 105 ... 198
  s.remove_sink(sink.get());
  s.step(100);
  EXPECT_EQ(s.frames_built(), 33u);
}

TEST(SessionReplay, ACommandAfterASeekMakesANewFuture) {
  const auto world = rope_world();
  Session s(world, serial());
  s.step(50);
  s.command(impulse(3));
  s.step(50);
  s.seek(30);
  s.command(impulse(-1));
  s.step(70);
  ASSERT_EQ(s.journal().size(), 1u);
  Session fresh(world, serial());
  fresh.step(30);
  fresh.command(impulse(-1));
  fresh.step(70);
  EXPECT_EQ(s.hash(), fresh.hash());
}

}  // namespace
}  // namespace truestep
