// The recording of a session: begun with it, continued when it comes back from disk, completed when either
// ends.
#pragma once
#include "server/api/app.h"

namespace truestep {

// With the entry's lock held, or before the session becomes visible:
/// Begins the recording that the scene asks for.
void attach_recording(App& app, SessionEntry& entry);
/// Continues the recording of a restored session, in a new file that starts after the last frame of the
/// previous one.
void continue_recording(App& app, SessionEntry& entry, std::optional<uint64_t> after);
/// Whether the session's recording is to be continued.
bool recording_goes_on(const App& app, const std::string& session);
/// The step of the last frame in the session's recordings.
std::optional<uint64_t> last_recorded_step(App& app, const std::string& session);
/// Begins a recording of a session that runs, as the body asks: the object that a scene's "recording" is.
/// Error "conflict" while one runs.
RecordingFacts start_recording(App& app, SessionEntry& entry, const boost::json::object& body);
/// Undoes attach or continue.
void discard_recording(App& app, SessionEntry& entry);
/// Completes the file for now: the session may come back and continue.
void close_recording(App& app, SessionEntry& entry);
/// Completes it for good. A failed write does not harm what was written before.
RecordingFacts finish_recording(App& app, SessionEntry& entry);

/// Closes all recordings in progress, at shutdown.
void close_recordings(App& app);

void add_recording_routes(net::Router& router, App& app);

}  // namespace truestep
