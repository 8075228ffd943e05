// GET /v1/sessions/{id}/motion.bvh, .gltf and .glb: what a skeleton or blended shapes have done in a session,
// computed again from its past, as a file of other programs.
#include "engine/sinks/motion/session_motion.h"
#include "server/api/requests.h"

namespace truestep {

using net::Method;
using net::Request;
using net::Response;

namespace {

// Poses of joints and weights that an answer holds: 64 bytes each while it is made.
constexpr double kMostRows = 2e6;

struct Wanted {
  size_t system = 0;
  FrameSteps steps;
  uint64_t frames = 0;
};

Wanted wanted_of(const Request& request, const Session& session, MotionFormat format) {
  const World& world = session.world();
  Wanted w;
  w.system = motion_system(world, request.query_value("system").value_or(""), format, "?system");
  w.steps.rate = query_number(request, "rate", 30, 10'000);
  w.steps.dt = world.dt();
  if (w.steps.rate < 0.01) {
    throw Error("bad_request", "a rate must be 0.01 to 10000 frames per second",
                {{"?rate", "out_of_range", "frames per second of the scene's time",
                  std::string(request.query_value("rate").value_or("")), "0.01 to 10000", "", "1/s"}});
  }
  const double all = static_cast<double>(session.step_index() - session.first_step()) * w.steps.dt;
  const double seconds = std::min(all, query_number(request, "seconds", 1e18, 1e18));
  const auto back = static_cast<uint64_t>(std::llround(seconds / w.steps.dt));
  w.steps.first = session.step_index() - std::min(back, session.step_index() - session.first_step());
  const double rows =
      (seconds * w.steps.rate + 1) * static_cast<double>(MotionExport::rows(world.system(w.system)));
  if (rows > kMostRows) {
    throw Error("bad_request", "this is more motion than one answer can hold",
                {{"?seconds", "out_of_range", "frames times joints or shapes", std::to_string(rows),
                  "2000000 at most: fewer seconds, or a lower rate", "", "s"}});
  }
  w.frames = w.steps.count(seconds);
  return w;
}

Task<Response> motion(App& app, const Request& request, MotionFormat format, const char* media) {
  EntryPtr entry = co_await session_of(app, request);
  auto compute = [&] {
    std::unique_lock lock(entry->mutex);
    const Wanted w = wanted_of(request, entry->session, format);
    const World& world = entry->session.world();
    const uint64_t last = entry->session.step_index();
    const Past past = entry->session.past(w.steps.first);
    std::vector<JournalEntry> commands;
    for (const JournalEntry& e : entry->session.journal()) {
      if (e.step > w.steps.first && e.step <= last) commands.push_back(e);
    }
    lock.unlock();
    // The world of a session never changes.
    MotionExport file(world.system(w.system), world.id(w.system), w.steps.rate);
    WorldState state = past.compute();
    Workspace scratch;
    for (auto next = commands.begin();; world.step(state, scratch, *past.arena, {})) {
      for (; next != commands.end() && next->step <= state.step; ++next) world.apply(state, next->command);
      while (file.frames() < w.frames && w.steps.step(file.frames()) <= state.step)
        file.add(state.systems[w.system], static_cast<double>(state.step) * w.steps.dt);
      if (state.step >= last) break;
    }
    Response r = Response::text(write_motion(file, format), media);
    r.header("Cache-Control", "no-store");
    return r;
  };
  co_return co_await app.runner.long_work(std::move(compute));
}

}  // namespace

void add_motion_routes(net::Router& router, App& app) {
  const std::string path = "/v1/sessions/{id}/motion";
  router.add(Method::get, path + ".bvh", "The motion of a skeleton as a BVH file", [&app](const Request& r) {
    return motion(app, r, MotionFormat::bvh, "text/plain; charset=utf-8");
  });
  router.add(Method::get, path + ".gltf", "The motion of a skeleton or blended shapes as glTF 2.0",
             [&app](const Request& r) { return motion(app, r, MotionFormat::gltf, "model/gltf+json"); });
  router.add(Method::get, path + ".glb", "The same as binary glTF 2.0",
             [&app](const Request& r) { return motion(app, r, MotionFormat::glb, "model/gltf-binary"); });
}

}  // namespace truestep
