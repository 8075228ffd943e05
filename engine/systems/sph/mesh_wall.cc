#include "engine/systems/sph/mesh_wall.h"

#include <algorithm>
#include <cmath>

namespace truestep::sph {
namespace {

VolumeMap::Kernel kernel_of(const SphDef& d) {
  return {d.kernel, d.support * d.spacing, d.spacing};
}

/// The part of a mesh's own bounds, in its frame, near which there can be liquid: next to it, or to an image
/// of it.
Box wet_part(const SphDef& d, const Box& mesh, const Pose& start, const ShapeMotion& motion) {
  if (!motion.at_rest()) return mesh;
  const Transform frame = transform_of(start);
  Box liquid = Box::nothing();
  const Vec3 size = d.high - d.low,
             more{d.wraps(0) ? size.x : 0, d.wraps(1) ? size.y : 0, d.wraps(2) ? size.z : 0};
  const Vec3 low = d.low - more, high = d.high + more;
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner{k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z};
    liquid.cover(frame.inverse_point(corner));
  }
  // Up to where a kernel at the liquid's border reaches.
  liquid = liquid.grown((d.support + 2) * d.spacing);
  const auto within = [](double low, double high, double from, double to, double* out) {
    out[0] = std::min(std::max(low, from), to), out[1] = std::max(std::min(high, to), out[0]);
  };
  double x[2], y[2], z[2];
  within(mesh.low.x, mesh.high.x, liquid.low.x, liquid.high.x, x);
  within(mesh.low.y, mesh.high.y, liquid.low.y, liquid.high.y, y);
  within(mesh.low.z, mesh.high.z, liquid.low.z, liquid.high.z, z);
  return {{x[0], y[0], z[0]}, {x[1], y[1], z[1]}};
}

/// For a mesh, or without one for ground, which may be anywhere in the box.
double least_nodes(const SphDef& d, const MeshColliderDef* mesh) {
  Box region = Box{d.low, d.high}.grown((d.support + 2) * d.spacing);
  if (mesh) {
    Box box = Box::nothing();
    for (const Vec3& v : mesh->vertices) box.cover(v);
    const Pose start{mesh->center, turned_by(mesh->axis, mesh->angle)};
    region = wet_part(d, box, start, common_collider(*mesh).motion);
  }
  return VolumeMap::least_nodes(region, kernel_of(d));
}

/// Whether points far from a mesh are behind it, asked for row after row: a point close to the one before is
/// on the same side.
class FarSide {
 public:
  explicit FarSide(const MeshWall& wall, double support)
      : wall_(wall), support_(support), frame_(wall.collider.place(0)) {
    const Box box = bounds(wall.collider.solid, Transform{rotation(Quat{}), {}});
    whole_ = 2 * norm(box.high - box.low);
    box_ = box;
  }
  bool behind(const Vec3& p) {
    for (const Known* k : {&last_, &row_}) {
      if (k->known && norm(p - k->place) < support_) return remember(p, k->behind, k == &row_);
    }
    const bool held = wall_.collider.side == PointSide::inside;
    const Vec3 local = frame_.inverse_point(p);
    bool out = held;
    if (box_.overlaps({local, local})) {
      const auto d = point_distance(wall_.collider.solid, local, whole_, MeshSides::enclosed);
      if (d) out = held ? d->distance > 0 : d->distance < 0;
    }
    return remember(p, out, true);
  }

 private:
  struct Known {
    Vec3 place;
    bool behind = false, known = false;
  };
  bool remember(const Vec3& p, bool behind, bool row) {
    last_ = {p, behind, true};
    if (row) row_ = last_;
    return behind;
  }
  const MeshWall& wall_;
  double support_, whole_ = 0;
  Transform frame_;
  Box box_;
  Known last_, row_;
};

}  // namespace

std::optional<MeshWall::Surface> MeshWall::surface(const Vec3& x, double t, double in_front,
                                                   double behind) const {
  const Transform frame = collider.place(t);
  const Vec3 local = frame.inverse_point(x);
  const auto bound = map->distance_at(local);
  if (!bound || bound->least > in_front || bound->most < -behind) return std::nullopt;
  const double within = std::min(std::max(-bound->least, bound->most), std::max(in_front, behind));
  const auto d = point_distance(collider.solid, local, within, MeshSides::enclosed);
  const double side = collider.side == PointSide::outside ? 1 : -1;
  if (!d || side * d->distance > in_front || side * d->distance < -behind) return std::nullopt;
  return Surface{side * d->distance, frame.direction(d->normal) * side};
}

