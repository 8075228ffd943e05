// Restores a session: builds on the saved state and replays the logs, up to the last step that a client was
// told of or to the last frame of its recording.
#pragma once
#include <functional>

#include "server/persistence/sessions/saved_session.h"
#include "server/sessions/entry.h"

namespace truestep {

/// What became of the last command when the logs do not say.
enum class LastCommand : uint8_t { known, refused };

/// For a new entry whose world is the saved one's. `recorded` is the last step of a recording that continues.
/// `before_steps` is called when the session is at the saved state. Interruptible. Error "session_damaged"
/// when the saved data do not fit this world.
LastCommand bring_back(SessionEntry& entry, const SavedSession& saved, std::optional<uint64_t> recorded,
                       const std::function<void()>& before_steps);

}  // namespace truestep
