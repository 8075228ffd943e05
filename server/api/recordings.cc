#include "server/api/recordings.h"

#include "engine/base/log.h"
#include "engine/scene/params/params.h"
#include "engine/scene/scene.h"
#include "engine/sinks/recording/log/salvage.h"
#include "engine/sinks/recording/recording_reader.h"
#include "engine/sinks/recording/recording_sink.h"
#include "server/persistence/sessions/session_keeper.h"

namespace truestep {

namespace json = boost::json;

namespace {

// Ends the newest recording, which can no longer be continued.
void end_newest(App& app, const std::string& session) {
  const auto last = app.recordings.newest(session);
  if (last && (last->state == RecordingFate::closed || last->state == RecordingFate::repaired))
    app.recordings.end(last->id, RecordingFate::finished, last->frames, last->note);
}

void ended(App& app, const std::string& session, const std::string& id, const RecordingStatus& status) {
  if (status.state == RecordingState::kFailed) return;
  if (status.appended_frames > 0) {
    app.recordings.end(id, RecordingFate::finished, status.durable_frames, "");
  } else {
    app.recordings.forget(id);
    end_newest(app, session);
  }
}

const DefTable& recording_table() {
  return *scene_table().find("recording")->nested;
}

RecordingParams params_from(const json::object& body) {
  RecordingParams out;
  std::vector<Issue> issues;
  read_params(recording_table(), &out, body, "", {}, issues);
  if (!issues.empty()) throw Error("bad_request", "the recording is described wrongly", std::move(issues));
  return out;
}

// A request describes the recording itself, a scene has it as a member.
[[noreturn]] void rethrow_without(const std::string& member, const Error& e) {
  std::vector<Issue> issues = e.issues();
  for (Issue& i : issues) {
    if (i.pointer.starts_with(member)) i.pointer.erase(0, member.size());
  }
  throw Error("invalid", e.what(), std::move(issues));
}

void begin(App& app, SessionEntry& entry, std::optional<uint64_t> after, const json::object& asked = {}) {
  if (!app.recordings.on())
    throw Error("folder_io",
                "this server's data folder could not be used when it started, so it cannot record");
  // Whatever is written now must not look like a file left by an earlier run.
  if (app.repairing) throw Error("starting", "recordings of an earlier run are being repaired");
  const SceneHeader& header = entry.session.world().scene().header;
  std::optional<RecordingParams> params;
  if (!asked.empty()) params = params_from(asked);
  const RecordingFacts facts =
      app.recordings.begin(entry.id, entry.owner, header.title.empty() ? header.name : header.title, asked);
  const auto finished = [&app, id = facts.id, session = entry.id](const RecordingStatus& status) {
    ended(app, session, id, status);
  };
  try {
    entry.recording = std::make_shared<RecordingSink>(app.recording_thread, entry.session,
                                                      app.recordings.place(facts.id).path(),
                                                      RecordingTies{after, params, finished});
  } catch (...) {
    app.recordings.forget(facts.id);
    throw;
  }
  entry.recording_id = facts.id;
  entry.session.add_sink(entry.recording);
  app.recordings.attach(facts.id, entry.recording);
}

// Salvages an existing recording; a full disk stops new data, not what it already holds.
void salvage(App& app, const std::string& id, const RecordingStatus& status) {
  const SalvageReport report = salvage_recording(*app.recording_thread, app.recordings.place(id).path());
  app.recordings.end(id, RecordingFate::incomplete, report.frames, status.message);
}

}  // namespace

void attach_recording(App& app, SessionEntry& entry) {
  if (entry.session.world().scene().header.recording) begin(app, entry, std::nullopt);
}

bool recording_goes_on(const App& app, const std::string& session) {
  const auto last = app.recordings.newest(session);
  return last && last->state != RecordingFate::finished && last->state != RecordingFate::incomplete;
}

std::optional<uint64_t> last_recorded_step(App& app, const std::string& session) {
  // The newest may have been cut off before its first frame.
  for (const RecordingFacts& f : app.recordings.of_session(session)) {
    try {
      // Opened here, where no link is followed; the library opens what this is.
      const Descriptor file = app.recordings.place(f.id).open(O_RDONLY, "read");
      RecordingReader reader(app.recording_thread, path_of(file));
      const uint64_t frames = reader.info().frames;
      if (frames > 0) return static_cast<uint64_t>(reader.read_clock(frames - 1).step);
    } catch (const Error& e) {
      log_warn("recording {}: {}", f.id, e.what());
    }
  }
  return std::nullopt;
}

void continue_recording(App& app, SessionEntry& entry, std::optional<uint64_t> after) {
  const World& world = entry.session.world();
  const auto newest = app.recordings.newest(entry.id);
  const json::object asked = newest ? newest->asked : json::object();
  if (asked.empty() && (!world.scene().header.recording || (after && !RecordingSink::goes_on(world, *after))))
    return;
  // The session went on unrecorded (a full disk), and no state from before leads to the next frame.
  if (const uint64_t from = entry.session.step_index(); from > after.value_or(0)) {
    if (const auto last = app.recordings.newest(entry.id))
      app.recordings.end(last->id, RecordingFate::incomplete, last->frames,
                         "frames up to step " + std::to_string(from) + " are missing" +
                             (last->note.empty() ? "" : ": " + last->note));
    return begin(app, entry, std::nullopt, asked);
  }
  begin(app, entry, after, asked);
}

RecordingFacts start_recording(App& app, SessionEntry& entry, const json::object& body) {
  if (entry.recording && entry.recording->status().state == RecordingState::kRecording)
    throw Error("conflict", "this session is being recorded; finish that recording first");
  // Complete and with defaults, so that it says of itself what it is.
  const RecordingParams params = params_from(body);
  if (entry.recording) close_recording(app, entry);
  end_newest(app, entry.id);
  try {
    begin(app, entry, std::nullopt, write_params(recording_table(), &params));
  } catch (const Error& e) {
    if (e.code() == "scene_invalid") rethrow_without("/recording", e);
    throw;
  }
  entry.recording_failed = false;
  if (entry.keeper) entry.keeper->keep_for(entry.recording);
  return app.recordings.newest(entry.id).value();
}

void discard_recording(App& app, SessionEntry& entry) {
  if (!entry.recording) return;
  entry.session.remove_sink(entry.recording.get());
  entry.recording->close();
  entry.recording.reset();
  app.recordings.forget(entry.recording_id);
}

void close_recording(App& app, SessionEntry& entry) {
  if (!entry.recording) return;
  entry.session.remove_sink(entry.recording.get());
  if (entry.recording->status().state == RecordingState::kRecording) {
    const RecordingStatus status = entry.recording->close();
    if (status.state == RecordingState::kFailed)
      salvage(app, entry.recording_id, status);
    else if (status.appended_frames == 0)
      app.recordings.forget(entry.recording_id);
    else
      app.recordings.end(entry.recording_id, RecordingFate::closed, status.durable_frames, "");
  } else if (app.recordings.live(entry.recording_id)) {
    salvage(app, entry.recording_id, entry.recording->status());
  }
  entry.recording.reset();
}

RecordingFacts finish_recording(App& app, SessionEntry& entry) {
  if (entry.recording) {
    const RecordingStatus status = entry.recording->finish();
    if (status.state == RecordingState::kFailed && app.recordings.live(entry.recording_id))
      salvage(app, entry.recording_id, status);
  }
  end_newest(app, entry.id);
  const auto last = app.recordings.newest(entry.id);
  if (!last)
    throw Error("not_found", "this session records nothing; give its scene a \"recording\" or POST one");
  return *last;
}

void close_recordings(App& app) {
  for (const EntryPtr& e : app.store.all()) {
    const std::lock_guard lock(e->mutex);
    close_recording(app, *e);
  }
}

}  // namespace truestep
