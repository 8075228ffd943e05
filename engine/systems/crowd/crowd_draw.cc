// The drawing of a crowd: its walls, and its groups as discs.
#include <algorithm>

#include "engine/math/trig.h"
#include "engine/systems/crowd/crowd.h"

namespace truestep::crowd {

void Crowd::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::obstacles)) {
    constexpr double kThick = 0.05, kHigh = 0.5;
    for (const Segment& w : walls_.pieces()) {
      const Vec3 d = w.b - w.a;
      const double half_turn = 0.5 * trig::atan2(d.y, d.x);
      DrawnShape box;
      box.kind = DrawnShape::Kind::box, box.position = (w.a + w.b) * 0.5;
      const trig::SinCos a = trig::sincos(half_turn);
      box.orientation = {a.cos, 0, 0, a.sin};
      box.size = {0.5 * norm(d) + kThick, kThick, kHigh};
      out.obstacles.push_back(box);
    }
  }
  if (!wants(wishes, Wish::constant)) return;
  for (const GroupDef& g : def_.groups) {
    PartDrawing& p = out.parts.emplace_back();
    p.space = PartDrawing::Space::plane;
    p.point_radius = std::max(g.radius, 0.05);
    if (g.color) p.color = {g.color->x, g.color->y, g.color->z};
  }
}

}  // namespace truestep::crowd
