#include "server/api/openapi.h"

#include "engine/base/version.h"
#include "engine/base/xml.h"
#include "engine/scene/json_write.h"
#include "engine/scene/params.h"
#include "engine/session/commands.h"
#include "engine/studies/study.h"
#include "server/net/problem.h"

namespace truestep {

namespace json = boost::json;

namespace {

struct QueryParameter {
  std::string_view route, name, type, description;
};

// What handlers read from the query, by route.
constexpr QueryParameter kQuery[] = {
    {"/v1/sessions", "limit", "integer", "sessions on a page, at most 1000"},
    {"/v1/sessions", "page_token", "string", "next_page_token of the page before"},
    {"/v1/sessions/{id}/frames", "after", "integer", "frames after this step; without it the newest"},
    {"/v1/sessions/{id}/frames", "limit", "integer", "frames in one answer, at most 1024"},
    {"/v1/sessions/{id}/frames", "wait", "number", "seconds to wait for a frame, at most 60"},
    {"/v1/sessions/{id}/frames", "fields", "string", "names, separated by commas; position if absent"},
    {"/v1/sessions/{id}/frames", "systems", "string", "ids, separated by commas; all if absent"},
    {"/v1/sessions/{id}/frames/{step}", "fields", "string", "names, separated by commas; position if absent"},
    {"/v1/sessions/{id}/frames/{step}", "systems", "string", "ids, separated by commas; all if absent"},
    {"/v1/sessions/{id}/observables", "names", "string", "names or their beginnings, separated by commas"},
    {"/v1/sessions/{id}/observables", "max_points", "integer", "points of a series at most"},
    {"/v1/sessions/{id}/picture.png", "camera", "string", "ex,ey,ez,tx,ty,tz in m"},
    {"/v1/sessions/{id}/picture.png", "width", "integer", "16 to 4096 pixels"},
    {"/v1/sessions/{id}/picture.png", "height", "integer", "16 to 4096 pixels"},
    {"/v1/sessions/{id}/picture.png", "show", "string", "contacts, joints or both, drawn over the bodies"},
    {"/v1/sessions/{id}/picture.png", "step", "integer", "an earlier step; the present one if absent"},
};

json::object number(const char* description, const char* type = "number") {
  return {{"type", type}, {"description", description}};
}

json::object reference(const char* name) {
  return {{"$ref", std::string("#/components/schemas/") + name}};
}

json::object body_schema(const net::Route& route) {
  const std::string& p = route.pattern;
  if (p == "/v1/sessions" || p == "/v1/sessions/{id}") {
    return {{"oneOf",
             json::array{json::object{{"$ref", "/v1/schemas/scene-1.json"}}, reference("GalleryChoice")}}};
  }
  if (p == "/v1/scenes/validate") return {{"$ref", "/v1/schemas/scene-1.json"}};
  if (p == "/v1/studies") return reference("StudyRequest");
  if (p.ends_with("/step")) return reference("StepRequest");
  if (p.ends_with("/play")) return reference("PlayRequest");
  if (p.ends_with("/seek")) return reference("SeekRequest");
  if (p.ends_with("/commands")) return reference("Command");
  return {};
}

// {"kind": ..., "scene" or "gallery", parameters}, one alternative per kind of study.
json::object study_schema() {
  json::array kinds;
  for (const StudyKind& k : study_kinds()) {
    json::object s = schema_of(k.table());
    json::object& properties = s["properties"].as_object();
    properties["kind"] = json::object{{"const", k.name}};
    properties["scene"] = json::object{{"$ref", "/v1/schemas/scene-1.json"}};
    properties["gallery"] = json::object{{"type", "string"}};
    properties["resume"] = json::object{{"type", "string"}, {"description", "a sweep to go on with"}};
    if (!s.contains("required")) s["required"] = json::array{};
    s["required"].as_array().emplace_back("kind");
    kinds.push_back(std::move(s));
  }
  return {{"oneOf", std::move(kinds)}};
}

json::object schemas() {
  json::array commands;
  for (const CommandType& t : command_types()) {
    json::object s = schema_of(*t.table);
    s["properties"].as_object()["type"] = json::object{{"const", t.name}};
    if (!s.contains("required")) s["required"] = json::array{};
    s["required"].as_array().emplace_back("type");
    commands.push_back(std::move(s));
  }
  return {
      {"Command", json::object{{"oneOf", std::move(commands)}}},
      {"StudyRequest", study_schema()},
      {"GalleryChoice",
       json::object{{"type", "object"},
                    {"properties", json::object{{"gallery", json::object{{"type", "string"}}}}},
                    {"required", json::array{"gallery"}},
                    {"additionalProperties", false}}},
      {"StepRequest",
       json::object{
           {"type", "object"},
           {"properties",
            json::object{{"steps", number("steps to do", "integer")},
                         {"seconds", number("simulated seconds to do")},
                         {"until", number("time to reach, s")},
                         {"from_step", number("refused unless the session is at this step", "integer")}}},
           {"additionalProperties", false}}},
      {"PlayRequest",
       json::object{{"type", "object"},
                    {"properties", json::object{{"speed", number("simulated seconds a second")}}}}},
      {"SeekRequest", json::object{{"type", "object"},
                                   {"properties", json::object{{"step", number("step to go to", "integer")},
                                                               {"time", number("time to go to, s")}}}}},
      {"Problem",
       json::object{{"type", "object"},
                    {"description", "RFC 9457"},
                    {"properties",
                     json::object{{"type", json::object{{"type", "string"}}},
                                  {"title", json::object{{"type", "string"}}},
                                  {"status", json::object{{"type", "integer"}}},
                                  {"code", json::object{{"type", "string"}}},
                                  {"detail", json::object{{"type", "string"}}},
                                  {"instance", json::object{{"type", "string"}}},
                                  {"trace_id", json::object{{"type", "string"}}},
                                  {"errors", json::object{{"type", "array"},
                                                          {"items", json::object{{"type", "object"}}}}}}},
                    {"required", json::array{"type", "title", "status", "code"}}}},
  };
}

std::string lower(std::string_view s) {
  std::string out(s);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return out;
}

// Viewer files are no part of the interface.
bool is_interface(const net::Route& r) {
  return r.summary != "A file of the viewer";
}

json::object operation(const net::Route& route) {
  json::array parameters;
  for (size_t at = route.pattern.find('{'); at != std::string::npos; at = route.pattern.find('{', at + 1)) {
    const size_t end = route.pattern.find('}', at);
    parameters.push_back(json::object{{"name", route.pattern.substr(at + 1, end - at - 1)},
                                      {"in", "path"},
                                      {"required", true},
                                      {"schema", json::object{{"type", "string"}}}});
  }
  if (route.method == net::Method::get) {
    for (const QueryParameter& q : kQuery) {
      if (q.route == route.pattern) {
        parameters.push_back(json::object{{"name", q.name},
                                          {"in", "query"},
                                          {"description", q.description},
                                          {"schema", json::object{{"type", q.type}}}});
      }
    }
  }
  json::object o{{"summary", route.summary}};
  if (!parameters.empty()) o["parameters"] = std::move(parameters);
  if (json::object schema = body_schema(route); !schema.empty()) {
    o["requestBody"] = json::object{
        {"content", json::object{{"application/json", json::object{{"schema", std::move(schema)}}}}}};
  }
  o["responses"] = json::object{
      {route.open_websocket ? "101" : "2XX",
       json::object{{"description", route.open_websocket ? "the stream begins" : "done"}}},
      {"default", json::object{{"description", "a problem"},
                               {"content", json::object{{"application/problem+json",
                                                         json::object{{"schema", reference("Problem")}}}}}}}};
  return o;
}

std::string docs_page(const net::Router& router) {
  std::string page =
      "<!doctype html><html lang=en><meta charset=utf-8><title>Truestep API</title><style>body{font:16px/1.5 "
      "system-ui,sans-serif;max-width:60rem;"
      "margin:2rem auto;padding:0 1rem;color:#1c2430}td{padding:.25rem .75rem .25rem "
      "0;vertical-align:top}code{background:#eef1f5;padding:.1rem .3rem;"
      "border-radius:.2rem}</style><h1>Truestep API</h1><p>Machine-readable: <a "
      "href=/openapi.json>openapi.json</a>, <a href=/v1/schemas/scene-1.json>scene "
      "schema</a>. Errors are <code>application/problem+json</code> with a stable <code>code</code>.<table>";
  for (const net::Route& r : router.rows()) {
    if (!is_interface(r)) continue;
    page += "<tr><td><code>" + std::string(r.open_websocket ? "WS" : net::method_name(r.method)) +
            "</code><td><code>" + escaped_xml(r.pattern) + "</code><td>" + escaped_xml(r.summary);
  }
  page += "</table><h2>Codes</h2><table>";
  for (const net::ProblemKind& k : net::problem_kinds()) {
    page += "<tr><td><code>" + std::string(k.code) + "</code><td>" + std::to_string(k.status) + "<td>" +
            escaped_xml(k.title);
  }
  return page + "</table>";
}

}  // namespace

json::object openapi_document(const net::Router& router) {
  json::object paths;
  for (const net::Route& r : router.rows()) {
    if (!is_interface(r)) continue;
    json::value& path = paths[r.pattern];
    if (!path.is_object()) path = json::object{};
    path.as_object()[lower(net::method_name(r.method))] = operation(r);
  }
  return {{"openapi", "3.1.0"},
          {"info", json::object{{"title", "Truestep"},
                                {"version", version()},
                                {"description", "Physics simulation sessions over HTTP and WebSocket."}}},
          {"paths", std::move(paths)},
          {"components",
           json::object{{"schemas", schemas()},
                        {"securitySchemes",
                         json::object{{"key", json::object{{"type", "http"}, {"scheme", "bearer"}}}}}}}};
}

void add_description_routes(net::Router& router) {
  auto document = std::make_shared<net::SharedBuffer>();
  auto page = std::make_shared<net::SharedBuffer>();
  router
      .add(net::Method::get, "/openapi.json", "This description as OpenAPI 3.1",
           [document](const net::Request&) { return net::Response::shared(*document, "application/json"); })
      .access = net::Access::open;
  router
      .add(net::Method::get, "/docs", "This description as a page",
           [page](const net::Request&) { return net::Response::shared(*page, "text/html; charset=utf-8"); })
      .access = net::Access::open;
  *document = std::make_shared<const std::string>(write_json(openapi_document(router)));
  *page = std::make_shared<const std::string>(docs_page(router));
}

}  // namespace truestep
