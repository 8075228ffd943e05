// The recording that belongs to a session: begun with it, continued when it comes back from disk, completed
// when either ends.
#pragma once
#include "server/api/app.h"

namespace truestep {

// With the entry's lock held, or before anybody can find it:
/// Begins the recording that the scene asks for.
void attach_recording(App& app, SessionEntry& entry);
/// Goes on with the recording of a session that comes back, in a new file that begins behind the last frame
/// of the one before.
void continue_recording(App& app, SessionEntry& entry, std::optional<uint64_t> after);
/// Whether it is to be continued.
bool recording_goes_on(const App& app, const std::string& session);
/// The step of the last frame that the session's recordings hold.
std::optional<uint64_t> last_recorded_step(App& app, const std::string& session);
/// Takes back what attach or continue began.
void discard_recording(App& app, SessionEntry& entry);
/// Completes the file for now: the session may come back and go on.
void close_recording(App& app, SessionEntry& entry);
/// Completes it for good. What could not be written is no fault of what was.
RecordingFacts finish_recording(App& app, SessionEntry& entry);

/// Closes all that are being written: at the end of the service.
void close_recordings(App& app);

void add_recording_routes(net::Router& router, App& app);

}  // namespace truestep
