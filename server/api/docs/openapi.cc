#include "server/api/docs/openapi.h"

#include "engine/base/version.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "server/api/docs/docs_page.h"
#include "server/api/docs/openapi_tables.h"
#include "server/api/stream_proto.h"

namespace truestep {

namespace json = boost::json;

json::object schema_reference(std::string_view name) {
  return {{"$ref", "#/components/schemas/" + std::string(name)}};
}

bool is_interface(const net::Route& r) {
  return r.summary != kViewerFile;
}

namespace {

std::string lower(std::string_view s) {
  std::string out(s);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return out;
}

// "post /v1/sessions/{id}/step" becomes post_sessions_id_step.
std::string operation_id(const net::Route& route) {
  std::string out = lower(net::method_name(route.method));
  std::string_view rest = route.pattern;
  if (rest.starts_with("/v1/")) rest.remove_prefix(3);
  for (const char c : rest) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (plain) {
      out += c;
    } else if (out.back() != '_' && c != '}') {
      out += '_';
    }
  }
  if (out.back() == '_') out.pop_back();
  return out;
}

json::value parsed(std::string_view text) {
  return parse_json(text);
}

json::array parameters(const net::Route& route) {
  json::array out;
  for (size_t at = route.pattern.find('{'); at != std::string::npos; at = route.pattern.find('{', at + 1)) {
    const size_t end = route.pattern.find('}', at);
    const std::string name = route.pattern.substr(at + 1, end - at - 1);
    out.push_back(json::object{{"name", name},
                               {"in", "path"},
                               {"required", true},
                               {"schema", parsed(path_parameter_schema(route.pattern, name))}});
  }
  for (const RouteParameter& p : route_parameters()) {
    if (p.method != route.method || p.pattern != route.pattern) continue;
    out.push_back(json::object{
        {"name", p.name}, {"in", p.in}, {"description", p.description}, {"schema", parsed(p.schema)}});
  }
  return out;
}

json::object responses(const net::Route& route) {
  json::object out;
  for (const RouteAnswer& a : answers_of(route)) {
    json::value& answer = out[std::to_string(a.status)];
    if (!answer.is_object()) answer = json::object{{"description", a.description}};
    if (a.status == 201 || a.status == 202) {
      answer.as_object()["headers"] =
          json::object{{"Location", json::object{{"description", "of the new resource"},
                                                 {"schema", json::object{{"type", "string"}}}}}};
    }
    if (a.media.empty()) continue;
    json::value& content = answer.as_object()["content"];
    if (!content.is_object()) content = json::object{};
    content.as_object()[a.media] =
        a.schema.empty() ? json::object{} : json::object{{"schema", schema_reference(a.schema)}};
  }
  if (out.empty()) out["2XX"] = json::object{{"description", "done"}};
  const json::object problem{
      {"application/problem+json", json::object{{"schema", schema_reference("Problem")}}}};
  out["default"] = json::object{{"description", "a problem"}, {"content", problem}};
  // A status that has an answer of its own may also be a problem.
  for (auto& [status, answer] : out) {
    if (status[0] == '4')
      answer.as_object()["content"].as_object()["application/problem+json"] = problem.begin()->value();
  }
  return out;
}

json::object operation(const net::Route& route, const ServiceDescription& service) {
  json::object o{{"operationId", operation_id(route)}, {"summary", route.summary}};
  if (route.open_websocket) {
    o["description"] =
        "A WebSocket with the subprotocols truestep.v1.proto and truestep.v1.json. A message from "
        "the client of more than " +
        std::to_string(service.max_message) +
        " bytes (option --max-message) closes it with 1009; the server's own messages have no bound.";
  }
  if (service.keys && route.access == net::Access::open) o["security"] = json::array{};
  if (json::array all = parameters(route); !all.empty()) o["parameters"] = std::move(all);
  if (json::object body = body_of(route); !body.empty()) {
    o["requestBody"] = json::object{{"required", body_is_required(route)}, {"content", std::move(body)}};
  }
  o["responses"] = responses(route);
  return o;
}

}  // namespace

json::object openapi_document(const net::Router& router, const ServiceDescription& service) {
  json::object paths;
  for (const net::Route& r : router.rows()) {
    if (!is_interface(r)) continue;
    json::value& path = paths[r.pattern];
    if (!path.is_object()) path = json::object{};
    path.as_object()[lower(net::method_name(r.method))] = operation(r, service);
  }
  json::object schemas = answer_schemas();
  for (auto& [name, schema] : body_schemas()) schemas[name] = std::move(schema);
  json::object out{
      {"openapi", "3.1.0"},
      {"info", json::object{{"title", "Truestep"},
                            {"version", version()},
                            {"description", "Physics simulation sessions over HTTP and WebSocket."}}},
      {"paths", std::move(paths)}};
  json::object components{{"schemas", std::move(schemas)}};
  if (service.keys) {
    components["securitySchemes"] =
        json::object{{"key", json::object{{"type", "http"}, {"scheme", "bearer"}}}};
    out["security"] = json::array{json::object{{"key", json::array{}}}};
  }
  out["components"] = std::move(components);
  return out;
}

void add_description_routes(net::Router& router, const ServiceDescription& service) {
  auto document = std::make_shared<net::SharedBuffer>();
  auto page = std::make_shared<net::SharedBuffer>();
  router
      .add(net::Method::get, "/openapi.json", "This description as OpenAPI 3.1",
           [document](const net::Request&) { return net::Response::shared(*document, "application/json"); })
      .access = net::Access::open;
  router
      .add(net::Method::get, "/docs", "This description as a page",
           [page](const net::Request&) {
             net::Response r = net::Response::shared(*page, "text/html; charset=utf-8");
             r.header("Content-Security-Policy",
                      "default-src 'none'; style-src 'unsafe-inline'; img-src 'self' data:; base-uri 'none'; "
                      "form-action 'none'; frame-ancestors 'self'");
             r.header("X-Content-Type-Options", "nosniff");
             return r;
           })
      .access = net::Access::open;
  static const auto kProto = std::make_shared<const std::string>(stream_proto());
  router
      .add(net::Method::get, "/v1/schemas/stream.proto", "The stream's messages as protobuf 3",
           [](const net::Request&) { return net::Response::shared(kProto, "text/plain; charset=utf-8"); })
      .access = net::Access::open;
  *document = std::make_shared<const std::string>(write_json(openapi_document(router, service)));
  *page = std::make_shared<const std::string>(docs_page(router));
}

}  // namespace truestep
