#include "server/api/recordings.h"

#include <filesystem>

#include "engine/base/log.h"
#include "engine/sinks/recording/chunk_log.h"
#include "engine/sinks/recording/recording_sink.h"
#include "engine/sinks/recording/recover.h"
#include "server/api/requests.h"
#include "server/net/problem.h"

namespace truestep {

namespace fs = std::filesystem;
namespace json = boost::json;
namespace asio = boost::asio;
using net::Method;
using net::Request;
using net::Response;

void attach_recording(App& app, SessionEntry& entry) {
  if (!entry.session.world().scene().header.recording) return;
  if (app.options.data_dir.empty())
    throw Error("bad_request", "this server has no data directory, so it cannot record");
  // What is written now must not look like a file that an earlier run left.
  if (app.repairing) throw Error("starting", "recordings of an earlier run are being repaired");
  const fs::path path = fs::path(app.options.data_dir) / (entry.id + ".vtkhdf");
  entry.recording = std::make_shared<RecordingSink>(app.recording_thread, entry.session, path.string());
  entry.session.add_sink(entry.recording);
}

void discard_recording(SessionEntry& entry) {
  if (!entry.recording) return;
  entry.session.remove_sink(entry.recording.get());
  entry.recording->finish();
  std::error_code ignored;
  fs::remove(entry.recording->path(), ignored);
  fs::remove(chunk_log_path(entry.recording->path()), ignored);
  entry.recording.reset();
}

void finish_recordings(App& app) {
  for (const EntryPtr& e : app.store.all()) {
    const std::lock_guard lock(e->mutex);
    if (!e->recording) continue;
    e->session.remove_sink(e->recording.get());
    e->recording->finish();
  }
}

int recover_recordings(App& app) {
  int repaired = 0;
  if (app.options.data_dir.empty() || !fs::exists(app.options.data_dir)) return 0;
  for (const auto& file : fs::directory_iterator(app.options.data_dir)) {
    if (file.path().extension() != ".vtkhdf") continue;
    const RecoveryReport report = recover_recording(*app.recording_thread, file.path().string(), {});
    if (report.outcome == RecoveryOutcome::kRecovered) {
      ++repaired;
      spdlog::warn("recording {} was not finished: {} of {} frames kept", file.path().string(),
                   report.frames_kept, report.frames_found);
    } else if (report.outcome != RecoveryOutcome::kIntact) {
      spdlog::error("recording {} could not be repaired: {}", file.path().string(), report.message);
    }
  }
  return repaired;
}

namespace {

// 409 with the way to finish it while it is written; the file afterwards.
Response recording(const Request& request, SessionEntry& e) {
  if (!e.recording) throw Error("not_found", "this session records nothing; give its scene a \"recording\"");
  const RecordingStatus status = e.recording->status();
  if (status.state == RecordingState::kRecording) {
    return net::problem(request, "conflict", "the recording is being written; finish it first", {},
                        json::object{{"frames", status.durable_frames},
                                     {"finish", "/v1/sessions/" + e.id + "/recording/finish"}});
  }
  if (status.state == RecordingState::kFailed) return net::problem(request, status.code, status.message);
  Response r = Response::file(e.recording->path(), "application/x-hdf5");
  r.header("Content-Disposition", "attachment; filename=\"" + e.id + ".vtkhdf\"");
  return r;
}

}  // namespace

void add_recording_routes(net::Router& router, App& app) {
  const std::string path = "/v1/sessions/{id}/recording";
  router.add(Method::get, path, "The recording as HDF5 (H5MD and VTKHDF); 409 while it is written",
             [&app](const Request& r) -> asio::awaitable<Response> {
               co_return co_await with_session_on_worker(app, session_of(app, r),
                                                         [&](SessionEntry& e) { return recording(r, e); });
             });
  router.add(Method::post, path + "/finish", "Completes the recording, so that it can be downloaded",
             [&app](const Request& r) {
               object_body_of(r, {});
               return with_session_on_worker(app, session_of(app, r), [](SessionEntry& e) {
                 if (!e.recording)
                   throw Error("not_found", "this session records nothing; give its scene a \"recording\"");
                 const RecordingStatus status = e.recording->finish();
                 if (status.state == RecordingState::kFailed) throw Error(status.code, status.message);
                 return json_response(json::object{{"frames", status.durable_frames},
                                                   {"recording", "/v1/sessions/" + e.id + "/recording"}});
               });
             });
}

}  // namespace truestep
