// What the HTTP description says of answers: which statuses a route has when all is well, in which media
// types and with which schemas.
#include <algorithm>

#include "engine/scene/json.h"
#include "server/api/openapi_tables.h"

namespace truestep {

namespace json = boost::json;

namespace {

using M = net::Method;
constexpr std::string_view kJson = "application/json", kProtobuf = "application/x-protobuf",
                           kBytes = "application/octet-stream", kPng = "image/png",
                           kCsv = "text/csv; charset=utf-8", kHtml = "text/html; charset=utf-8";

// By pattern, so that the answers of a route stand together.
constexpr RouteAnswer kAnswers[] = {
    {M::get, "/", 200, kHtml, "", "the viewer"},
    {M::get, "/docs", 200, kHtml, "", "a page"},
    {M::get, "/healthz", 200, kJson, "Health", "the process answers"},
    {M::get, "/metrics", 200, "text/plain; version=0.0.4; charset=utf-8", "", "counters and gauges"},
    {M::get, "/openapi.json", 200, kJson, "Anything", "OpenAPI 3.1"},
    {M::get, "/readyz", 200, kJson, "Health", "new sessions are welcome"},
    {M::get, "/v1/gallery", 200, kJson, "Gallery", "all scenes"},
    {M::get, "/v1/gallery/{name}", 200, kJson, "GalleryScene", "one scene"},
    {M::get, "/v1/gallery/{name}/picture.png", 200, kPng, "", "a picture"},
    {M::get, "/v1/operations", 200, kJson, "Operations", "all operations"},
    {M::get, "/v1/operations/{id}", 200, kJson, "Operation", "state and progress"},
    {M::delete_, "/v1/operations/{id}", 204, "", "", "it is forgotten"},
    {M::post, "/v1/operations/{id}/cancel", 200, kJson, "Operation", "it stops soon"},
    {M::get, "/v1/operations/{id}/events", 200, "text/event-stream", "", "progress, then the end"},
    {M::get, "/v1/operations/{id}/result", 200, kJson, "StudyResult", "table, plot and summary"},
    {M::get, "/v1/operations/{id}/result.csv", 200, kCsv, "", "the table"},
    {M::get, "/v1/operations/{id}/result.json", 200, kJson, "StudyResult", "table, plot and summary"},
    {M::get, "/v1/operations/{id}/result.svg", 200, "image/svg+xml", "", "the plot"},
    {M::post, "/v1/scenes/validate", 200, kJson, "Validation", "the scene is valid"},
    {M::post, "/v1/scenes/validate", 422, kJson, "Validation", "the scene has faults"},
    {M::get, "/v1/schemas/scene-1.json", 200, "application/schema+json", "Anything", "JSON Schema 2020-12"},
    {M::get, "/v1/sessions", 200, kJson, "SessionPage", "a page of sessions"},
    {M::post, "/v1/sessions", 201, kJson, "Session", "the session is made"},
    {M::put, "/v1/sessions/{id}", 201, kJson, "Session", "the session is made"},
    {M::put, "/v1/sessions/{id}", 200, kJson, "Session", "it was made before, from the same scene"},
    {M::get, "/v1/sessions/{id}", 200, kJson, "Session", "the session"},
    {M::delete_, "/v1/sessions/{id}", 204, "", "", "it is gone"},
    {M::post, "/v1/sessions/{id}/branch", 201, kJson, "Session", "the new session"},
    {M::get, "/v1/sessions/{id}/bundle", 200, kBytes, "", "a file for `truestep replay`"},
    {M::post, "/v1/sessions/{id}/commands", 202, kJson, "CommandTaken", "it counts from this step on"},
    {M::get, "/v1/sessions/{id}/frames", 200, kJson, "Frames", "frames, oldest first"},
    {M::get, "/v1/sessions/{id}/frames", 200, kProtobuf, "", "the first frame, truestep.v1.Frame"},
    {M::get, "/v1/sessions/{id}/frames", 204, "", "", "none yet"},
    {M::get, "/v1/sessions/{id}/frames/{step}", 200, kJson, "Frame", "the frame"},
    {M::get, "/v1/sessions/{id}/frames/{step}", 200, kProtobuf, "", "the frame, truestep.v1.Frame"},
    {M::get, "/v1/sessions/{id}/observables", 200, kJson, "Observables", "latest values and series"},
    {M::get, "/v1/sessions/{id}/observables", 200, kCsv, "", "the series, a row each"},
    {M::post, "/v1/sessions/{id}/pause", 200, kJson, "Clock", "it stands"},
    {M::get, "/v1/sessions/{id}/picture.png", 200, kPng, "", "a picture"},
    {M::get, "/v1/sessions/{id}/plan", 200, kJson, "Plan", "passes of a step"},
    {M::post, "/v1/sessions/{id}/play", 200, kJson, "Clock", "it runs"},
    {M::get, "/v1/sessions/{id}/recording", 200, "application/x-hdf5", "", "the file"},
    {M::get, "/v1/sessions/{id}/recording", 206, "application/x-hdf5", "", "the part that Range asks for"},
    {M::post, "/v1/sessions/{id}/recording/finish", 200, kJson, "RecordingFinished", "it can be downloaded"},
    {M::post, "/v1/sessions/{id}/reset", 200, kJson, "Clock", "step 0"},
    {M::get, "/v1/sessions/{id}/scene", 200, kJson, "Anything", "a scene, as the schema of scenes says"},
    {M::post, "/v1/sessions/{id}/seek", 200, kJson, "Clock", "where it was wanted"},
    {M::get, "/v1/sessions/{id}/snapshots", 200, kJson, "Snapshots", "all snapshots"},
    {M::post, "/v1/sessions/{id}/snapshots", 201, kJson, "Snapshot", "the snapshot is kept"},
    {M::get, "/v1/sessions/{id}/snapshots/{sid}", 200, kBytes, "", "the snapshot's file"},
    {M::post, "/v1/sessions/{id}/snapshots/{sid}/restore", 200, kJson, "Clock", "the snapshot's step"},
    {M::post, "/v1/sessions/{id}/step", 200, kJson, "Clock", "the steps are done"},
    {M::get, "/v1/sessions/{id}/stream", 101, "", "", "the stream begins"},
    {M::get, "/v1/studies", 200, kJson, "StudyKinds", "all kinds"},
    {M::post, "/v1/studies", 202, kJson, "Operation", "the study is on its way"},
    {M::get, "/v1/systems", 200, kJson, "SystemKinds", "all kinds"},
    {M::get, "/v1/systems/{type}", 200, kJson, "SystemKind", "one kind"},
    {M::get, "/version", 200, kJson, "Version", "version and build"},
};

// `id` is a UUID and `hash` 16 hexadecimal digits wherever they stand.
constexpr std::string_view kSchemas = R"json({
  "Anything": {"type": "object"},
  "Health": {"type": "object", "properties": {"status": {"const": "ok"}}, "required": ["status"]},
  "Version": {"type": "object", "required": ["name", "version", "build", "api"],
    "properties": {"name": {"type": "string"}, "version": {"type": "string"}, "build": {"type": "string"},
      "api": {"type": "string"}}},
  "Id": {"type": "string", "pattern": "^[0-9a-f]{8}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{12}$"},
  "Hash": {"type": "string", "pattern": "^[0-9a-f]{16}$"},
  "Step": {"type": "integer", "minimum": 0},
  "Links": {"type": "object", "additionalProperties": {"type": "string"}, "required": ["self"]},
  "Status": {"enum": ["playing", "paused", "unstable"]},
  "Field": {"type": "object", "required": ["name", "unit", "width"],
    "properties": {"name": {"type": "string"}, "unit": {"type": "string"}, "width": {"type": "integer", "minimum": 1},
      "type": {"enum": ["f64", "f32", "i32", "u32", "u64"]}}},
  "Session": {"type": "object",
    "required": ["id", "name", "step", "first_step", "time", "dt", "status", "speed", "state_hash", "systems", "links"],
    "properties": {"id": {"$ref": "#/components/schemas/Id"}, "name": {"type": "string"},
      "step": {"$ref": "#/components/schemas/Step"},
      "first_step": {"description": "the earliest that can be gone back to", "$ref": "#/components/schemas/Step"},
      "time": {"type": "number", "minimum": 0}, "dt": {"type": "number", "exclusiveMinimum": 0},
      "status": {"$ref": "#/components/schemas/Status"}, "speed": {"type": "number", "exclusiveMinimum": 0},
      "skipped_steps": {"type": "integer", "minimum": 0}, "frames_built": {"type": "integer", "minimum": 0},
      "state_hash": {"$ref": "#/components/schemas/Hash"}, "title": {"type": "string"}, "teaches": {"type": "string"},
      "systems": {"type": "array", "items": {"type": "object", "required": ["id", "type", "fields"],
        "properties": {"id": {"type": "string"}, "type": {"type": "string"},
          "fields": {"type": "array", "items": {"$ref": "#/components/schemas/Field"}}}}},
      "viewer": {"type": "object"}, "instability": {"type": "object"}, "accuracy": {"type": "object"},
      "links": {"$ref": "#/components/schemas/Links"}}},
  "SessionPage": {"type": "object", "required": ["sessions"],
    "properties": {"next_page_token": {"type": "string"},
      "sessions": {"type": "array", "items": {"type": "object", "required": ["id", "links"],
        "properties": {"id": {"$ref": "#/components/schemas/Id"}, "links": {"$ref": "#/components/schemas/Links"}}}}}},
  "Clock": {"type": "object", "required": ["id", "step", "time", "status", "speed", "state_hash"],
    "properties": {"id": {"$ref": "#/components/schemas/Id"}, "step": {"$ref": "#/components/schemas/Step"},
      "time": {"type": "number", "minimum": 0}, "status": {"$ref": "#/components/schemas/Status"},
      "speed": {"type": "number", "exclusiveMinimum": 0}, "state_hash": {"$ref": "#/components/schemas/Hash"}}},
  "CommandTaken": {"type": "object", "required": ["sequence", "step"],
    "properties": {"sequence": {"type": "integer", "minimum": 1}, "step": {"$ref": "#/components/schemas/Step"}}},
  "Snapshot": {"type": "object", "required": ["id", "step"],
    "properties": {"id": {"type": "string"}, "step": {"$ref": "#/components/schemas/Step"},
      "state_hash": {"$ref": "#/components/schemas/Hash"}}},
  "Snapshots": {"type": "object", "required": ["snapshots"],
    "properties": {"snapshots": {"type": "array", "items": {"$ref": "#/components/schemas/Snapshot"}}}},
  "Pass": {"type": "object", "required": ["system", "pass", "runs", "reason"],
    "properties": {"system": {"type": "string"}, "pass": {"type": "string"}, "runs": {"type": "boolean"},
      "reason": {"type": "string"}}},
  "Plan": {"type": "object", "required": ["passes"],
    "properties": {"passes": {"type": "array", "items": {"$ref": "#/components/schemas/Pass"}}}},
  "Frame": {"type": "object", "required": ["step", "time", "state_hash", "topology_version", "blocks"],
    "properties": {"step": {"$ref": "#/components/schemas/Step"}, "time": {"type": "number", "minimum": 0},
      "alpha": {"type": "number"}, "state_hash": {"$ref": "#/components/schemas/Hash"},
      "topology_version": {"type": "integer"},
      "blocks": {"type": "array", "items": {"type": "object", "required": ["system", "field", "count", "width", "values"],
        "properties": {"system": {"type": "string"}, "field": {"type": "string"}, "unit": {"type": "string"},
          "count": {"type": "integer", "minimum": 0}, "width": {"type": "integer", "minimum": 1},
          "values": {"type": "array"}}}}}},
  "Frames": {"type": "object", "required": ["frames", "last_step", "dropped"],
    "properties": {"frames": {"type": "array", "items": {"$ref": "#/components/schemas/Frame"}},
      "last_step": {"$ref": "#/components/schemas/Step"}, "dropped": {"type": "integer", "minimum": 0}}},
  "Observables": {"type": "object", "required": ["step", "latest", "units", "series"],
    "properties": {"step": {"$ref": "#/components/schemas/Step"},
      "latest": {"type": "object", "additionalProperties": {"type": ["number", "null"]}},
      "units": {"type": "object", "additionalProperties": {"type": "string"}},
      "series": {"type": "object", "required": ["step", "time", "values"],
        "properties": {"step": {"type": "array", "items": {"type": "integer"}},
          "time": {"type": "array", "items": {"type": "number"}},
          "values": {"type": "object", "additionalProperties": {"type": "array",
            "items": {"type": ["number", "null"]}}}}}}},
  "RecordingFinished": {"type": "object", "required": ["frames", "recording"],
    "properties": {"frames": {"type": "integer", "minimum": 0}, "recording": {"type": "string"}}},
  "Issue": {"type": "object", "required": ["pointer", "code"],
    "properties": {"pointer": {"type": "string"}, "code": {"type": "string"}, "message": {"type": "string"},
      "value": {}, "allowed": {"type": "string"}, "did_you_mean": {"type": "string"}, "unit": {"type": "string"}}},
  "Validation": {"type": "object", "required": ["valid", "errors", "warnings"],
    "properties": {"valid": {"type": "boolean"},
      "errors": {"type": "array", "items": {"$ref": "#/components/schemas/Issue"}},
      "warnings": {"type": "array", "items": {"$ref": "#/components/schemas/Issue"}},
      "estimate": {"type": "object"}, "plan": {"type": "array", "items": {"$ref": "#/components/schemas/Pass"}},
      "stable_dt": {"type": "number"}, "scene": {"type": "object"}}},
  "Gallery": {"type": "object", "required": ["scenes"],
    "properties": {"scenes": {"type": "array", "items": {"type": "object", "required": ["name", "thumbnail"],
      "properties": {"name": {"type": "string"}, "title": {"type": "string"}, "teaches": {"type": "string"},
        "tags": {"type": "array", "items": {"type": "string"}}, "thumbnail": {"type": "string"}}}}}},
  "GalleryScene": {"type": "object", "required": ["name", "scene"],
    "properties": {"name": {"type": "string"}, "title": {"type": "string"}, "teaches": {"type": "string"},
      "tags": {"type": "array", "items": {"type": "string"}}, "expect": {"type": "array"}, "scene": {"type": "object"}}},
  "SystemKind": {"type": "object", "required": ["type", "group", "description"],
    "properties": {"type": {"type": "string"}, "group": {"type": "string"}, "description": {"type": "string"},
      "parameters": {"type": "array"}, "integrators": {"type": "array"}, "guarantees": {"type": "array"},
      "fields": {"type": "array"}, "observables": {"type": "array"}}},
  "SystemKinds": {"type": "object", "required": ["systems"],
    "properties": {"systems": {"type": "array", "items": {"$ref": "#/components/schemas/SystemKind"}}}},
  "StudyKinds": {"type": "object", "required": ["studies"],
    "properties": {"studies": {"type": "array", "items": {"type": "object", "required": ["kind", "sentence", "parameters"],
      "properties": {"kind": {"type": "string"}, "sentence": {"type": "string"}, "parameters": {"type": "array"}}}}}},
  "Operation": {"type": "object", "required": ["id", "kind", "status", "progress", "links"],
    "properties": {"id": {"$ref": "#/components/schemas/Id"}, "kind": {"type": "string"},
      "status": {"enum": ["waiting", "running", "done", "failed", "cancelled"]},
      "progress": {"type": "number", "minimum": 0, "maximum": 1}, "note": {"type": "string"},
      "error": {"type": "object"}, "summary": {"type": "object"}, "links": {"$ref": "#/components/schemas/Links"}}},
  "Operations": {"type": "object", "required": ["operations"],
    "properties": {"operations": {"type": "array", "items": {"$ref": "#/components/schemas/Operation"}}}},
  "StudyResult": {"type": "object", "required": ["summary", "columns", "rows", "plot"],
    "properties": {"summary": {"type": "object"}, "columns": {"type": "array"}, "rows": {"type": "array"},
      "plot": {"type": "object"}}},
  "Problem": {"type": "object", "description": "RFC 9457", "required": ["type", "title", "status", "code"],
    "properties": {"type": {"type": "string"}, "title": {"type": "string"}, "status": {"type": "integer"},
      "code": {"type": "string"}, "detail": {"type": "string"}, "instance": {"type": "string"},
      "trace_id": {"type": "string"}, "errors": {"type": "array", "items": {"$ref": "#/components/schemas/Issue"}}}}
})json";

}  // namespace

std::span<const RouteAnswer> answers_of(const net::Route& route) {
  const auto is = [&](const RouteAnswer& a) {
    return a.method == route.method && a.pattern == route.pattern;
  };
  const auto* first = std::find_if(std::begin(kAnswers), std::end(kAnswers), is);
  const auto* end = std::find_if_not(first, std::end(kAnswers), is);
  return {first, end};
}

json::object answer_schemas() {
  return parse_json(kSchemas).as_object();
}

}  // namespace truestep
