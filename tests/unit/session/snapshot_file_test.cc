// Files read by other processes: a state that is damaged, or that no run reaches, is refused or can be
// stepped; a bundle tells from where hashes differ; a journal beyond its bound shortens the past and nothing
// else.
#include "engine/session/snapshot/snapshot.h"

#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/session/snapshot/bundle.h"

namespace truestep {
namespace {

const auto kArena = std::make_shared<const ThreadArena>(1);

std::shared_ptr<const World> world_of(const char* gallery_scene) {
  return std::make_shared<const World>(parse_scene(find_gallery_scene(gallery_scene)->text));
}

std::shared_ptr<const World> rope() {
  return std::make_shared<const World>(parse_scene(R"({"time": {"dt": 0.01}, "systems": [
    {"type": "mass_spring", "id": "r", "pinned": ["first"], "rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 8}}]})"));
}

Command impulse(int64_t index, double y) {
  Command c;
  c.kind = CommandKind::impulse, c.system = "r", c.index = index, c.vector = {0, y, 0};
  return c;
}

// "" when the state can be stepped and observed, or the code of the refusal.
std::string fate(const std::shared_ptr<const World>& world, std::span<const std::byte> bytes) {
  Session session(world, kArena, {.history_bytes = 0});
  try {
    session.restore(WorldState::deserialize(bytes));
  } catch (const Error& e) {
    return e.code();
  }
  session.step(2);
  session.observe();
  return "";
}

TEST(SnapshotFile, HostileStatesAreRefusedOrCanBeStepped) {
  for (const char* name : {"newtons_cradle_2d", "ragdoll_stairs", "rope_catenary", "bouncing_ball_events"}) {
    const auto world = world_of(name);
    Session session(world, kArena);
    session.step(30);
    const auto bytes = session.state().serialize();
    EXPECT_EQ(fate(world, bytes), "") << name << ", the control";
    size_t refused = 0, stepped = 0;
    for (uint64_t k = 0; k < 60; ++k) {
      auto edited = bytes;
      const auto u = uniform4(k, 1, 2);
      // A number in the middle, a byte near the front (names, counts), or rows taken away.
      if (k % 3 == 0) {
        const size_t at = static_cast<size_t>(u[0] * static_cast<double>(bytes.size() - 4));
        std::fill_n(edited.begin() + static_cast<std::ptrdiff_t>(at), 4, std::byte{0xff});
      } else {
        const size_t within = k % 3 == 1 ? std::min<size_t>(bytes.size(), 600) : bytes.size();
        edited[static_cast<size_t>(u[0] * static_cast<double>(within))] ^= std::byte(1 << int(8 * u[1]));
      }
      const std::string code = fate(world, edited);
      EXPECT_TRUE(code.empty() || code == "bad_snapshot" || code == "instability")
          << name << " " << k << " " << code;
      ++(code.empty() ? stepped : refused);
    }
    // A quarter of the edits near the front change a name, a type or a count.
    EXPECT_GE(refused, 5u) << name;
    EXPECT_GT(stepped, 0u) << name;
  }
}

// Both solvers keep in the state the number of substeps into which they divided the last step.
// Its watch over energies too, without which a restored session would believe whatever comes next.
TEST(SnapshotFile, AStateReadsBackAsItWas) {
  Session session(rope(), kArena);
  session.step(3);
  const WorldState& state = session.state();
  ASSERT_FALSE(state.watch.empty());
  ASSERT_NE(state.watch[0].phase, EnergyWatch::Phase::fresh) << "control: it is being watched";
  EXPECT_EQ(WorldState::deserialize(state.serialize()), state);
}

TEST(SnapshotFile, NoStateAsksForMoreSubstepsThanTheSolverWouldTake) {
  const auto plane = std::make_shared<const World>(parse_scene(R"({"systems": [{"type": "rigid2d", "bodies": [
    {"motion": "fixed", "shapes": [{"type": "box", "half_extents": [5, 0.1, 0]}]}, {"position": [0, 0.5, 0], "shapes": [{"type": "box"}]}]}]})"));
  WorldState state = plane->initial_state();
  uint32_t& steps = state.systems[0].span<uint32_t>(state.systems[0].at("small_steps"))[0];
  steps = 24;
  EXPECT_NO_THROW(plane->require_state(state)) << "the control: six times the four that a step has";
  steps = 100'000'000;
  EXPECT_THROW(plane->require_state(state), Error);

  const auto space = std::make_shared<const World>(parse_scene(R"({"systems": [{"type": "rigid3d", "bodies": [
    {"type": "plane", "motion": "fixed"}, {"type": "box", "position": [0, 0.5, 0]}]}]})"));
  state = space->initial_state();
  state.systems[0].f64(state.systems[0].at("substep"))[0] = 1e-11;
  Session session(space, kArena, {});
  session.restore(state);
  session.step(2);  // would last for hours
  EXPECT_EQ(session.state().step, 2u);
}

