// About the service itself: health, metrics, version, descriptions, and the viewer's files.
#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include "engine/base/version.h"
#include "server/api/docs/openapi.h"
#include "server/api/docs/openapi_tables.h"
#include "server/api/known_queries.h"
#include "server/api/recordings.h"
#include "server/api/requests.h"
#include "server/assets/assets.h"

namespace truestep {

namespace json = boost::json;
using net::Method;
using net::Request;
using net::Response;

namespace {

// One scrape: the counters are copied from where they are counted into a temporary registry.
std::string metrics_text(App& app) {
  prometheus::Registry registry;
  const auto counter = [&](const char* name, const char* help, double value) {
    prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add({}).Increment(value);
  };
  const auto gauge = [&](const char* name, const char* help, double value) {
    prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({}).Set(value);
  };
  size_t playing = 0, overhead = 0, state = 0;
  uint64_t frames = 0;
  for (const EntryPtr& e : app.store.all()) {
    // A session in the middle of a step is skipped, not waited for.
    const std::unique_lock lock(e->mutex, std::try_to_lock);
    if (!lock.owns_lock()) {
      ++playing;
      continue;
    }
    playing += e->session.playing();
    frames += e->session.frames_built();
    overhead += e->session.overhead_bytes();
    state += e->session.state().memory_bytes();
  }
  gauge("truestep_sessions", "sessions that exist", static_cast<double>(app.store.size()));
  gauge("truestep_sessions_playing", "sessions that run", static_cast<double>(playing));
  gauge("truestep_state_bytes", "bytes of all states", static_cast<double>(state));
  gauge("truestep_session_overhead_bytes", "bytes of histories, series and journals",
        static_cast<double>(overhead));
  gauge("truestep_memory_leased_bytes", "bytes of memory that are reserved", app.memory.used());
  gauge("truestep_memory_limit_bytes", "bytes of memory that may be reserved", app.memory.limit());
  counter("truestep_steps_total", "steps done", static_cast<double>(app.runner.steps_done()));
  gauge("truestep_frames_built", "frames built by the sessions that exist", static_cast<double>(frames));
  counter("truestep_stream_frames_total", "frames sent to streams",
          static_cast<double>(app.stream_stats.frames));
  counter("truestep_stream_dropped_total", "frames dropped by streams",
          static_cast<double>(app.stream_stats.dropped));
  counter("truestep_stream_bytes_total", "bytes of frames sent to streams",
          static_cast<double>(app.stream_stats.bytes));
  if (app.server) {
    const net::ServerStats& s = app.server->stats();
    counter("truestep_http_requests_total", "requests answered", static_cast<double>(s.requests));
    counter("truestep_http_errors_4xx_total", "requests refused", static_cast<double>(s.errors_4xx));
    counter("truestep_http_errors_5xx_total", "requests failed", static_cast<double>(s.errors_5xx));
    counter("truestep_connections_total", "connections accepted", static_cast<double>(s.accepted));
    counter("truestep_connections_refused_total", "connections turned away", static_cast<double>(s.refused));
    gauge("truestep_connections", "connections open", static_cast<double>(s.connections));
    gauge("truestep_websockets", "streams open", static_cast<double>(s.websockets));
  }
  return prometheus::TextSerializer().Serialize(registry.Collect());
}

Response asset(const Request& request) {
  const Asset* a = find_asset(request.raw_path);
  if (!a) throw Error("not_found", "there is no such path; GET /docs lists all paths");
  const bool gzip = !a->gzip.empty() && request.header_has_token("accept-encoding", "gzip");
  Response r = Response::text(std::string(gzip ? a->gzip : a->bytes), std::string(a->mime));
  r.etag = gzip ? a->gzip_etag : a->etag;
  if (gzip) r.header("Content-Encoding", "gzip");
  r.header("Vary", "Accept-Encoding");
  r.header("Cache-Control", a->cache_control);
  r.header("X-Content-Type-Options", "nosniff");
  if (a->mime.starts_with("text/html")) {
    r.header("Content-Security-Policy",
             "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src "
             "'self' ws: wss:; frame-ancestors 'self'");
  }
  return r;
}

}  // namespace

void add_service_routes(net::Router& router, App& app) {
  const auto open = [](net::Route& r) { r.access = net::Access::open; };
  static const auto kHealthy = std::make_shared<const std::string>("{\"status\":\"ok\"}");
  open(router.add(Method::get, "/healthz", "The process answers",
                  [](const Request&) { return Response::shared(kHealthy, "application/json"); }));
  open(router.add(Method::get, "/readyz", "New sessions are accepted", [&app](const Request&) {
    if (app.server && app.server->draining()) throw Error("draining", "the service is shutting down");
    if (app.repairing) throw Error("starting", "recordings of an earlier run are being repaired");
    app.require_folder();
    return Response::shared(kHealthy, "application/json");
  }));
  router.add(Method::get, "/metrics", "Counters in Prometheus' text format", [&app](const Request&) {
    return Response::text(metrics_text(app), "text/plain; version=0.0.4; charset=utf-8");
  });
  open(router.add(Method::get, "/version", "Version and build", [](const Request&) {
    return json_response(json::object{
        {"name", "truestep"}, {"version", version()}, {"build", build_description()}, {"api", "v1"}});
  }));
  for (const Asset& a : all_assets()) {
    open(router.add(Method::get, std::string(a.path), std::string(kViewerFile), asset));
  }
  open(router.add(Method::get, "/", "The viewer", asset));
}

net::Router make_router(App& app) {
  net::Router router;
  add_service_routes(router, app);
  add_catalogue_routes(router, app);
  add_thumbnail_routes(router, app);
  add_session_routes(router, app);
  add_playback_routes(router, app);
  add_snapshot_routes(router, app);
  add_frame_routes(router, app);
  add_motion_routes(router, app);
  add_query_routes(router, app);
  add_asset_routes(router, app);
  add_recording_routes(router, app);
  add_operation_routes(router, app);
  add_description_routes(router,
                         {!app.options.net.api_key_file.empty(), app.options.net.websocket.max_message});
  router.check_rows(query_check);
  return router;
}

}  // namespace truestep
