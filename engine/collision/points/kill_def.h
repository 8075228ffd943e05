// Regions in which points are removed: "kill_planes" and "kill_boxes", shared by systems with a variable
// number of points.
#pragma once
#include <vector>

#include "engine/core/def/def.h"
#include "engine/math/vec3.h"

namespace truestep {

struct KillPlaneDef {
  Vec3 point, normal{0, 1, 0};
};
struct KillBoxDef {
  Vec3 center, half_extents{1, 1, 1};
  enum class Where { inside, outside } where = Where::outside;
};

struct KillDefs {
  std::vector<KillPlaneDef> kill_planes;
  std::vector<KillBoxDef> kill_boxes;
  bool any_regions() const { return !kill_planes.empty() || !kill_boxes.empty(); }
};

const DefTable& kill_plane_table();
const DefTable& kill_box_table();

/// The rows of a def that has both members.
template <class D>
TableOf<D>& add_kill_rows(TableOf<D>& table) {
  std::vector<KillPlaneDef> D::*planes = &KillDefs::kill_planes;
  std::vector<KillBoxDef> D::*boxes = &KillDefs::kill_boxes;
  return table
      .objects("kill_planes", planes, kill_plane_table(), {0, 64}, "planes below which particles are removed")
      .objects("kill_boxes", boxes, kill_box_table(), {0, 64},
               "boxes inside or outside of which particles are removed");
}

/// Sets flag[i] for i in [begin, end) where at(i), a Vec3, is in a region; leaves other flags unchanged.
template <class At>
void flag_killed(const KillDefs& d, size_t begin, size_t end, const At& at, uint8_t* flag) {
  for (const KillPlaneDef& k : d.kill_planes) {
    const double level = dot(k.normal, k.point);
    for (size_t i = begin; i < end; ++i) flag[i] |= dot(k.normal, at(i)) < level;
  }
  for (const KillBoxDef& k : d.kill_boxes) {
    const Vec3 low = k.center - k.half_extents, high = k.center + k.half_extents;
    const bool kills_inside = k.where == KillBoxDef::Where::inside;
    for (size_t i = begin; i < end; ++i) {
      const Vec3 p = at(i);
      const bool inside =
          (p.x > low.x) & (p.y > low.y) & (p.z > low.z) & (p.x < high.x) & (p.y < high.y) & (p.z < high.z);
      flag[i] |= inside == kills_inside;
    }
  }
}

}  // namespace truestep
