// GET /v1/gallery/{name}/picture.png: a gallery scene after its first moments. Drawn on first request by the
// picture thread, and kept while the server runs.
#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/hash.h"
#include "engine/scene/admission.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/session/session.h"
#include "engine/sinks/picture/draw/draw_world.h"
#include "engine/sinks/picture/picture.h"
#include "engine/sinks/picture/png.h"
#include "server/api/app.h"
#include "server/tasks/offload.h"
#include "server/tasks/signal.h"

namespace truestep {

using net::Request;
using net::Response;

namespace {

constexpr int kWidth = 480, kHeight = 304;  // pixels
constexpr double kMoment = 1.2;             // s of simulated time
constexpr double kWork = 0.4;  // s of estimated computing time, so that every machine draws the same picture

std::string draw(const GalleryScene& scene) {
  Scene parsed = require_scene(read_scene(parse_json(scene.text)));
  const double cost = std::max(estimate(parsed).seconds_per_step, 1e-9);
  const TimeParams& time = parsed.header.time;
  const double steps = std::min(std::min(kMoment, 0.5 * time.duration) / time.dt, kWork / cost);
  const auto world = std::make_shared<const World>(std::move(parsed));
  Session session(world, std::make_shared<const ThreadArena>(1), {.history_bytes = 0});
  PictureLook look;
  if (auto trails = TrailSink::of(*world)) session.add_sink(trails), look.trails = std::move(trails);
  session.step(static_cast<uint64_t>(std::llround(steps)));
  PictureRenderer renderer(kWidth, kHeight);
  const auto png = encode_png(renderer.render_rgba(draw_list_of(
                                  session.world(), *session.frame(picture_request(session.world())), look)),
                              kWidth, kHeight);
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

// Pictures by scene name; only the picture thread uses them, so there is no lock.
using Drawn = std::map<std::string_view, net::SharedBuffer>;

}  // namespace

void add_thumbnail_routes(net::Router& router, App& app) {
  auto drawn = std::make_shared<Drawn>();
  router.add(net::Method::get, "/v1/gallery/{name}/picture.png",
             "A gallery scene after its first moments, 480 x 304",
             [&app, drawn](const Request& r) -> Task<Response> {
               const GalleryScene* g = find_gallery_scene(r.param("name"));
               if (!g) throw Error("not_found", "the gallery has no such scene");
               Hasher hasher;
               hasher.text(g->text);
               const std::string etag = "\"" + hex64(hasher.value()) + "\"";
               auto draw_it = [&] {
                 net::SharedBuffer& png = (*drawn)[g->name];
                 if (!png) png = std::make_shared<const std::string>(draw(*g));
                 Response response = Response::shared(png, "image/png", etag);
                 response.header("Cache-Control", "no-cache");
                 return response;
               };
               co_return co_await app.runner.draw(std::move(draw_it));
             });
}

}  // namespace truestep
