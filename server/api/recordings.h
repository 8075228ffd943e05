// Recordings of sessions: files of the server's own naming in its data directory, one per session and
// restart.
#pragma once
#include "server/api/app.h"

namespace truestep {

/// Begins the recording that the scene asks for; call with the entry's lock held.
void attach_recording(App& app, SessionEntry& entry);
/// Ends the recording and removes its file; call with the entry's lock held.
void discard_recording(SessionEntry& entry);
/// Completes all recordings that are being written: at the end of the service.
void finish_recordings(App& app);
/// Repairs files whose writer died; returns how many were repaired.
int recover_recordings(App& app);

void add_recording_routes(net::Router& router, App& app);

}  // namespace truestep
