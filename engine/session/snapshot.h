// A state of a world as a file: what another process continues from. It names the scene by its fingerprint,
// so a state is never stepped by a world that it does not belong to, and its hash, so a restored state is the
// one that was saved.
#pragma once
#include "engine/session/sealed.h"
#include "engine/session/world.h"

namespace truestep {

inline constexpr SealKind kSnapshotFile{"TSTPSNAP", 1, "bad_snapshot", "snapshot"};

Bytes write_snapshot(const World& world, const WorldState& state);

/// The state, fit to be stepped by this world. Error "bad_snapshot" for bytes that are damaged, of a newer
/// version, of another scene, or that no run of the scene leads to.
WorldState read_snapshot(const World& world, std::span<const std::byte> file);

}  // namespace truestep
