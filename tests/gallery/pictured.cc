#include "tests/gallery/pictured.h"

#include <cmath>
#include <iostream>

#include "engine/sinks/picture/camera.h"
#include "engine/sinks/picture/draw/draw_world.h"
#include "engine/sinks/picture/text/overlay_layout.h"

namespace truestep::gallery_pass {
namespace {

using picture::Rectangle;
using picture::View;

constexpr int kWidth = 640, kHeight = 360;  // pixels
// Of a cloud's points: spray, emitted and expelled particles leave a scene for good.
constexpr double kShare = 0.75;

bool is_inside(const View& view, const Vec3& place) {
  const Vec3f p = view.units.position(place);
  const Vec3 q = Vec3{p.x, p.y, p.z} - view.eye;
  const double depth = -dot(q, view.back);
  if (!(depth > 0)) return false;
  return std::abs(dot(q, view.right)) < 0.5 * kWidth * depth * view.pixel &&
         std::abs(dot(q, view.above)) < 0.5 * kHeight * depth * view.pixel;
}

bool is_framed(const DrawList& list, const View& view) {
  bool good = true;
  for (const DrawShape& s : list.shapes) {
    if (s.kind == DrawShape::Kind::plane || s.container || s.framing != DrawShape::Framing::counts) continue;
    if (!s.color || is_inside(view, s.position)) continue;
    std::cout << "a body at (" << s.position.x << ", " << s.position.y << ", " << s.position.z
              << ") is outside the picture\n";
    good = false;
  }
  for (const DrawPoints& set : list.points) {
    size_t seen = 0, all = 0;
    for (size_t i = 0; i + 2 < set.positions.size(); i += 3) {
      const Vec3 p{set.positions[i], set.positions[i + 1], set.positions[i + 2]};
      if (!std::isfinite(p.x + p.y + p.z)) continue;
      ++all, seen += is_inside(view, p);
    }
    if (static_cast<double>(seen) >= kShare * static_cast<double>(all)) continue;
    std::cout << "only " << seen << " of " << all << " points are inside the picture\n";
    good = false;
  }
  return good;
}

bool is_legible(const DrawList& list, const View& view) {
  const picture::OverlayLayout layout = picture::layout_overlay(list, &view, kWidth, kHeight);
  const std::vector<Rectangle>& panels = layout.panels;
  bool good = layout.caption.empty() == list.caption.empty() && layout.legend.size() == list.legend.size();
  for (size_t i = 0; i < panels.size(); ++i) {
    const Rectangle& r = panels[i];
    good &= r.left >= 0 && r.top >= 0 && r.right <= kWidth && r.bottom <= kHeight;
    for (size_t j = 0; j < i; ++j) good &= !r.meets(panels[j]);
  }
  if (!good) std::cout << "the caption, the legend and the colour bar have no room\n";
  return good;
}

}  // namespace

bool is_pictured(const Session& session, Spoil spoil) {
  const World& world = session.world();
  DrawList list = draw_list_of(world, *session.frame(picture_request(world)));
  list.camera = picture::camera_for(list, static_cast<double>(kWidth) / kHeight);
  if (spoil == Spoil::camera) list.camera->target = list.camera->eye * 2 - list.camera->target;
  const View view(list, kWidth, kHeight);
  const bool framed = is_framed(list, view), legible = is_legible(list, view);
  return framed && legible;
}

}  // namespace truestep::gallery_pass
