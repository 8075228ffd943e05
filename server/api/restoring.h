// Sessions between memory and disk: restored when a client asks for one, unloaded when unused for long.
#pragma once
#include "server/api/app.h"

namespace truestep {

/// How long a request waits for a session that is slow to create or restore.
inline constexpr auto kPatience = std::chrono::seconds(5);

/// Starts restoring a session that SessionStore::load or begin reported as stored.
void start_restoring(App& app, const CreationPtr& creation);
/// Begins what makes a new session outlive the process: its recording and its folder. Error "disk_full",
/// "folder_io" or "recording_io"; nothing of it is then left.
void begin_keeping(App& app, SessionEntry& entry);
/// Writes to disk what SessionStore::expire removed.
void unload(App& app, const EntryPtr& entry);
/// Saves the state of all sessions at shutdown. The process may also be killed without it: the logs hold the
/// same information.
void save_sessions(App& app);

}  // namespace truestep
