// /v1/sessions/{id}/snapshots and branch: states that a session, or another one, continues from.
#include "engine/base/hash.h"
#include "server/api/recordings.h"
#include "server/api/requests.h"
#include "server/api/session_answers.h"

namespace truestep {

namespace json = boost::json;
namespace asio = boost::asio;
using net::Method;
using net::Request;
using net::Response;

namespace {

asio::awaitable<Response> take_snapshot(App& app, const Request& request) {
  EntryPtr entry = session_of(app, request);
  co_return co_await with_session_on_worker(app, entry, [&app](SessionEntry& e) {
    if (e.snapshots.size() >= 64) throw Error("quota_exceeded", "a session keeps at most 64 snapshots");
    const std::string sid = "step-" + std::to_string(e.session.step_index());
    const WorldState& now = e.session.state();
    auto lease = app.memory.lease(static_cast<double>(now.memory_bytes()), "this snapshot");
    e.snapshots[sid] = std::make_shared<const Snapshot>(now, std::move(lease));
    Response r = json_response(
        json::object{{"id", sid}, {"step", e.session.step_index()}, {"state_hash", hex64(e.session.hash())}},
        201);
    r.header("Location", "/v1/sessions/" + e.id + "/snapshots/" + sid);
    return r;
  });
}

std::shared_ptr<const Snapshot> snapshot_of(SessionEntry& e, std::string_view sid) {
  const auto it = e.snapshots.find(std::string(sid));
  if (it == e.snapshots.end()) throw Error("not_found", "this session has no such snapshot");
  return it->second;
}

asio::awaitable<Response> restore(App& app, const Request& request) {
  EntryPtr entry = session_of(app, request);
  const std::string sid(request.param("sid"));
  const auto back = [&sid](SessionEntry& e) { e.session.restore(snapshot_of(e, sid)->state); };
  co_await interrupt_and_call(app, entry, back);
  co_return co_await with_session(app, entry,
                                  [](SessionEntry& e) { return json_response(describe_clock(e)); });
}

asio::awaitable<Response> branch(App& app, const Request& request) {
  EntryPtr entry = session_of(app, request);
  auto copy = [&app, entry, caller = request.caller] {
    json::value document;
    json::object accuracy;
    WorldState state;
    {
      const std::lock_guard lock(entry->mutex);
      document = entry->session.world().scene().canonical();
      accuracy = entry->accuracy;
      state = entry->session.state();
    }
    const EntryPtr made = app.store.create(std::move(document), random_session_id(), caller,
                                           SessionStore::Accuracy::chosen, [&](SessionEntry& e) {
                                             e.accuracy = std::move(accuracy);
                                             e.session.restore(std::move(state));
                                             attach_recording(app, e);
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
             [&app](const Request& r) { return branch(app, r); });
  router.add(Method::get, session + "/snapshots", "Snapshots that were taken", [&app](const Request& r) {
    return with_session(app, session_of(app, r), [](SessionEntry& e) {
      json::array list;
      for (const auto& [sid, snapshot] : e.snapshots)
        list.push_back(json::object{{"id", sid}, {"step", snapshot->state.step}});
      return json_response(json::object{{"snapshots", std::move(list)}});
    });
  });
  router.add(Method::post, session + "/snapshots", "Takes a snapshot of the present state",
             [&app](const Request& r) { return take_snapshot(app, r); });
  router.add(Method::get, session + "/snapshots/{sid}", "A snapshot's bytes",
             [&app](const Request& r) -> asio::awaitable<Response> {
               const std::string sid(r.param("sid"));
               co_return co_await with_session_on_worker(app, session_of(app, r), [&sid](SessionEntry& e) {
                 const auto bytes = snapshot_of(e, sid)->state.serialize();
                 return Response::text({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                                       "application/octet-stream");
               });
             });
  router.add(Method::post, session + "/snapshots/{sid}/restore", "Continues from a snapshot",
             [&app](const Request& r) { return restore(app, r); });
}

}  // namespace truestep
