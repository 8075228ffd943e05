// A world's state as a file, from which another process can continue. It names the scene by its fingerprint,
// so that a state is never stepped by a foreign world, and contains its hash, so that the restored state is
// the one that was saved.
#pragma once
#include "engine/session/snapshot/sealed.h"
#include "engine/session/world/world.h"

namespace truestep {

inline constexpr SealKind kSnapshotFile{"TSTPSNAP", 1, "bad_snapshot", "snapshot"};

Bytes write_snapshot(const World& world, const WorldState& state);

/// The state, fit to be stepped by this world. Error "bad_snapshot" for bytes that are damaged, of a newer
/// version, of another scene, or that no run of the scene could have produced.
WorldState read_snapshot(const World& world, std::span<const std::byte> file);

}  // namespace truestep
