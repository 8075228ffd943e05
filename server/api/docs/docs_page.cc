#include "server/api/docs/docs_page.h"

#include <algorithm>

#include "engine/base/text/xml.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "server/api/docs/openapi_tables.h"
#include "server/api/stream_proto.h"
#include "server/net/http/problem.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr std::string_view kHead = R"html(<!doctype html><html lang=en><meta charset=utf-8>
<meta name=viewport content="width=device-width"><title>Truestep API</title><style>
body{font:16px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color:#1c2430}
td,th{padding:.2rem .75rem .2rem 0;vertical-align:top;text-align:left}code,pre{background:#eef1f5;border-radius:.2rem}
code{padding:.1rem .3rem}pre{padding:.6rem .8rem;overflow-x:auto;font-size:.85rem}h3{margin:2rem 0 .2rem}
pre code{padding:0}nav a{margin-right:1rem}</style><h1>Truestep API</h1>
<nav><a href=#requests>Requests</a><a href=#stream>Stream</a><a href=#schemas>Schemas</a><a href=#codes>Codes</a>
<a href=/openapi.json>openapi.json</a><a href=/v1/schemas/scene-1.json>scene schema</a><a
href=/v1/schemas/stream.proto>stream.proto</a></nav>
<p>Numbers are SI. Errors are <code>application/problem+json</code> (RFC 9457) with a stable <code>code</code> and, in
<code>errors</code>, a pointer, what is allowed and the nearest name for every fault: members of a body as
<code>/speed</code>, query parameters as <code>?limit</code>. What a request does not read is an error. A server with keys
wants <code>Authorization: Bearer KEY</code>.
<h2 id=requests>Requests</h2><p>The examples are for a shell with curl 7.82 or newer and run in this order:
<pre>base=http://127.0.0.1:8080</pre>)html";

constexpr std::string_view kStream = R"html(<h2 id=stream>The stream</h2>
<p><code>WS /v1/sessions/{id}/stream</code> with one of the subprotocols <code>truestep.v1.proto</code> (binary messages,
<a href=/v1/schemas/stream.proto>stream.proto</a>) and <code>truestep.v1.json</code> (the same messages as JSON text: bytes are
base64, 64-bit integers are texts). Each message is one <code>ServerMessage</code> or one <code>ClientMessage</code>.
<ol><li>The server says <b>Hello</b> (dt, systems, parts and their fields), <b>Topology</b> (what is drawn with the rows; again
when its version changes), <b>PlaybackState</b> and the present <b>Frame</b>.
<li>The client may <b>Subscribe</b>: fields, systems, frames a second, encoding, policy, credit, observables, marks. Without it
every step's places come as F32.
<li>A <b>Frame</b> holds all of one step: the blocks (rows x width, little-endian), the shapes that have moved, the marks.
Policy <code>LATEST</code> sends the newest state when there is room and counts what it left out in <code>dropped</code>; policy
<code>EVERY</code> sends each and closes with 4408 when the client does not keep up. With <b>Credit</b> at most so many frames are
on their way; each Credit message adds some.
<li><b>Control</b>: play, pause, step, seek, speed, reset. <b>Command</b>: the body of POST .../commands. What has a
<code>request_id</code> is answered by <b>Reply</b> or <b>Problem</b>.
<li><b>PlaybackState</b> comes with every change and once a second of playing; <code>achieved_speed</code> is what playing comes to
where the service cannot keep up. A session whose last stream has closed pauses after a grace (<code>serve
--pause-unwatched</code>, 10 s) unless its scene or its play says <code>keep_running</code>.
<li><b>Bye</b> (code, reason) is the last message: <code>unknown_session</code>, then close code 4410, when the session has been
deleted; <code>draining</code>, then 1001, when the service ends. Other close codes: 1008 the key is no longer valid, 1009 a
message was too long, 4408 see above.</ol>
<p>In a browser or Node, given <code>base</code> and <code>id</code>:<pre>)html";

std::string anchor(std::string_view schema) {
  return "<a href=#schema-" + std::string(schema) + ">" + std::string(schema) + "</a>";
}

// A schema in a few words: its name or its contents.
std::string in_words(const json::value& schema) {
  if (const json::object* o = schema.if_object()) {
    if (const json::value* ref = o->if_contains("$ref"); ref && ref->is_string()) {
      const std::string_view to = ref->as_string();
      constexpr std::string_view kOwn = "#/components/schemas/";
      if (to.starts_with(kOwn)) return anchor(to.substr(kOwn.size()));
      return "<a href=" + escaped_xml(std::string(to)) + ">" + escaped_xml(std::string(to)) + "</a>";
    }
    if (const json::value* any = o->if_contains("oneOf"); any && o->size() == 1) {
      std::string out;
      for (const json::value& v : any->as_array()) (out += out.empty() ? "" : " or ") += in_words(v);
      return out;
    }
  }
  return "<code>" + escaped_xml(write_json(schema)) + "</code>";
}

std::string parameters_of(const net::Route& route) {
  std::string rows;
  for (const RouteParameter& p : route_parameters()) {
    if (p.method != route.method || p.pattern != route.pattern) continue;
    rows += "<tr><td><code>" + std::string(p.in == "query" ? "?" : "") + std::string(p.name) + "</code><td>" +
            escaped_xml(p.description) + "<td>" + in_words(parse_json(p.schema));
  }
  return rows.empty() ? "" : "<table>" + rows + "</table>";
}

std::string bodies_of(const net::Route& route) {
  std::string out;
  for (const auto& [media, content] : body_of(route)) {
    const json::value* schema = content.as_object().if_contains("schema");
    const bool nothing = schema && write_json(*schema).find("schemas/Nothing") != std::string::npos;
    if (nothing) continue;
    out += "<p>Body: <code>" + std::string(media) + "</code>" + (schema ? " " + in_words(*schema) : "");
  }
  return out;
}

std::string answers_text(const net::Route& route) {
  std::string rows;
  for (const RouteAnswer& a : answers_of(route)) {
    rows += "<tr><td><code>" + std::to_string(a.status) + "</code><td>" + escaped_xml(a.description) +
            "<td>" + (a.media.empty() ? "" : "<code>" + std::string(a.media) + "</code> ") +
            (a.schema.empty() ? "" : anchor(a.schema));
  }
  return "<table>" + rows + "</table>";
}

std::string section(const net::Route& route, std::string_view command) {
  const std::string method(route.open_websocket ? "WS" : net::method_name(route.method));
  std::string out = "<h3><code>" + method + " " + escaped_xml(route.pattern) + "</code></h3><p>" +
                    escaped_xml(route.summary) + parameters_of(route) + bodies_of(route) +
                    answers_text(route);
  if (!command.empty()) out += "<pre class=example>" + escaped_xml(command) + "</pre>";
  return out + "\n";
}

std::string all_schemas() {
  json::object schemas = answer_schemas();
  for (auto& [name, schema] : body_schemas()) schemas[name] = std::move(schema);
  std::string out = "<h2 id=schemas>Schemas</h2>";
  for (const auto& [name, schema] : schemas) {
    out += "<details id=schema-" + std::string(name) + "><summary><code>" + std::string(name) +
           "</code></summary><pre>" + escaped_xml(write_json(schema)) + "</pre></details>";
  }
  return out;
}

}  // namespace

// In the order of the examples, which build on each other; routes without one come last.
std::string docs_page(const net::Router& router) {
  std::string page(kHead);
  const auto example = [](const net::Route& r) {
    const auto all = route_examples();
    return std::find_if(all.begin(), all.end(),
                        [&](const auto& e) { return e.method == r.method && e.pattern == r.pattern; });
  };
  std::vector<const net::Route*> rows;
  for (const net::Route& r : router.rows()) {
    if (is_interface(r)) rows.push_back(&r);
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [&](const auto* a, const auto* b) { return example(*a) < example(*b); });
  for (const net::Route* r : rows) {
    const auto at = example(*r);
    page += section(*r, at == route_examples().end() ? "" : at->command);
  }
  page += std::string(kStream) + escaped_xml(stream_example()) +
          "</pre><details><summary>stream.proto</summary><pre>" + escaped_xml(stream_proto()) +
          "</pre></details>" + all_schemas() + "<h2 id=codes>Codes</h2><table>";
  for (const net::ProblemKind& k : net::problem_kinds()) {
    page += "<tr><td><code>" + std::string(k.code) + "</code><td>" + std::to_string(k.status) + "<td>" +
            escaped_xml(k.title);
  }
  return page + "</table>";
}

}  // namespace truestep
