// A refused command changes nothing: neither the state, nor the future that a seek went back from.
#include <gtest/gtest.h>

#include "engine/base/errors.h"
#include "engine/session/snapshot/bundle.h"

namespace truestep {
namespace {

Command impulse_on(int64_t row) {
  Command c;
  c.kind = CommandKind::impulse;
  c.system = "a";
  c.index = row;
  c.vector = {1, 0, 0};
  return c;
}

TEST(RefusedCommand, LeavesTheFutureThatASeekWentBackFrom) {
  const auto world = std::make_shared<const World>(parse_scene(R"({
    "schema_version": "1.0", "time": {"dt": 0.004},
    "systems": [{"type": "oscillator", "id": "a", "stiffness": 40, "position": 1}]})"));
  const auto arena = std::make_shared<const ThreadArena>(1);
  Session s(world, arena);
  s.step(9);
  s.command(impulse_on(0));
  s.step(31);
  const uint64_t end = s.hash();
  s.seek(5);
  EXPECT_THROW(s.command(impulse_on(77)), Error);
  EXPECT_EQ(s.journal_ahead().size(), 1u);
  s.step(35);
  EXPECT_EQ(s.hash(), end);
  EXPECT_FALSE(replay(read_bundle(write_bundle(bundle_of(s))), arena).difference);
  // The control: a command that is carried out makes another future.
  s.seek(5);
  s.command(impulse_on(0));
  EXPECT_TRUE(s.journal_ahead().empty());
  s.step(35);
  EXPECT_NE(s.hash(), end);
  EXPECT_FALSE(replay(read_bundle(write_bundle(bundle_of(s))), arena).difference);
}

}  // namespace
}  // namespace truestep
