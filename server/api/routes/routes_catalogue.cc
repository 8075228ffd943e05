// What the service can do: systems, schema, gallery, validation.
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/describe.h"
#include "server/api/requests.h"

namespace truestep {

namespace json = boost::json;
using net::Method;
using net::Request;
using net::Response;

void add_catalogue_routes(net::Router& router, App& app) {
  router.add(Method::get, "/v1/systems", "The kinds of systems a scene can hold", [](const Request&) {
    return json_response(json::object{{"systems", describe_systems()}});
  });
  router.add(Method::get, "/v1/systems/{type}", "One kind: parameters, integrators, guarantees, cost",
             [](const Request& r) {
               const CatalogueRow* row = find_system_type(r.param("type"));
               if (!row) throw Error("not_found", "there is no such system type");
               return json_response(describe_system(*row));
             });
  router.add(Method::get, "/v1/schemas/scene-1.json", "JSON Schema of a scene, from the parameter tables",
             [](const Request&) {
               static const auto kSchema = std::make_shared<const std::string>(write_json(scene_schema()));
               return Response::shared(kSchema, "application/schema+json");
             });
  router.add(Method::get, "/v1/gallery", "Scenes that teach something", [](const Request&) {
    static const auto kList =
        std::make_shared<const std::string>(write_json(json::object{{"scenes", describe_gallery()}}));
    return Response::shared(kList, "application/json");
  });
  router.add(Method::get, "/v1/gallery/{name}", "One gallery scene with what it teaches and what to expect",
             [](const Request& r) {
               const GalleryScene* g = find_gallery_scene(r.param("name"));
               if (!g) throw Error("not_found", "the gallery has no such scene");
               const json::value scene = parse_json(g->text);
               json::object o{{"name", g->name}};
               for (const char* key : {"title", "teaches", "tags", "expect"}) {
                 if (const json::value* v = scene.as_object().if_contains(key)) o[key] = *v;
               }
               o["scene"] = scene;
               return json_response(o);
             });
  router.add(Method::post, "/v1/scenes/validate", "Errors, warnings, plan and cost of a scene",
             [&app](const Request& r) -> Task<Response> {
               auto validate = [&app](json::value document) {
                 const auto lease = app.assets.resolve(document, app.memory);
                 const json::object report = validate_scene(document, app.options.limits.per_session);
                 return json_response(report, report.at("valid").as_bool() ? 200 : 422);
               };
               const auto lease = body_lease(app, r);
               auto work = [&] { return validate(json_body(r)); };
               co_return co_await app.runner.long_work(std::move(work), kReadingTime);
             });
}

}  // namespace truestep
