// What routes read: path, query, headers and bodies.
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/scene/params/params.h"
#include "engine/scene/scene.h"
#include "engine/session/commands.h"
#include "engine/session/queries/queries.h"
#include "engine/studies/study.h"
#include "server/api/docs/openapi_tables.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr std::string_view kIdempotency = R"({"type": "string", "pattern": "^[!-~]{1,255}$"})";
constexpr std::string_view kNames = R"({"type": "string", "pattern": "^[^\\u0000-\\u001f\\u007f]*$"})";
constexpr std::string_view kPixels = R"({"type": "integer", "minimum": 16, "maximum": 4096})";
constexpr std::string_view kColor = R"({"type": "string", "pattern": "^[a-z_]{0,64}$"})";
constexpr std::string_view kFrameRate =
    R"({"type": "number", "minimum": 0.01, "maximum": 10000, "default": 30})";
constexpr std::string_view kSeconds = R"({"type": "number", "minimum": 0, "maximum": 1e18})";
constexpr std::string_view kLastSeconds = "of motion up to the present; all if absent";
constexpr std::string_view kMotionSystem =
    "id of a system; the first with joints or blended shapes if absent";
constexpr std::string_view kOnce =
    "key of a request that must not be done twice: the same key gets the same answer";
constexpr std::string_view kFields = "names, separated by commas; position if absent";
constexpr std::string_view kSystems = "ids, separated by commas; all if absent";