std::optional<MeshWall::At> MeshWall::at(const Vec3& x, double t, const HalfSpace& table,
                                         double support) const {
  const auto near = surface(x, t, support, support);
  if (!near) return std::nullopt;
  const Transform frame = collider.place(t);
  const Vec3 local = frame.inverse_point(x);
  const HalfSpace::At flat = table.at(near->distance);
  const VolumeMap::At shape = map->at(local, frame.inverse_direction(near->normal));
  At out{.surface = *near, .across = map->lean_at(local) * flat.slope, .axes = frame.rotation};
  out.share = std::clamp(flat.share * shape.share, 0.0, 1.0);
  out.slope = frame.direction(shape.slope) * flat.slope;
  out.full = std::max(-dot(shape.slope, frame.inverse_direction(near->normal)), 0.0);
  out.velocity = collider.velocity_at(x, t);
  return out;
}

std::vector<MeshWall> build_mesh_walls(const SphDef& d) {
  std::vector<MeshWall> out;
  const double support = d.support * d.spacing;
  // Ground must extend beyond everything in the box.
  const double around = norm(d.high - d.low) + 4 * support;
  for (SolidCollider& c : build_solid_colliders(d.colliders, around)) {
    const Box box = bounds(c.solid, Transform{rotation(Quat{}), {}});
    const Box region = wet_part(d, box, c.start, c.motion);
    auto map = std::make_shared<const VolumeMap>(c.solid, kernel_of(d), region, c.side);
    MeshWall wall{.collider = std::move(c), .map = std::move(map)};
    wall.radius = bounding_radius(wall.collider.solid);
    if (wall.collider.side == PointSide::outside && wall.collider.solid.kind == SolidKind::mesh)
      wall.images = images_of(d, bounds(wall.collider.solid, wall.collider.place(0)));
    out.push_back(std::move(wall));
  }
  return out;
}

void check_mesh_walls(const SphDef& d, const DefTable::Report& report) {
  for (size_t k = 0; k < d.colliders.size(); ++k) {
    const auto* mesh = std::get_if<MeshColliderDef>(&d.colliders[k]);
    const std::string at = "/colliders/" + std::to_string(k);
    if (!mesh && !std::holds_alternative<HeightFieldColliderDef>(d.colliders[k])) continue;
    if (d.dimension == 2) {
      report(at + "/type", "a plane system takes plane, box, sphere and capsule");
      continue;
    }
    if (least_nodes(d, mesh) > VolumeMap::kMostNodes) {
      report(at,
             "is larger than eight million cubes of the spacing: use a larger spacing, or a smaller mesh");
    }
  }
}

double bytes_of_mesh_walls(const SphDef& d) {
  // Bytes: a node's slot, and the 44 of its data for one node in eleven, measured on ground and a boulder.
  // Two more numbers a node are gone when the map is built, before the liquid takes its memory.
  constexpr double kPerNode = 4 + 4;
  double out = 0;
  for (const AnyColliderDef& c : d.colliders) {
    const auto* mesh = std::get_if<MeshColliderDef>(&c);
    if (!mesh && !std::holds_alternative<HeightFieldColliderDef>(c)) continue;
    out += kPerNode * std::min(8 * least_nodes(d, mesh), VolumeMap::kMostNodes);
  }
  return out;
}

void leave_dry(const SphDef& d, const std::vector<MeshWall>& walls, std::vector<Vec3>& places) {
  const double support = d.support * d.spacing;
  for (const MeshWall& wall : walls) {
    each_in_box(d, wall.images, wall.collider.start.position, wall.radius, [&](const Vec3& shift) {
      FarSide far(wall, support);
      std::erase_if(places, [&](const Vec3& p) {
        const auto near = wall.surface(p - shift, 0, support, support);
        return near ? near->distance < 0 : far.behind(p - shift);
      });
    });
  }
}

}  // namespace truestep::sph
