#include "server/api/restoring.h"

#include "engine/base/log.h"
#include "server/api/recordings.h"
#include "server/api/requests.h"
#include "server/data/folder_lock.h"
#include "server/persistence/files.h"
#include "server/persistence/sessions/restorer.h"
#include "server/persistence/sessions/session_keeper.h"

namespace truestep {

namespace {

// Anything that computes for longer goes to the threads for long work.
constexpr double kShortWay = 0.02;       // s
constexpr double kShortFiles = 1 << 18;  // bytes, read and parsed in a few milliseconds

enum class LongParts : uint8_t { here, left };

struct Saved {
  SavedSession session;
  SceneDraft draft;
  std::optional<uint64_t> recorded;  ///< last step of its recording
  bool records = false;              ///< and that recording continues
};

Saved read_saved(App& app, const std::string& id) {
  Saved saved;
  saved.records = app.recordings.on() && recording_goes_on(app, id);
  if (saved.records) {
    if (app.repairing) throw Error("starting", "recordings of an earlier run are being repaired");
    saved.recorded = last_recorded_step(app, id);
  }
  const auto wanted = saved.records ? std::optional(saved.recorded.value_or(0)) : std::nullopt;
  saved.session = app.archive->read(id, wanted);
  saved.draft = read_draft(saved.session.scene.document);
  return saved;
}

void prepare(App& app, SessionEntry& e, const Saved& saved) {
  try {
    const LastCommand last = bring_back(e, saved.session, saved.recorded, [&] {
      if (saved.records) continue_recording(app, e, saved.recorded);
    });
    e.stored_snapshots = app.archive->folder_of(e.id).snapshots();
    e.keeper = app.archive->keep_on(saved.session, e.session);
    e.keeper->keep_for(e.recording);
    e.session.add_sink(e.keeper);
    // Its number is that of the log record.
    if (last == LastCommand::refused) e.keeper->command_refused(*saved.session.course.unconfirmed);
  } catch (...) {
    discard_recording(app, e);
    throw;
  }
}

// Reads it and makes it; the long parts are left to the threads for long work, or made here.
void restore(App& app, const CreationPtr& creation, LongParts parts) {
  const auto saved = std::make_shared<Saved>();
  try {
    *saved = read_saved(app, creation->id);
  } catch (...) {
    return app.store.fail(creation, std::current_exception());
  }
  const std::function<void()> make = [&app, creation, saved] {
    app.store.make(creation, std::move(saved->draft), SessionStore::Accuracy::chosen,
                   [&app, saved](SessionEntry& e) { prepare(app, e, *saved); });
  };
  const uint64_t to = std::max(saved->session.course.step, saved->recorded.value_or(0));
  const auto steps = static_cast<double>(to - std::min(to, saved->session.from_step));
  const bool takes_long = saved->draft.heavy() || steps * saved->draft.cost.seconds_per_step > kShortWay;
  if (takes_long && parts == LongParts::left)
    app.runner.start_long_work(make);
  else
    make();
}

}  // namespace

void start_restoring(App& app, const CreationPtr& creation) {
  app.runner.pool().post([&app, creation] {
    // A long scene, journal or state is not even read beside what answers others.
    if (app.archive->folder_of(creation->id).bytes_to_read() > kShortFiles)
      return app.runner.start_long_work([&app, creation] { restore(app, creation, LongParts::here); });
    restore(app, creation, LongParts::left);
  });
}

Task<EntryPtr> session_of(App& app, const net::Request& request) {
  const std::string_view id = request.param("id");
  if (EntryPtr entry = app.store.find(id, request.caller)) co_return entry;
  const auto deadline = Clock::now() + kPatience;
  while (true) {
    const auto [creation, how] = app.store.load(id, request.caller);
    if (how == SessionStore::Begun::How::stored) start_restoring(app, creation);
    // Others may be waiting for it too, so a client that leaves cancels nothing.
    const auto ended = [c = creation] { return c->ended.load(); };
    const auto give_up = [] {};
    co_await wait_for_end(creation->done, ended, give_up, deadline);
    if (!creation->ended)
      throw Error("creating", "this session is being loaded from or saved to disk; try again");
    if (creation->error) std::rethrow_exception(creation->error);
    if (EntryPtr entry = app.store.find(id, request.caller)) co_return entry;
  }
}

void begin_keeping(App& app, SessionEntry& entry) {
  app.require_folder();
  attach_recording(app, entry);
  try {
    app.store.keep(entry);
  } catch (...) {
    discard_recording(app, entry);
    throw;
  }
}

namespace {

// What there is no memory to save is in the log, from which it is computed again.
void save_with_what_there_is(SessionEntry& e) {
  if (!e.keeper) return;
  try {
    e.keeper->save();
  } catch (const std::bad_alloc&) {
    log_warn("session {}: no memory to save its state; its log leads there", e.id);
  }
}

}  // namespace

void unload(App& app, const EntryPtr& entry) {
  {
    const std::lock_guard lock(entry->mutex);
    close_recording(app, *entry);
    save_with_what_there_is(*entry);
    if (entry->keeper) entry->keeper->abandon();
  }
  app.store.unloaded(entry);
}

void save_sessions(App& app) {
  if (!app.archive) return;
  for (const EntryPtr& e : app.store.all()) {
    const std::lock_guard lock(e->mutex);
    save_with_what_there_is(*e);
  }
  try {
    // Once for all sessions.
    sync_disk_of(app.data);
  } catch (const Error& e) {
    log_warn("what was kept may not survive a power cut: {}", e.what());
  }
}

void App::require_folder() const {
  const std::string problem = folder ? folder->problem() : "";
  if (!problem.empty()) throw Error("folder_io", problem);
}

Place open_data(const AppOptions& options) {
  if (options.data_dir.empty()) return {};
  try {
    return Place::folder(options.data_dir);
  } catch (const Error& e) {
    log_warn("no recordings, and no session outlives the server: {}", e.what());
    return {};
  }
}

std::unique_ptr<SessionArchive> open_archive(const AppOptions& options, const Place& data,
                                             MemoryBudget& memory) {
  if (!data || !options.keep_sessions) return nullptr;
  try {
    return std::make_unique<SessionArchive>(data / "sessions", *options.keep_sessions, memory);
  } catch (const Error& e) {
    log_warn("sessions are not kept: {}", e.what());
    return nullptr;
  }
}

}  // namespace truestep