constexpr RouteParameter kParameters[] = {
    {net::Method::post, "/v1/sessions", "header", "Idempotency-Key", kIdempotency, kOnce},
    {net::Method::post, "/v1/sessions/{id}/step", "header", "Idempotency-Key", kIdempotency, kOnce},
    {net::Method::post, "/v1/sessions/{id}/branch", "header", "Idempotency-Key", kIdempotency, kOnce},
    {net::Method::post, "/v1/studies", "header", "Idempotency-Key", kIdempotency, kOnce},
    {net::Method::post, "/v1/runs", "header", "Idempotency-Key", kIdempotency, kOnce},
    {net::Method::get, "/v1/sessions", "query", "limit",
     R"({"type": "integer", "minimum": 1, "maximum": 1000, "default": 100})", "sessions per page"},
    {net::Method::get, "/v1/sessions", "query", "page_token",
     R"({"type": "string", "pattern": "^([0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12})?$"})",
     "next_page_token of the previous page"},
    {net::Method::get, "/v1/recordings", "query", "limit",
     R"({"type": "integer", "minimum": 1, "maximum": 1000, "default": 100})", "recordings per page"},
    {net::Method::get, "/v1/recordings", "query", "page_token",
     R"({"type": "string", "pattern": "^([0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}([.]([2-9]|[1-9][0-9]{1,8}))?)?$"})",
     "next_page_token of the previous page"},
    {net::Method::get, "/v1/sessions/{id}/frames", "query", "after",
     R"({"type": "integer", "minimum": 0, "maximum": 9000000000000000})",
     "frames after this step; without it the newest"},
    {net::Method::get, "/v1/sessions/{id}/frames", "query", "limit",
     R"({"type": "integer", "minimum": 1, "maximum": 1024, "default": 16})", "most frames in one answer"},
    {net::Method::get, "/v1/sessions/{id}/frames", "query", "wait",
     R"({"type": "number", "minimum": 0, "maximum": 60, "default": 0})", "seconds to wait for a frame"},
    {net::Method::get, "/v1/sessions/{id}/frames", "query", "fields", kNames, kFields},
    {net::Method::get, "/v1/sessions/{id}/frames", "query", "systems", kNames, kSystems},
    {net::Method::get, "/v1/sessions/{id}/frames/{step}", "query", "fields", kNames, kFields},
    {net::Method::get, "/v1/sessions/{id}/frames/{step}", "query", "systems", kNames, kSystems},
    {net::Method::get, "/v1/sessions/{id}/observables", "query", "names", kNames,
     "names or their beginnings, separated by commas"},
    {net::Method::get, "/v1/sessions/{id}/observables", "query", "max_points",
     R"({"type": "integer", "minimum": 1, "maximum": 1000000, "default": 4096})", "most points of a series"},
    {net::Method::get, "/v1/sessions/{id}/motion.bvh", "query", "system", kNames, kMotionSystem},
    {net::Method::get, "/v1/sessions/{id}/motion.bvh", "query", "rate", kFrameRate, "frames a second"},
    {net::Method::get, "/v1/sessions/{id}/motion.bvh", "query", "seconds", kSeconds, kLastSeconds},
    {net::Method::get, "/v1/sessions/{id}/motion.gltf", "query", "system", kNames, kMotionSystem},
    {net::Method::get, "/v1/sessions/{id}/motion.gltf", "query", "rate", kFrameRate, "frames a second"},
    {net::Method::get, "/v1/sessions/{id}/motion.gltf", "query", "seconds", kSeconds, kLastSeconds},
    {net::Method::get, "/v1/sessions/{id}/motion.glb", "query", "system", kNames, kMotionSystem},
    {net::Method::get, "/v1/sessions/{id}/motion.glb", "query", "rate", kFrameRate, "frames a second"},
    {net::Method::get, "/v1/sessions/{id}/motion.glb", "query", "seconds", kSeconds, kLastSeconds},
    {net::Method::get, "/v1/sessions/{id}/picture.png", "query", "camera",
     R"({"type": "string", "pattern": "^(all|front|side|top|(-?[0-9]{1,6}([.][0-9]{1,6})?,){5}-?[0-9]{1,6}([.][0-9]{1,6})?)$"})",
     "ex,ey,ez,tx,ty,tz in m; or a view of everything drawn, obliquely (all), from the front, the side or "
     "the top"},
    {net::Method::get, "/v1/sessions/{id}/picture.png", "query", "width", kPixels, "pixels; 800 if absent"},
    {net::Method::get, "/v1/sessions/{id}/picture.png", "query", "height", kPixels, "pixels; 600 if absent"},
    {net::Method::get, "/v1/sessions/{id}/picture.png", "query", "size",
     R"({"type": "string", "pattern": "^[1-3][0-9]{2,3}x[1-3][0-9]{2,3}$"})",
     "WIDTHxHEIGHT in pixels, instead of width and height"},
    {net::Method::get, "/v1/sessions/{id}/picture.png", "query", "color_by", kColor,
     "field that colours points, bodies, lines, triangles, joints or a grid; empty: none; the scene's own if "
     "absent"},
    {net::Method::get, "/v1/sessions/{id}/picture.png", "query", "theme",
     R"({"enum": ["light", "dark"], "default": "light"})", "of the background"},
    {net::Method::get, "/v1/sessions/{id}/picture.png", "query", "show",
     R"({"enum": ["contacts", "joints", "contacts,joints"]})", "drawn over the bodies"},
    {net::Method::get, "/v1/sessions/{id}/picture.png", "query", "step",
     R"({"type": "integer", "minimum": 0, "maximum": 9000000000000000})",
     "an earlier step; the present one if absent"},
};

