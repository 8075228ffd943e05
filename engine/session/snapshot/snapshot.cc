#include "engine/session/snapshot/snapshot.h"

#include "engine/base/version.h"

namespace truestep {

Bytes write_snapshot(const World& world, const WorldState& state) {
  SealedWriter out;
  out.number(world.fingerprint());
  out.number(state.hash());
  out.text(std::string(version()) + " " + std::string(build_description()));
  out.block(state.serialize());
  return seal(kSnapshotFile, out.contents());
}

WorldState read_snapshot(const World& world, std::span<const std::byte> file) {
  SealedReader in(kSnapshotFile, unseal(kSnapshotFile, file));
  if (in.number() != world.fingerprint()) in.fail("it belongs to another scene");
  const uint64_t hash = in.number();
  in.text();  // for human readers
  WorldState state = WorldState::deserialize(in.block());
  if (!in.done()) in.fail("unexpected bytes follow its end");
  world.require_state(state);
  if (state.hash() != hash) in.fail("its state does not match its hash");
  return state;
}

}  // namespace truestep
