// How commands change a skeleton, what makes a state of one valid, and its drawing.
#include "engine/core/commands/command_checks.h"
#include "engine/systems/skeleton/scratch.h"

namespace truestep::skeleton {

using namespace animation;
using C = SkeletonColumns;

void Skeleton::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  int32_t& dragged = s.span<int32_t>(C::kDragJoint)[0];
  switch (c.kind) {
    case CommandKind::set_parameter: {
      if (driver_.apply(s, C::kControl, c)) return;
      std::string all;
      for (size_t k = 0; k < driver_.controls(); ++k) all += (k > 0 ? ", " : "") + driver_.control(k);
      refuse_command("name", "unknown_parameter", "there is no control \"" + c.name + "\"", all);
    }
    case CommandKind::drag:
      refuse_place(c, "joint");
      dragged = static_cast<int32_t>(checked_command_row(c, model_.joints.size(), "joint"));
      store3(s.f64(C::kDragTarget).data(), 0, c.vector);
      return;
    case CommandKind::release:
      dragged = -1;
      return;
    default:
      refuse_command("type", "unsupported_command", "a skeleton moves as prescribed",
                     "set_parameter, drag, release");
  }
}

void Skeleton::check(StateCheck& check, double) const {
  const size_t n = model_.joints.size(), led = 2 * n + LeadRows::rows,
               rows = check.state().rows(C::kCoordinates);
  check.below(MovedBodies::from(0).form, model_.bones.size()).below(C::kDragJoint, n);
  check.together({C::kCoordinates}, led)
      .require(rows == n || rows == led, "coordinates are those of all joints");
}

void Skeleton::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (!wants(wishes, Wish::constant)) return;
  out.parts.resize(parts().size());
  const auto color = [](const std::optional<Vec3>& c) -> std::optional<std::array<double, 3>> {
    if (!c) return std::nullopt;
    return std::array{c->x, c->y, c->z};
  };
  for (uint32_t j = 0; j < model_.joints.size(); ++j) {
    if (model_.joints[j].parent < 0) continue;
    out.parts[0].lines.push_back({static_cast<uint32_t>(model_.joints[j].parent), j});
    out.parts[0].line_kinds.push_back(LineKind::structural);
  }
  if (model_.skin.empty()) {
    for (uint32_t b = 0; b < model_.bones.size(); ++b) {
      Visual v;
      v.shape.kind = DrawnShape::Kind::capsule, v.shape.size = solids_[b].size;
      v.color = color(color_), v.motion = Visual::Motion::kinematic;
      out.parts[1].instances.push_back({b, b});
      out.parts[1].visuals.push_back(std::move(v));
    }
    return;
  }
  out.parts[2].triangles = model_.triangles;
  out.parts[2].color = color(skin_color_);
}

}  // namespace truestep::skeleton