constexpr std::string_view kRequests = R"json({
  "StepRequest": {"type": "object", "additionalProperties": false,
    "properties": {
      "steps": {"type": "integer", "minimum": 0, "maximum": 1000000000, "description": "steps to do"},
      "seconds": {"type": "number", "minimum": 0, "maximum": 1e9, "description": "simulated seconds to do"},
      "until": {"type": "number", "minimum": 0, "maximum": 1e9, "description": "time to reach, s"},
      "from_step": {"type": "integer", "minimum": 0, "maximum": 9000000000000000,
        "description": "refused unless the session is at this step"},
      "commands": {"type": "array", "maxItems": 1000, "items": {"$ref": "#/components/schemas/Command"},
        "description": "carried out before the steps: all, or none"},
      "observe": {"type": "array", "maxItems": 256, "items": {"type": "string"},
        "description": "observables after the steps: names or their beginnings up to a dot; all if empty"},
      "fields": {"type": "array", "maxItems": 256, "items": {"type": "string"},
        "description": "fields after the steps; positions if empty"},
      "systems": {"type": "array", "maxItems": 256, "items": {"type": "string"},
        "description": "of whose parts the fields are; all if absent"},
      "queries": {"type": "array", "maxItems": 100, "items": {"$ref": "#/components/schemas/Query"},
        "description": "answered after the steps"}},
    "dependentRequired": {"systems": ["fields"]},
    "oneOf": [{"required": ["steps"]}, {"required": ["seconds"]}, {"required": ["until"]},
      {"not": {"anyOf": [{"required": ["steps"]}, {"required": ["seconds"]}, {"required": ["until"]}]}}]},
  "PlayRequest": {"type": "object", "additionalProperties": false,
    "properties": {"speed": {"type": "number", "minimum": 1e-18, "maximum": 1e15, "default": 1,
      "description": "simulated seconds a second"},
      "keep_running": {"type": "boolean", "default": false, "description": "go on when the last viewer has left"}}},
  "RunRequest": {"type": "object", "additionalProperties": false,
    "properties": {"scene": {"$ref": "/v1/schemas/scene-1.json"}, "gallery": {"$ref": "#/components/schemas/GalleryName"},
      "duration": {"type": "number", "exclusiveMinimum": 0, "description": "s; the scene's if absent"},
      "observables": {"type": "array", "maxItems": 64, "items": {"type": "string"},
        "description": "names or their beginnings up to a dot; all if absent"},
      "max_points": {"type": "integer", "minimum": 2, "maximum": 100000, "default": 2000}},
    "oneOf": [{"required": ["scene"]}, {"required": ["gallery"]}]},
  "SeekRequest": {"oneOf": [
    {"type": "object", "additionalProperties": false, "required": ["step"],
      "properties": {"step": {"type": "integer", "minimum": 0, "maximum": 1000000000}}},
    {"type": "object", "additionalProperties": false, "required": ["time"],
      "properties": {"time": {"type": "number", "minimum": 0, "maximum": 1e9, "description": "s"}}}]},
  "Nothing": {"type": "object", "additionalProperties": false}
})json";

// {"kind": ..., "scene" or "gallery", parameters}, one alternative per kind of study.
json::object study_schema() {
  json::array kinds;
  for (const StudyKind& k : study_kinds()) {
    json::object s = schema_of(k.table());
    json::object& properties = s["properties"].as_object();
    properties["kind"] = json::object{{"const", k.name}};
    properties["scene"] = json::object{{"$ref", "/v1/schemas/scene-1.json"}};
    properties["gallery"] = schema_reference("GalleryName");
    properties["resume"] = json::object{{"type", "string"}, {"description", "a sweep to resume"}};
    if (!s.contains("required")) s["required"] = json::array{};
    s["required"].as_array().emplace_back("kind");
    s["oneOf"] = json::array{json::object{{"required", json::array{"scene"}}},
                             json::object{{"required", json::array{"gallery"}}}};
    kinds.push_back(std::move(s));
  }
  return {{"oneOf", std::move(kinds)}};
}

// {"type": ..., parameters}, one alternative per type.
template <class Types>
json::object typed_schema(const Types& types) {
  json::array commands;
  for (const auto& t : types) {
    json::object s = schema_of(*t.table);
    json::object& members = s["properties"].as_object();
    members["type"] = json::object{{"const", t.name}};
    if (json::value* row = members.if_contains("index")) {
      json::value description = row->as_object()["description"];
      *row = json::object{
          {"oneOf", json::array{std::move(*row),
                                json::object{{"type", "string"}, {"maxLength", 64}, {"description", "id"}}}},
          {"description", std::move(description)}};
    }
    if (!s.contains("required")) s["required"] = json::array{};
    s["required"].as_array().emplace_back("type");
    commands.push_back(std::move(s));
  }
  return {{"oneOf", std::move(commands)}};
}

