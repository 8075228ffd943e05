// Sessions between memory and disk: brought back when somebody asks for one, put away when nobody has for
// long.
#pragma once
#include "server/api/app.h"

namespace truestep {

/// How long a request waits for a session that takes long to make or to bring back.
inline constexpr auto kPatience = std::chrono::seconds(5);

/// Begins to bring back what SessionStore::load or begin said is stored.
void start_restoring(App& app, const CreationPtr& creation);
/// Puts away what SessionStore::expire took out.
void unload(App& app, const EntryPtr& entry);
/// Saves where the sessions stand, at the end of the service. Whoever cannot wait may end the process: the
/// logs tell the same.
void save_sessions(App& app);

}  // namespace truestep
