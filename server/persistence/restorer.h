// Brings a session back: builds on the state that was saved and repeats what its logs tell, to the step at
// which somebody was last told that it stood, or to the last frame of its recording.
#pragma once
#include <functional>

#include "server/persistence/saved_session.h"
#include "server/sessions/entry.h"

namespace truestep {

/// What became of the last command, of which the logs do not tell.
enum class LastCommand : uint8_t { known, refused };

/// Of a new entry whose world is the saved one's. `recorded` is the last step of a recording that goes on.
/// `before_steps` is called when the session stands at the saved state. May be interrupted. Error
/// "session_damaged" when what was saved is not of this world.
LastCommand bring_back(SessionEntry& entry, const SavedSession& saved, std::optional<uint64_t> recorded,
                       const std::function<void()>& before_steps);

}  // namespace truestep