TEST(SnapshotFile, RowsThatDoNotBelongTogetherAreRefused) {
  const auto world = rope();
  WorldState state = world->initial_state();
  EXPECT_NO_THROW(world->require_state(state));
  const auto with = [&](const char* column, size_t rows, uint32_t value = 0) {
    WorldState s = world->initial_state();
    const auto c = s.systems[0].at(column);
    s.systems[0].resize(c, rows);
    for (const char* other : {"drag.target", "drag.stiffness"}) {
      if (std::string_view(column) == "drag.row") s.systems[0].resize(s.systems[0].at(other), rows);
    }
    if (value) s.systems[0].span<uint32_t>(c)[0] = value;
    try {
      world->require_state(s);
    } catch (const Error& e) {
      return e.code();
    }
    return std::string();
  };
  EXPECT_EQ(with("position", 8), "bad_snapshot");
  EXPECT_EQ(with("drag.target", 1), "bad_snapshot");
  EXPECT_EQ(with("drag.row", 1, 9), "bad_snapshot");
  EXPECT_EQ(with("drag.row", 1, 8), "") << "the control: the last of nine points";
  state.systems[0].f64(0)[4] = NAN;
  EXPECT_THROW(world->require_state(state), Error);
}

// The number of snapshots that a session keeps, and of a bundle's checkpoints, depends on the speed of the
// machine.
Bundle bundle_with_two_checkpoints(Session& session) {
  session.step(32);
  const Checkpoint before{32, session.hash()};
  session.step(8);
  session.command(impulse(8, 0.1));
  session.step(56);
  const Checkpoint after{96, session.hash()};
  session.step(44);
  Bundle bundle = bundle_of(session);
  bundle.checkpoints = {before, after};
  return bundle;
}

TEST(Bundle, SaysFromWhereHashesDiffer) {
  Session session(rope(), kArena);
  Bundle bundle = read_bundle(write_bundle(bundle_with_two_checkpoints(session)));
  const ReplayResult same = replay(bundle, kArena);
  EXPECT_FALSE(same.difference);
  EXPECT_EQ(same.hash, session.hash());
  bundle.journal[0].command.vector.y = 0.2;
  const ReplayResult other = replay(bundle, kArena);
  ASSERT_TRUE(other.difference);
  EXPECT_GT(other.difference->step, 40u);
  EXPECT_LE(other.difference->after, 40u);
}

TEST(Bundle, CommandsAndCheckpointsOutOfOrderAreRefused) {
  Session session(rope(), kArena);
  const auto refused = [](const Bundle& b) {
    try {
      replay(read_bundle(write_bundle(b)), kArena);
    } catch (const Error& e) {
      return e.code();
    }
    return std::string();
  };
  const Bundle good = bundle_with_two_checkpoints(session);
  EXPECT_EQ(refused(good), "") << "the control";
  Bundle bad = good;
  bad.journal[0].step = 1000;
  EXPECT_EQ(refused(bad), "bad_bundle");
  bad = good;
  bad.checkpoints.push_back(bad.checkpoints.front());
  EXPECT_EQ(refused(bad), "bad_bundle");
  bad = good;
  bad.end.step = UINT64_MAX;
  EXPECT_EQ(refused(bad), "bad_bundle");
  bad = good;
  bad.journal[0].command.system = "nobody";
  EXPECT_NE(refused(bad), "");
}

// Whichever snapshot it begins at: snapshots are older than the commands of their step.
TEST(SessionSeek, KeepsTheCommandsOfTheStepThatItBeginsAt) {
  Session s(rope(), kArena);
  std::vector<uint64_t> hashes;
  for (int k = 0; k < 300; ++k) {
    s.command(impulse(1 + k % 8, k % 2 ? 1e-3 : -2e-3));
    hashes.push_back(s.hash());
    s.step(1);
  }
  for (const size_t step : {299, 200, 64, 48, 17, 0}) {
    s.seek(step);
    EXPECT_EQ(s.hash(), hashes[step]) << step;
  }
}

TEST(JournalBound, ShortensThePastAndNothingElse) {
  constexpr size_t kMost = 200;
  Session bounded(rope(), kArena, {.journal_entries = kMost}), free(rope(), kArena);
  for (int k = 0; k < 2000; ++k) {
    const Command c = impulse(1 + k % 8, k % 2 ? 1e-3 : -1e-3);
    for (Session* s : {&bounded, &free}) s->command(c), s->step(1);
    ASSERT_LE(bounded.journal().size(), kMost);
  }
  EXPECT_EQ(bounded.hash(), free.hash());
  EXPECT_EQ(free.journal().size(), 2000u);
  EXPECT_EQ(free.first_step(), 0u);
  const uint64_t first = bounded.first_step();
  ASSERT_GT(first, 0u);
  // However fast the machine is: every eighth of the bound has a snapshot, and half of the journal remains.
  EXPECT_LE(first, 2000u - kMost / 2);
  EXPECT_THROW(bounded.seek(first - 1), Error);
  for (const uint64_t step : {first, first + 7, uint64_t{1999}}) {
    bounded.seek(step), free.seek(step);
    EXPECT_EQ(bounded.hash(), free.hash()) << step;
  }
  EXPECT_FALSE(replay(bundle_of(bounded), kArena).difference);
}

TEST(JournalBound, ManyCommandsOfOneStepBeginThePastThere) {
  constexpr size_t kMost = 50;
  Session bounded(rope(), kArena, {.journal_entries = kMost}), free(rope(), kArena);
  for (Session* s : {&bounded, &free}) {
    s->step(3);
    for (int k = 0; k < 500; ++k) s->command(impulse(1 + k % 8, 1e-3));
    s->step(20);
  }
  EXPECT_LE(bounded.journal().size(), kMost);
  EXPECT_EQ(bounded.first_step(), 3u);
  EXPECT_EQ(bounded.hash(), free.hash());
  bounded.seek(3), free.seek(3);
  EXPECT_EQ(bounded.hash(), free.hash());
  bounded.seek(23), free.seek(23);
  EXPECT_EQ(bounded.hash(), free.hash());
}

}  // namespace
}  // namespace truestep
