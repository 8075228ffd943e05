// /v1/sessions: create, list, describe, command, end.
#include "engine/base/log.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/command_list.h"
#include "engine/session/commands.h"
#include "engine/session/describe.h"
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

// A scene, or {"gallery": name}.
json::value scene_document(json::value body) {
  if (!body.is_object() || !body.as_object().contains("gallery")) return body;
  const json::object& o = body.as_object();
  const json::value& name = o.at("gallery");
  std::vector<Issue> issues;
  for (const auto& [key, value] : o) {
    if (key != "gallery")
      issues.push_back({"/" + std::string(key), "unknown_key", "\"gallery\" takes no other members", "",
                        "gallery", "", ""});
  }
  const GalleryScene* g =
      name.is_string() ? find_gallery_scene({name.as_string().data(), name.as_string().size()}) : nullptr;
  if (!g) {
    std::string all;
    for (const GalleryScene& s : gallery()) all += (all.empty() ? "" : ", ") + std::string(s.name);
    issues.push_back({"/gallery", "unknown_choice", "the gallery has no such scene",
                      name.is_string() ? write_json(name) : "", all, "", ""});
  }
  if (!issues.empty()) throw Error("scene_invalid", "there is no such gallery scene", std::move(issues));
  return parse_json(g->text);
}

json::object describe_creation(const Creation& c) {
  return {{"id", c.id},
          {"status", c.kind == Creation::Kind::create ? "creating" : "restoring"},
          {"stage", c.stage.load()},
          {"elapsed", std::chrono::duration<double>(Clock::now() - c.begun).count()},
          {"links", json::object{{"self", "/v1/sessions/" + c.id}}}};
}

// Light scenes are built at once, heavy ones on the threads for long work.
void start_making(App& app, const CreationPtr& creation, SceneDraft draft) {
  const bool heavy = draft.heavy();
  const auto shared = std::make_shared<SceneDraft>(std::move(draft));
  std::function<void()> make = [&app, creation, shared] {
    app.store.make(creation, std::move(*shared), SessionStore::Accuracy::choose,
                   [&app](SessionEntry& e) { begin_keeping(app, e); });
  };
  if (heavy)
    app.runner.start_long_work(make);
  else
    app.runner.pool().post(make);
}

Response answer_of(const Creation& c) {
  Response answer;
  if (c.ended) {
    const std::lock_guard lock(c.entry->mutex);
    answer = json_response(describe_session(*c.entry), c.existed ? 200 : 201);
  } else {
    answer = json_response(describe_creation(c), 202);
    answer.header("Retry-After", "1");
  }
  answer.header("Location", "/v1/sessions/" + c.id);
  return answer;
}

Task<Response> make_session(App& app, const Request& request, std::string id) {
  auto read = [&app](json::value body) {
    const auto lease = app.assets.resolve(body, app.memory);
    return read_draft(scene_document(std::move(body)));
  };
  SceneDraft draft = co_await with_json_body(app, request, std::move(read));
  CreationPtr creation;
  const auto deadline = Clock::now() + kPatience;
  for (;;) {
    auto [begun, how] = app.store.begin(id, draft.hash, request.caller);
    creation = std::move(begun);
    const auto ended = [c = creation] { return c->ended.load(); };
    if (how == SessionStore::Begun::How::anew) {
      start_making(app, creation, std::move(draft));
      const auto give_up = [c = creation] { c->interrupt.raise(); };
      co_await wait_for_end(creation->done, ended, give_up, deadline);
      break;
    }
    if (how == SessionStore::Begun::How::stored) start_restoring(app, creation);
    co_await wait_for_end(
        creation->done, ended, [] {}, deadline);
    // A session that is being unloaded is restored as soon as that is done.
    if (!creation->ended || creation->entry || creation->error) break;
  }
  if (creation->ended && creation->error) {
    app.store.forget(creation);
    std::rethrow_exception(creation->error);
  }
  auto describe = [c = creation] { return answer_of(*c); };
  co_return co_await offload(app.runner.pool(), std::move(describe));
}

Task<Response> describe(App& app, const Request& request) {
  const std::string_view id = request.param("id");
  if (const CreationPtr c = app.store.creation(id, request.caller); c && c->kind == Creation::Kind::create) {
    if (c->ended && c->error) std::rethrow_exception(c->error);
    if (!c->ended) co_return json_response(describe_creation(*c));
  }
  EntryPtr entry;
  try {
    entry = co_await session_of(app, request);
  } catch (const Error& e) {
    const CreationPtr c = app.store.creation(id, request.caller);
    if (e.code() != "creating" || !c || c->ended) throw;
    co_return json_response(describe_creation(*c));
  }
  co_return co_await with_session(app, entry,
                                  [](SessionEntry& e) { return json_response(describe_session(e)); });
}

