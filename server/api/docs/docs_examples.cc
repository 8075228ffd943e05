// The examples of GET /docs. Tests run all of them in order.
#include "server/api/docs/docs_page.h"

namespace truestep {

namespace {

using M = net::Method;

constexpr RouteExample kExamples[] = {
    {M::get, "/healthz", "curl -sf $base/healthz"},
    {M::get, "/readyz", "curl -sf $base/readyz"},
    {M::get, "/version", "curl -sf $base/version"},
    {M::get, "/metrics", "curl -sf $base/metrics | grep truestep_sessions"},
    {M::get, "/openapi.json", "curl -sf $base/openapi.json -o openapi.json"},
    {M::get, "/docs", "curl -sf $base/docs -o docs.html"},
    {M::get, "/", "curl -sf $base/ -o viewer.html"},
    {M::get, "/v1/systems", "curl -sf $base/v1/systems"},
    {M::get, "/v1/systems/{type}", "curl -sf $base/v1/systems/rigid3d"},
    {M::get, "/v1/schemas/scene-1.json", "curl -sf $base/v1/schemas/scene-1.json -o scene-1.json"},
    {M::get, "/v1/schemas/stream.proto", "curl -sf $base/v1/schemas/stream.proto -o stream.proto"},
    {M::get, "/v1/gallery", "curl -sf $base/v1/gallery"},
    {M::get, "/v1/gallery/{name}", "curl -sf $base/v1/gallery/rope_catenary"},
    {M::get, "/v1/gallery/{name}/picture.png",
     "curl -sf $base/v1/gallery/rope_catenary/picture.png -o rope.png"},
    {M::post, "/v1/scenes/validate",
     R"(curl -sf --json '{"systems": [{"type": "oscillator", "id": "a", "stiffness": 100, "position": 1}]}' $base/v1/scenes/validate)"},
    {M::put, "/v1/assets/{sha256}",
     R"(printf '[[0, 0, 0], [1, 0, 0], [2, 1, 0]]' > places.json
sum=$(sha256sum places.json | cut -c1-64)
curl -sf -T places.json -H 'Content-Type: application/json' $base/v1/assets/$sum
curl -sf --json '{"systems": [{"type": "particles", "id": "p", "positions": {"asset": "'$sum'"}}]}' $base/v1/scenes/validate
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' > solid.obj
mesh=$(sha256sum solid.obj | cut -c1-64)
curl -sf -T solid.obj -H 'Content-Type: application/octet-stream' $base/v1/assets/$mesh
curl -sf --json '{"systems": [{"type": "xpbd", "id": "c", "mesh": {"asset": "'$mesh'", "scale": 0.1}}]}' $base/v1/scenes/validate)"},
    {M::get, "/v1/assets/{sha256}", "curl -sf $base/v1/assets/$sum"},
    {M::delete_, "/v1/assets/{sha256}", "curl -sf -X DELETE $base/v1/assets/$sum"},
    {M::post, "/v1/sessions",
     R"(id=$(curl -sf --json '{"gallery": "rope_catenary"}' $base/v1/sessions | cut -d'"' -f4))"},
    {M::put, "/v1/sessions/{id}",
     R"(mine=6f1c2a52-3f0e-4c55-9a53-0a5b7c7d1e90
curl -sf -X PUT --json '{"systems": [{"type": "oscillator", "id": "a", "position": 1}], "recording": {}}' $base/v1/sessions/$mine)"},
    {M::get, "/v1/sessions", "curl -sf \"$base/v1/sessions?limit=10\""},
    {M::get, "/v1/sessions/{id}", "curl -sf $base/v1/sessions/$id"},
    {M::get, "/v1/sessions/{id}/scene", "curl -sf $base/v1/sessions/$id/scene"},
    {M::get, "/v1/sessions/{id}/plan", "curl -sf $base/v1/sessions/$id/plan"},
    {M::post, "/v1/sessions/{id}/step", R"(curl -sf --json '{"steps": 100}' $base/v1/sessions/$id/step)"},
    {M::post, "/v1/sessions/{id}/play",
     R"(curl -sf --json '{"speed": 0.5, "keep_running": true}' $base/v1/sessions/$id/play)"},
    {M::post, "/v1/sessions/{id}/pause", "curl -sf -X POST $base/v1/sessions/$id/pause"},
    {M::post, "/v1/sessions/{id}/seek", R"(curl -sf --json '{"step": 50}' $base/v1/sessions/$id/seek)"},
    {M::post, "/v1/sessions/{id}/commands",
     R"(curl -sf --json '{"type": "impulse", "system": "rope", "index": 5, "impulse": [0, 0.01, 0]}' $base/v1/sessions/$id/commands)"},
    {M::post, "/v1/sessions/{id}/queries",
     R"(curl -sf --json '{"type": "nearest", "point": [0, 0, 0], "limit": 3}' $base/v1/sessions/$id/queries)"},
    {M::get, "/v1/sessions/{id}/frames", "curl -sf \"$base/v1/sessions/$id/frames?fields=position\""},
    {M::get, "/v1/sessions/{id}/frames/{step}", "curl -sf $base/v1/sessions/$id/frames/latest"},
    {M::get, "/v1/sessions/{id}/observables",
     "curl -sf -H 'Accept: text/csv' \"$base/v1/sessions/$id/observables?names=energy&max_points=100\""},
    {M::get, "/v1/sessions/{id}/picture.png",
     "curl -sf \"$base/v1/sessions/$id/picture.png?size=640x400&color_by=speed&theme=dark&camera=front\" -o "
     "picture.png"},
    {M::get, "/v1/sessions/{id}/motion.bvh",
     R"(arm=$(curl -sf --json '{"gallery": "anim_two_link_arm"}' $base/v1/sessions | cut -d'"' -f4)
curl -sf --json '{"seconds": 1}' $base/v1/sessions/$arm/step
curl -sf "$base/v1/sessions/$arm/motion.bvh?rate=24" -o arm.bvh)"},
    {M::get, "/v1/sessions/{id}/motion.gltf", "curl -sf $base/v1/sessions/$arm/motion.gltf -o arm.gltf"},
    {M::get, "/v1/sessions/{id}/motion.glb",
     "curl -sf \"$base/v1/sessions/$arm/motion.glb?seconds=0.5\" -o arm.glb"},
    {M::post, "/v1/sessions/{id}/snapshots",
     R"(sid=$(curl -sf -X POST $base/v1/sessions/$id/snapshots | cut -d'"' -f4))"},
    {M::get, "/v1/sessions/{id}/snapshots", "curl -sf $base/v1/sessions/$id/snapshots"},
    {M::get, "/v1/sessions/{id}/snapshots/{sid}",
     "curl -sf $base/v1/sessions/$id/snapshots/$sid -o rope.snapshot"},
    {M::post, "/v1/sessions/{id}/snapshots/{sid}/restore",
     "curl -sf -X POST $base/v1/sessions/$id/snapshots/$sid/restore"},
    {M::post, "/v1/sessions/{id}/branch", "curl -sf -X POST $base/v1/sessions/$id/branch"},
    {M::get, "/v1/sessions/{id}/bundle", "curl -sf $base/v1/sessions/$id/bundle -o rope.bundle"},
    {M::post, "/v1/sessions/{id}/reset", "curl -sf -X POST $base/v1/sessions/$id/reset"},
    {M::post, "/v1/sessions/{id}/recording/finish",
     R"(curl -sf --json '{"steps": 20}' $base/v1/sessions/$mine/step
curl -sf -X POST $base/v1/sessions/$mine/recording/finish)"},
    {M::post, "/v1/sessions/{id}/recording",
     R"(# The one that the scene asked for has been finished; this one begins now.
curl -sf --json '{"every": 2}' $base/v1/sessions/$mine/recording)"},
    {M::delete_, "/v1/sessions/{id}/recording", "curl -sf -X DELETE $base/v1/sessions/$mine/recording"},
    {M::get, "/v1/sessions/{id}/recording", "curl -sf $base/v1/sessions/$mine/recording -o mine.vtkhdf"},
    {M::get, "/v1/recordings", "curl -sf $base/v1/recordings"},
    {M::get, "/v1/recordings/{rid}", "curl -sf $base/v1/recordings/$mine"},
    {M::get, "/v1/recordings/{rid}/file", "curl -sf $base/v1/recordings/$mine/file -o mine.vtkhdf"},
    {M::delete_, "/v1/sessions/{id}", "curl -sf -X DELETE $base/v1/sessions/$mine"},
    {M::delete_, "/v1/recordings/{rid}", "curl -sf -X DELETE $base/v1/recordings/$mine"},
    {M::post, "/v1/runs",
     R"(op=$(curl -sf --json '{"gallery": "rope_catenary", "duration": 0.5, "observables": ["energy"]}' $base/v1/runs | cut -d'"' -f4))"},
    {M::get, "/v1/studies", "curl -sf $base/v1/studies"},
    {M::post, "/v1/studies",
     R"(study=$(curl -sf --json '{"kind": "convergence", "scene": {"time": {"dt": 0.05, "duration": 1}, "systems": [{"type": "oscillator", "id": "a", "stiffness": 100, "position": 1}]}}' $base/v1/studies | cut -d'"' -f4))"},
    {M::get, "/v1/operations/{id}/events", "curl -sfN $base/v1/operations/$op/events | tail -n 2"},
    {M::get, "/v1/operations", "curl -sf $base/v1/operations"},
    {M::get, "/v1/operations/{id}", "curl -sf $base/v1/operations/$op"},
    {M::get, "/v1/operations/{id}/result", "curl -sf $base/v1/operations/$op/result"},
    {M::get, "/v1/operations/{id}/result.json", "curl -sf $base/v1/operations/$op/result.json -o run.json"},
    {M::get, "/v1/operations/{id}/result.csv", "curl -sf $base/v1/operations/$op/result.csv -o run.csv"},
    {M::get, "/v1/operations/{id}/result.svg", "curl -sf $base/v1/operations/$op/result.svg -o run.svg"},
    {M::post, "/v1/operations/{id}/cancel", "curl -sf -X POST $base/v1/operations/$study/cancel"},
    {M::delete_, "/v1/operations/{id}", "curl -sf -X DELETE $base/v1/operations/$op"},
};

}  // namespace

std::span<const RouteExample> route_examples() {
  return kExamples;
}

std::string_view stream_example() {
  return R"(const ws = new WebSocket(base.replace("http", "ws") + "/v1/sessions/" + id + "/stream", "truestep.v1.json");
const send = (message) => ws.send(JSON.stringify(message));
ws.onmessage = ({ data }) => {
  const message = JSON.parse(data);
  if (message.hello) {
    send({ request_id: "1", subscribe: { fields: ["position"], encoding: "F32", rate: 30, credit: 2 } });
    send({ request_id: "2", control: { action: "play", value: 1 } });
  }
  if (message.frame) {
    const bytes = Uint8Array.from(atob(message.frame.blocks[0].data), (c) => c.charCodeAt(0));
    const positions = new Float32Array(bytes.buffer);  // rows x 3, m
    console.log("step", message.frame.step, "first row at", positions.slice(0, 3));
    send({ credit: { frames: 1 } });
    if (Number(message.frame.step) > 10) ws.close();
  }
};)";
}

}  // namespace truestep
