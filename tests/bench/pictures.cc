// Time of one picture, from a draw list to pixels, through OSMesa beside EGL's surfaceless platform (the
// second choice if a driver lacks OSMesa): a cloth of 10,000 points and 100,000 particles, in two sizes.
// Without EGL, OSMesa is compared with itself, and the peer's name says so. PNG encoding is timed separately,
// beside the raw pixels.
#include <cstdio>
#include <string>

#include "engine/base/errors.h"
#include "engine/sinks/picture/picture.h"
#include "tests/bench/report.h"
#include "tests/unit/pictures/picture_lists.h"

namespace {

using namespace truestep;
using Backend = PictureRenderer::Backend;

constexpr int kRounds = 9;

PictureRenderer peer_renderer(int width, int height, std::string& name) {
  try {
    name = "EGL surfaceless";
    return PictureRenderer(width, height, Backend::egl);
  } catch (const Error&) {
    name = "itself, for want of EGL";
    return PictureRenderer(width, height);
  }
}

void picture(const std::string& what, const DrawList& list, int width, int height) {
  std::string name;
  PictureRenderer ours(width, height), peer = peer_renderer(width, height, name);
  // The first picture compiles shaders.
  ours.render_rgba(list);
  peer.render_rgba(list);
  const bench::Times t = bench::interleaved(
      kRounds, [&] { ours.render_rgba(list); }, [&] { peer.render_rgba(list); });
  bench::report({.bench = "pictures." + what,
                 .metric = "seconds per picture of " + std::to_string(width) + " x " + std::to_string(height),
                 .ours = t.ours,
                 .peer = t.peer,
                 .peer_name = name});
}

void png(const DrawList& list, int width, int height) {
  PictureRenderer renderer(width, height);
  const std::vector<uint8_t> rgba = renderer.render_rgba(list);
  size_t bytes = 0;
  const bench::Times t = bench::interleaved(
      kRounds, [&] { bytes = encode_png(rgba, width, height).size(); }, [&] { renderer.render_rgba(list); });
  std::fprintf(stderr, "%zu bytes of PNG\n", bytes);
  bench::report({.bench = "pictures.png",
                 .metric = "seconds per file of " + std::to_string(width) + " x " + std::to_string(height),
                 .ours = t.ours,
                 .peer = t.peer,
                 .peer_name = "drawing the picture"});
}

}  // namespace

int main() {
  const DrawList cloth = test::draped_cloth(100), particles = test::fountain(100000);
  for (const auto& [width, height] : {std::pair{640, 480}, {1280, 720}}) {
    picture("cloth", cloth, width, height);
    picture("particles_100k", particles, width, height);
    png(cloth, width, height);
  }
}