json::object one_or_more(std::string_view schema) {
  return {{"oneOf",
           json::array{
               schema_reference(schema),
               json::object{{"type", "array"}, {"maxItems", 1000}, {"items", schema_reference(schema)}}}}};
}

}  // namespace

std::span<const RouteParameter> route_parameters() {
  return kParameters;
}

std::string_view path_parameter_schema(std::string_view pattern, std::string_view name) {
  if (name == "id") return R"({"$ref": "#/components/schemas/Id"})";
  if (name == "rid") return R"({"$ref": "#/components/schemas/RecordingId"})";
  if (name == "step") return R"({"type": "string", "pattern": "^(latest|[0-9]{1,15})$"})";
  if (name == "sha256") return R"({"type": "string", "pattern": "^[0-9a-f]{64}$"})";
  if (name == "sid") return R"({"type": "string", "pattern": "^(step-[0-9]{1,16}|upload-[0-9a-f]{16})$"})";
  if (name == "name" && pattern.starts_with("/v1/gallery/"))
    return R"({"$ref": "#/components/schemas/GalleryName"})";
  return R"({"type": "string", "pattern": "^[a-z0-9_]+$"})";
}

json::object body_of(const net::Route& route) {
  const auto as_json = [](json::object schema) {
    return json::object{{"application/json", json::object{{"schema", std::move(schema)}}}};
  };
  if (route.method != net::Method::post && route.method != net::Method::put) return {};
  const std::string_view p = route.pattern;
  const json::object scene{{"$ref", "/v1/schemas/scene-1.json"}};
  if (p == "/v1/sessions" || p == "/v1/sessions/{id}")
    return as_json({{"oneOf", json::array{scene, schema_reference("GalleryChoice")}}});
  if (p == "/v1/scenes/validate") return as_json(scene);
  if (p == "/v1/runs") return as_json(schema_reference("RunRequest"));
  if (p.ends_with("/queries")) return as_json(one_or_more("Query"));
  if (p == "/v1/studies") return as_json(schema_reference("StudyRequest"));
  if (p.ends_with("/step")) return as_json(schema_reference("StepRequest"));
  if (p.ends_with("/play")) return as_json(schema_reference("PlayRequest"));
  if (p.ends_with("/seek")) return as_json(schema_reference("SeekRequest"));
  if (p == "/v1/sessions/{id}/recording") return as_json(schema_reference("RecordingRequest"));
  if (p.ends_with("/commands")) return as_json(one_or_more("Command"));
  const bool asset = p == "/v1/assets/{sha256}";
  json::object media = as_json(schema_reference(asset ? "Value" : "Nothing"));
  if (asset || p.ends_with("/snapshots")) media["application/octet-stream"] = json::object{};
  return media;
}

bool body_is_required(const net::Route& route) {
  for (const std::string_view end : {"/sessions", "/sessions/{id}", "/validate", "/studies", "/seek",
                                     "/commands", "/runs", "/queries", "/assets/{sha256}"}) {
    if (route.pattern.ends_with(end)) return true;
  }
  return false;
}

json::object body_schemas() {
  json::object out = parse_json(kRequests).as_object();
  json::array names;
  for (const GalleryScene& g : gallery()) names.emplace_back(g.name);
  out["GalleryName"] = json::object{{"enum", std::move(names)}};
  out["GalleryChoice"] =
      json::object{{"type", "object"},
                   {"properties", json::object{{"gallery", schema_reference("GalleryName")}}},
                   {"required", json::array{"gallery"}},
                   {"additionalProperties", false}};
  out["StudyRequest"] = study_schema();
  // Requests take no keys of the user's own, as scenes do.
  json::object recording = schema_of(*scene_table().find("recording")->nested);
  recording.erase("patternProperties");
  recording["additionalProperties"] = false;
  out["RecordingRequest"] = std::move(recording);
  out["Command"] = typed_schema(command_types());
  out["Query"] = typed_schema(query_types());
  return out;
}

}  // namespace truestep
