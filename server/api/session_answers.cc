#include "server/api/session_answers.h"

#include "engine/base/hash.h"
#include "engine/scene/params/params.h"
#include "engine/session/describe.h"
#include "engine/sinks/recording/recording_sink.h"
#include "server/net/http/problem.h"
#include "server/persistence/sessions/session_keeper.h"

namespace truestep {

namespace json = boost::json;
using net::Request;
using net::Response;

json::object links_of(const std::string& id) {
  const std::string self = "/v1/sessions/" + id;
  return {{"self", self},
          {"step", self + "/step"},
          {"play", self + "/play"},
          {"pause", self + "/pause"},
          {"reset", self + "/reset"},
          {"frames", self + "/frames"},
          {"latest_frame", self + "/frames/latest"},
          {"observables", self + "/observables"},
          {"plan", self + "/plan"},
          {"scene", self + "/scene"},
          {"commands", self + "/commands"},
          {"queries", self + "/queries"},
          {"snapshots", self + "/snapshots"},
          {"bundle", self + "/bundle"},
          {"picture", self + "/picture.png"},
          {"recording", self + "/recording"},
          {"recordings", "/v1/recordings"},
          {"stream", self + "/stream"},
          {"viewer", "/?session=" + id}};
}

json::object describe_session(SessionEntry& e) {
  const Session& s = e.session;
  json::object o{{"id", e.id},
                 {"name", s.world().scene().header.name},
                 {"step", s.step_index()},
                 {"first_step", s.first_step()},
                 {"time", s.time()},
                 {"dt", s.world().dt()},
                 {"status", s.failure()   ? "unstable"
                            : s.playing() ? "playing"
                                          : "paused"},
                 {"speed", s.speed()},
                 {"skipped_steps", s.skipped_steps()},
                 {"keep_running", e.keep_running || s.world().scene().header.keep_running},
                 {"frames_built", s.frames_built()},
                 {"state_hash", hex64(s.hash())}};
  if (const auto achieved = s.achieved_speed()) o["achieved_speed"] = *achieved;
  if (e.paused_unwatched && !s.playing()) o["paused_because"] = "unwatched";
  json::array systems;
  for (size_t i = 0; i < s.world().size(); ++i) {
    const auto& infos = s.world().system(i).parts();
    json::array parts;
    for (const PartTable::Entry& part : s.world().parts()) {
      if (part.system == i) parts.push_back(describe_part(part));
    }
    systems.push_back(json::object{{"id", s.world().id(i)},
                                   {"type", s.world().scene().systems[i].row->type},
                                   {"fields", infos.empty() ? json::array() : describe_fields(infos[0])},
                                   {"parts", std::move(parts)}});
  }
  o["systems"] = std::move(systems);
  const SceneHeader& header = s.world().scene().header;
  if (!header.title.empty()) o["title"] = header.title;
  if (!header.teaches.empty()) o["teaches"] = header.teaches;
  o["viewer"] = write_params(*scene_table().find("viewer")->nested, &header.viewer);
  if (const auto& f = s.failure()) o["instability"] = describe_failure(*f);
  if (!s.warnings().empty()) o["warnings"] = describe_warnings(s.warnings());
  if (!e.accuracy.empty()) o["accuracy"] = e.accuracy;
  if (e.keeper) {
    o["kept"] = e.keeper->problem().empty();
    if (!e.keeper->problem().empty()) o["not_kept_because"] = e.keeper->problem();
  }
  if (e.recording && e.recording->status().state == RecordingState::kRecording) o["recorded"] = true;
  if (e.recording && e.recording->failed()) o["not_recorded_because"] = e.recording->status().message;
  if (e.restored) {
    o["restored"] = json::object{
        {"from_step", e.restored->from_step}, {"step", e.restored->step}, {"complete", e.restored->complete}};
  }
  o["links"] = links_of(e.id);
  return o;
}

Response cut_short(const App& app, const Request& request, const SessionEntry& e) {
  if (app.server && app.server->draining())
    return net::problem(request, "draining", "the service is shutting down");
  if (e.removed) return net::problem(request, "unknown_session", "the session has been deleted");
  return net::problem(
      request, "interrupted",
      "interrupted by pause, reset or restore at step " + std::to_string(e.session.step_index()), {},
      json::object{{"step", e.session.step_index()}, {"time", e.session.time()}});
}

Response instability(const Request& request, const Session& s) {
  const Failure& f = *s.failure();
  json::object extra = describe_failure(f);
  extra.erase("detail");
  return net::problem(request, "instability", f.detail, {}, extra);
}

}  // namespace truestep
