// /v1/sessions/{id}/snapshots, branch and bundle: states from which this or another session continues, and
// files that repeat the session elsewhere.
#include "engine/base/hash.h"
#include "engine/session/snapshot/bundle.h"
#include "engine/session/snapshot/snapshot.h"
#include "server/api/recordings.h"
#include "server/api/requests.h"
#include "server/api/restoring.h"
#include "server/api/session_answers.h"
#include "server/persistence/sessions/session_keeper.h"

namespace truestep {

namespace json = boost::json;
using net::Method;
using net::Request;
using net::Response;

namespace {

constexpr size_t kMostSnapshots = 64;               // per session
constexpr size_t kMostUploaded = size_t{64} << 20;  // bytes of an uploaded snapshot

std::span<const std::byte> bytes_of(const Request& request) {
  return std::as_bytes(std::span(request.body.data(), request.body.size()));
}

Response binary(const Bytes& bytes, const std::string& name) {
  Response r =
      Response::text({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "application/octet-stream");
  r.header("Content-Disposition", "attachment; filename=\"" + name + "\"");
  return r;
}

// Of the present state, or uploaded in the body.
Task<Response> keep_snapshot(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const bool uploaded = !request.body.empty() && !is_json(request);
  if (uploaded) require_media(request, "application/octet-stream");
  if (!uploaded) object_body_of(request, {});
  const auto keep = [&app, &request, uploaded](SessionEntry& e) {
    if (e.snapshots.size() + e.stored_snapshots.size() >= kMostSnapshots)
      throw Error("quota_exceeded", "a session keeps at most 64 snapshots");
    auto lease = app.memory.lease(uploaded ? static_cast<double>(request.body.size())
                                           : static_cast<double>(e.session.state().memory_bytes()),
                                  "this snapshot");
    auto snapshot = std::make_shared<const Snapshot>(
        uploaded ? read_snapshot(e.session.world(), bytes_of(request)) : e.session.state(), std::move(lease));
    const WorldState& state = snapshot->state;
    const std::string hash = hex64(state.hash());
    const std::string sid = uploaded ? "upload-" + hash : "step-" + std::to_string(state.step);
    if (e.keeper) {
      app.require_folder();
      const Bytes made = uploaded ? Bytes() : write_snapshot(e.session.world(), state);
      const auto file = uploaded ? bytes_of(request) : std::span<const std::byte>(made);
      app.archive->require_room(static_cast<double>(file.size()));
      e.keeper->folder().keep_snapshot(sid, state.step, file);
    }
    Response r = json_response(json::object{{"id", sid}, {"step", state.step}, {"state_hash", hash}}, 201);
    r.header("Location", "/v1/sessions/" + e.id + "/snapshots/" + sid);
    e.stored_snapshots.erase(sid);
    e.snapshots[sid] = std::move(snapshot);
    return r;
  };
  if (!is_short(request)) co_return co_await with_session_in_long_work(app, entry, keep);
  co_return co_await with_session_on_worker(app, entry, keep);
}

// A snapshot restored with its session is read when it is needed.
std::shared_ptr<const Snapshot> snapshot_of(App& app, SessionEntry& e, const std::string& sid) {
  if (const auto stored = e.stored_snapshots.find(sid); stored != e.stored_snapshots.end() && e.keeper) {
    const Bytes file = e.keeper->folder().snapshot(sid, stored->second);
    auto lease = app.memory.lease(static_cast<double>(file.size()), "this snapshot");
    e.snapshots[sid] =
        std::make_shared<const Snapshot>(read_snapshot(e.session.world(), file), std::move(lease));
    e.stored_snapshots.erase(stored);
  }
  const auto it = e.snapshots.find(sid);
  if (it == e.snapshots.end()) throw Error("not_found", "this session has no such snapshot");
  return it->second;
}

Task<Response> restore(App& app, const Request& request) {
  object_body_of(request, {});
  EntryPtr entry = co_await session_of(app, request);
  const std::string sid(request.param("sid"));
  const auto back = [&app, &sid](SessionEntry& e) { e.session.restore(snapshot_of(app, e, sid)->state); };
  co_await interrupt_and_call(app, entry, back);
  co_return co_await with_session(app, entry,
                                  [](SessionEntry& e) { return json_response(describe_clock(e)); });
}

Task<Response> branch(App& app, const Request& request) {
  object_body_of(request, {});
  EntryPtr entry = co_await session_of(app, request);
  auto copy = [&app, entry, caller = request.caller] {
    json::value document;
    json::object accuracy;
    WorldState state;
    {
      const std::lock_guard lock(entry->mutex);
      entry->require_there();
      document = entry->session.world().scene().canonical();
      accuracy = entry->accuracy;
      state = entry->session.state();
    }
    const EntryPtr made = app.store.create(document, random_session_id(), caller,
                                           SessionStore::Accuracy::chosen, [&](SessionEntry& e) {
                                             e.accuracy = std::move(accuracy);
                                             e.session.restore(std::move(state));
                                             begin_keeping(app, e);
                                           });
    const std::lock_guard lock(made->mutex);
    Response r = json_response(describe_session(*made), 201);
    r.header("Location", "/v1/sessions/" + made->id);
    return r;
  };
  co_return co_await app.runner.long_work(std::move(copy));
}

}  // namespace

void add_snapshot_routes(net::Router& router, App& app) {
  const std::string session = "/v1/sessions/{id}";
  router.add(Method::post, session + "/branch", "A new session that continues from this one's state",
             [&app](const Request& r) { return once(app, r, [&app, &r] { return branch(app, r); }); });
  router.add(Method::get, session + "/snapshots", "The session's snapshots", [&app](const Request& r) {
    return with_session(app, r, [](SessionEntry& e) {
      json::array list;
      for (const auto& [sid, snapshot] : e.snapshots)
        list.push_back(json::object{{"id", sid}, {"step", snapshot->state.step}});
      for (const auto& [sid, step] : e.stored_snapshots)
        list.push_back(json::object{{"id", sid}, {"step", step}});
      return json_response(json::object{{"snapshots", std::move(list)}});
    });
  });
  router
      .add(Method::post, session + "/snapshots",
           "Takes a snapshot of the present state, or stores the one in the body",
           [&app](const Request& r) { return keep_snapshot(app, r); })
      .max_body = kMostUploaded;
  router.add(Method::get, session + "/snapshots/{sid}", "A snapshot as a file, for this or another server",
             [&app](const Request& r) -> Task<Response> {
               const std::string sid(r.param("sid"));
               auto give = [&app, &sid](SessionEntry& e) {
                 return binary(write_snapshot(e.session.world(), snapshot_of(app, e, sid)->state),
                               sid + ".snapshot");
               };
               EntryPtr entry = co_await session_of(app, r);
               co_return co_await with_session_on_worker(app, entry, give);
             });
  router.add(Method::post, session + "/snapshots/{sid}/restore", "Continues from a snapshot",
             [&app](const Request& r) { return restore(app, r); });
  router.add(Method::get, session + "/bundle",
             "Scene, journal, start and hashes as a file for `truestep replay`",
             [&app](const Request& r) -> Task<Response> {
               auto give = [](SessionEntry& e) {
                 return binary(write_bundle(bundle_of(e.session)), e.id + ".bundle");
               };
               EntryPtr entry = co_await session_of(app, r);
               co_return co_await with_session_on_worker(app, entry, give);
             });
}

}  // namespace truestep
