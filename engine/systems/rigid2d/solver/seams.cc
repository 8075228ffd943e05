#include "engine/systems/rigid2d/solver/seams.h"

#include <algorithm>

#include "engine/collision/flat/seam.h"
#include "engine/math/trig.h"

namespace truestep::rigid2d {
namespace {

bool is_ground(const Model& model, uint32_t shape) {
  const Outline& s = model.shapes[shape].outline;
  return model.light[model.body_of[shape]].motion == Motion::fixed && s.corners > 2 && s.radius == 0;
}

}  // namespace

double flush(const Model& model) {
  return 0.05 * model.margin;
}

bool has_seams(const Model& model) {
  std::vector<Box> boxes;
  for (uint32_t i = 0; i < model.shapes.size(); ++i) {
    const Body& b = model.bodies[model.shapes[i].body];
    if (!is_ground(model, i)) continue;
    const trig::SinCos turn = trig::sincos(b.angle);
    const Pose at{b.position, {turn.cos, turn.sin}};
    boxes.push_back(flat::bounds(model.shapes[i].outline, at).grown(flush(model)));
  }
  std::sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) { return a.low.x < b.low.x; });
  for (size_t i = 0; i < boxes.size(); ++i) {
    for (size_t k = i + 1; k < boxes.size() && boxes[k].low.x <= boxes[i].high.x; ++k) {
      if (boxes[k].low.y <= boxes[i].high.y && boxes[i].low.y <= boxes[k].high.y) return true;
    }
  }
  return false;
}

void leave_out_seams(const Model& model, Pairs& p) {
  auto& on_ground = p.on_ground;
  on_ground.clear();
  for (uint32_t i = 0; i < p.hits.size(); ++i) {
    const Hit& h = p.hits[i];
    if (h.what != Hit::What::touching) continue;
    if (is_ground(model, h.a)) {
      on_ground.push_back({h.b, i});
    } else if (is_ground(model, h.b)) {
      on_ground.push_back({h.a, i});
    }
  }
  std::sort(on_ground.begin(), on_ground.end());
  const auto touched = [&](uint32_t i, Outline& shape) {
    const Hit& h = p.hits[i];
    const bool ground_is_a = is_ground(model, h.a);
    shape =
        flat::moved(model.shapes[ground_is_a ? h.a : h.b].outline, p.pose[ground_is_a ? h.body_a : h.body_b]);
    return flat::Touched{shape, ground_is_a ? p.contacts[i].normal : -p.contacts[i].normal};
  };
  Outline of_ground, of_beside;
  for (size_t first = 0, last = 0; first < on_ground.size(); first = last) {
    while (last < on_ground.size() && on_ground[last].first == on_ground[first].first) ++last;
    for (size_t i = first; i < last && last - first > 1; ++i) {
      const flat::Touched beside = touched(on_ground[i].second, of_beside);
      for (size_t k = first; k < last; ++k) {
        if (k == i || p.hits[on_ground[k].second].what != Hit::What::touching) continue;
        if (!flat::is_seam(beside, touched(on_ground[k].second, of_ground), flush(model))) continue;
        p.hits[on_ground[i].second].what = Hit::What::none;
        break;
      }
    }
  }
}

}  // namespace truestep::rigid2d