// A creation is stopped; loading or unloading is waited for.
Task<Response> end(App& app, const Request& request) {
  const std::string id(request.param("id"));
  if (const CreationPtr c = app.store.creation(id, request.caller); c && !c->ended) {
    app.store.forget(c);
    if (c->kind == Creation::Kind::create) co_return Response(204);
    const auto ended = [c] { return c->ended.load(); };
    const auto give_up = [] {};
    co_await wait_for_end(c->done, ended, give_up);
  }
  const EntryPtr found = app.store.find(id, request.caller);
  if (!found) {
    auto work = [&app, id] {
      app.archive->remove(id);
      return Response(204);
    };
    co_return co_await offload(app.runner.pool(), std::move(work));
  }
  // From disk first: a session neither in memory nor on disk is gone.
  found->deleted = true;
  auto forget = [&app, found] {
    if (found->keeper) app.archive->remove(found->id);
    return app.store.remove(found);
  };
  const EntryPtr entry = co_await offload(app.runner.pool(), std::move(forget));
  entry->publish();
  auto finish = [&app, entry] {
    const std::lock_guard lock(entry->mutex);
    entry->session.say_bye("unknown_session", "the session has been deleted");
    app.runner.interrupt(*entry);
    entry->session.pause();
    try {
      if (entry->recording) finish_recording(app, *entry);
    } catch (const Error& error) {
      // Its file has been removed, for example; the session has ended all the same.
      log_warn("recording {}: {}", entry->recording_id, error.what());
    }
    return Response(204);
  };
  co_return co_await offload(app.runner.pool(), std::move(finish));
}

// Of one command, or of an array of them: all or none.
json::value carry_out_commands(Session& session, const json::value& body) {
  if (body.is_array()) {
    json::array out;
    for (const uint64_t n : carry_out(session, body.as_array(), ""))
      out.push_back(json::object{{"sequence", n}, {"step", session.step_index()}});
    return out;
  }
  const Command c = read_command_for(session.world(), session.state(), body);
  return json::object{{"sequence", session.command(c)}, {"step", session.step_index()}};
}

Task<Response> command(App& app, const Request& request) {
  EntryPtr entry = co_await session_of(app, request);
  const json::value body = co_await long_json_body(app, request);
  json::value answer;
  std::function<void(SessionEntry&)> act = [&](SessionEntry& e) {
    answer = carry_out_commands(e.session, body);
  };
  const JobPtr job = co_await app.runner.call(entry, std::move(act));
  if (job->end == Job::End::reached) co_return json_response(answer, 202);
  co_return co_await with_session(app, entry, [&](SessionEntry& e) { return cut_short(app, request, e); });
}

}  // namespace

void add_session_routes(net::Router& router, App& app) {
  const std::string session = "/v1/sessions/{id}";
  router.add(Method::post, "/v1/sessions", "Creates a session from a scene or {\"gallery\": name}",
             [&app](const Request& r) {
               return once(app, r, [&app, &r] { return make_session(app, r, random_session_id()); });
             });
  router.add(Method::put, session,
             "Creates a session under the client's own UUID; repeating it changes nothing",
             [&app](const Request& r) {
               const std::string id(r.param("id"));
               if (!is_session_id(id))
                 throw Error("bad_request", "a session id must be a UUID in lower-case hexadecimal digits");
               return make_session(app, r, id);
             });
  router.add(Method::get, "/v1/sessions", "Sessions in the order of their ids, page by page",
             [&app](const Request& r) {
               const uint64_t limit = query_integer(r, "limit", 100, 1, 1000);
               const std::string_view after = r.query_value("page_token").value_or("");
               if (!after.empty() && !is_session_id(after))
                 throw Error(
                     "bad_request", "a page_token must come from the previous page",
                     {{"?page_token", "wrong_type", "not a valid page_token", "", "a session's id", "", ""}});
               json::array list;
               const auto ids = app.store.list(after, limit, r.caller);
               for (const std::string& id : ids)
                 list.push_back(json::object{{"id", id}, {"links", links_of(id)}});
               json::object o{{"sessions", std::move(list)}};
               if (ids.size() == limit) o["next_page_token"] = ids.back();
               return json_response(o);
             });
  router.add(Method::get, session,
             "One session: clock, status, systems, links; or the progress of its creation",
             [&app](const Request& r) { return describe(app, r); });
  router.add(Method::delete_, session, "Ends a session; its recordings are completed and stay",
             [&app](const Request& r) { return end(app, r); });
  router.add(
      Method::post, session + "/commands",
      "Push, impulse, drag, release, pin, unpin, set_parameter, spawn, remove; an array: all of them or none",
      [&app](const Request& r) { return command(app, r); });
  router.add(Method::get, session + "/scene",
             "The scene as it runs, with every default, in SI: as POST /v1/sessions and studies take it",
             [&app](const Request& r) {
               return with_session(app, r, [](SessionEntry& e) {
                 return json_response(e.session.world().scene().canonical());
               });
             });
  router.add(Method::get, session + "/plan",
             "Stages of a step with their share of time (of the steps since the first such request), and "
             "what was skipped and why",
             [&app](const Request& r) {
               return with_session(app, r, [](SessionEntry& e) {
                 e.profile_for(std::chrono::seconds(60));
                 return json_response(
                     json::object{{"passes", describe_plan(e.session.world(), e.session.profiles())}});
               });
             });
}

}  // namespace truestep
