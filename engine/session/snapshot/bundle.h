// A bundle: everything needed to repeat a session elsewhere. The scene with all defaults, the state that the
// journal begins at (none: the scene's start), the journal, and the hashes at the end and at earlier steps.
// Replaying it shows whether another machine, build or number of threads computes the same bits, and if not,
// from where on they differ.
#pragma once
#include <functional>
#include <optional>

#include "engine/session/session.h"
#include "engine/session/snapshot/sealed.h"

namespace truestep {

inline constexpr SealKind kBundleFile{"TSTPBNDL", 1, "bad_bundle", "bundle"};

/// The hash of a state: at a checkpoint taken before the commands of its step, at the end after them.
struct Checkpoint {
  uint64_t step = 0, hash = 0;
};

struct Bundle {
  boost::json::value scene;
  std::string build;  ///< which computed the hashes
  Bytes start;        ///< a snapshot; empty: the scene's start
  std::vector<JournalEntry> journal;
  std::vector<Checkpoint> checkpoints;  ///< by step
  Checkpoint end;
};

/// Covers everything up to the session's present step.
Bundle bundle_of(const Session& session);
Bytes write_bundle(const Bundle& bundle);
/// Error "bad_bundle", or "bad_json" and "bad_command" for its parts.
Bundle read_bundle(std::span<const std::byte> file);

struct ReplayResult {
  uint64_t first_step = 0, last_step = 0;
  uint64_t hash = 0;  ///< at the end
  /// Where the hashes diverge; `after` is the last step at which they were equal.
  struct Difference {
    uint64_t after = 0, step = 0, expected = 0, found = 0;
  };
  std::optional<Difference> difference;
};

/// Runs the bundle and compares; stops at the first difference. Errors of the scene and of its start; an
/// instability before the end is Error "instability".
ReplayResult replay(const Bundle& bundle, std::shared_ptr<const ThreadArena> arena,
                    const std::function<void(uint64_t step)>& progress = {});

}  // namespace truestep
