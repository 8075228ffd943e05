#include "engine/systems/xpbd/body.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/xpbd/dihedral.h"
#include "engine/kernels/xpbd/linear.h"
#include "engine/math/quaternion.h"
#include "engine/math/trig.h"

namespace truestep::xpbd {

namespace {

constexpr double kPi = 3.14159265358979323846;

/// A chain of links from row `first`; EI for its rods over three points each.
void add_chain(size_t first, size_t points, double link, const XpbdDef& def, Body& out) {
  const double section = kPi / 4 * def.thickness * def.thickness;
  const double factor = def.youngs_modulus ? section / link : 1;
  for (size_t i = first; i + 1 < first + points; ++i) {
    const auto a = static_cast<uint32_t>(i);
    out.links.push_back({a, a + 1, Family::structural, def.rest_scale * link, factor});
  }
  if (!(def.bending_rigidity > 0)) return;
  for (size_t i = first; i + 2 < first + points; ++i) {
    const auto a = static_cast<uint32_t>(i);
    out.rods.push_back({{a, a + 1, a + 2}, {1, -2, 1}, 1 / (link * link * link)});
  }
}

std::vector<double> build_rope(const RopeShape& shape, const Vec3& down, const XpbdDef& def, Body& out) {
  out.x = rope_points(shape, down);
  const double link = rope_link(shape);
  add_chain(0, out.x.size(), link, def, out);
  std::vector<double> share(out.x.size(), link);
  share.front() = share.back() = 0.5 * link;
  return share;
}

std::vector<double> build_helix(const HelixShape& shape, const XpbdDef& def, Body& out) {
  out.x = helix_points(shape);
  const double link = helix_link(shape);
  add_chain(0, out.x.size(), link, def, out);
  std::vector<double> share(out.x.size(), link);
  share.front() = share.back() = 0.5 * link;
  return share;
}

std::vector<double> build_hair(const HairShape& shape, const XpbdDef& def, Body& out) {
  out.x = hair_points(shape);
  const size_t points = static_cast<size_t>(shape.links) + 1;
  const double link = shape.length / shape.links;
  std::vector<double> share(out.x.size(), link);
  for (size_t first = 0; first < out.x.size(); first += points) {
    share[first + points - 1] = 0.5 * link;
    // Two held points fix the direction at the root; a Cosserat rod has its clamp for that.
    out.pins.push_back(static_cast<uint32_t>(first));
    if (!def.rod) out.pins.push_back(static_cast<uint32_t>(first + 1));
    add_chain(first, points, link, def, out);
  }
  return share;
}

/// Stiffness over E of a bar of weight w: w E t / (1 - nu^2) times its area over its length squared.
double membrane(double weight, double thickness, double area, double length2) {
  return 9.0 / 8 * weight * thickness * area / length2;
}

std::vector<double> build_grid(const ClothGridShape& shape, const XpbdDef& def, Body& out) {
  ClothGrid grid = make_cloth_grid(shape);
  out.x = std::move(grid.x), out.triangles = std::move(grid.triangles);
  const PlateWeights w = plate_weights(shape);
  const double cell = norm(cross(shape.edge_u, shape.edge_v)) / ((shape.nx - 1.0) * (shape.ny - 1.0));
  const auto nx = static_cast<uint32_t>(shape.nx), last = static_cast<uint32_t>(shape.ny - 1) * nx;
  const auto add = [&](Family family, int di, int dj, double weight) {
    const bool rods = def.youngs_modulus && !is_membrane(def);
    if (rods && !(weight > 0)) return;
    for (const auto& [a, b] : grid_pairs(shape, di, dj)) {
      const double length = norm(out.x[b] - out.x[a]);
      // A link on the border has a cell on one side only.
      const bool border =
          (dj == 0 && (a < nx || a >= last)) || (di == 0 && (a % nx == 0 || a % nx == nx - 1));
      const double factor = rods ? membrane(weight, def.thickness, border ? cell / 2 : cell, length * length)
                            : is_membrane(def) ? def.thickness
                                               : 1;
      out.links.push_back({a, b, family, def.rest_scale * length, factor});
    }
  };
  add(Family::structural, 1, 0, w.u);
  add(Family::structural, 0, 1, w.v);
  const bool modulus = def.youngs_modulus && !is_membrane(def);
  const bool shear = modulus || (def.shear_stiffness > 0 && shape.shear != ShearSprings::none);
  const bool both = modulus || shape.shear == ShearSprings::both;
  if (shear) add(Family::shear, 1, 1, w.diagonal);
  if (shear && both) add(Family::shear, -1, 1, w.diagonal);
  if (def.flexural_rigidity > 0) {
    for (const PlateRod& r : plate_rods(shape)) {
      if (!(r.weight > 0)) continue;
      out.rods.push_back(
          {r.points, {1, -2, 1}, r.weight * grid.share[r.points[1]] / (r.length2 * r.length2)});
    }
  }
  return grid.share;
}

/// Hinges of a flat mesh are linear; those of any other have a rest angle.
void add_hinges(const std::vector<std::array<uint32_t, 3>>& edges, Body& out) {
  constexpr double kFlat = 1e-6;
  const auto& x = out.x;
  double most = 0;
  for (size_t i = 1; i < edges.size(); ++i) {
    const auto &e = edges[i], &f = edges[i - 1];
    if (e[0] != f[0] || e[1] != f[1] || e[2] == f[2]) continue;
    const Hinge h = hinge(x[e[0]], x[e[1]], x[f[2]], x[e[2]]);
    if (!(h.area > 0)) continue;
    const double angle = dihedral(x[e[0]], x[e[1]], x[f[2]], x[e[2]]).angle;
    most = std::max(most, std::abs(angle));
    out.hinges.push_back({{e[0], e[1], f[2], e[2]}, h.k, 1 / h.area});
    out.angles.push_back({out.hinges.back().points, angle, norm2(x[e[1]] - x[e[0]]) / h.area});
  }
  if (most < kFlat) {
    out.angles.clear();
  } else {
    out.hinges.clear();
  }
}

std::vector<double> build_mesh(const MeshShape& shape, const XpbdDef& def, Body& out) {
  out.x = shape.vertices;
  out.triangles = mesh_triangles(shape);
  const auto edges = sorted_edges(out.triangles);
  const double factor = is_membrane(def) ? def.thickness : 1;
  for (size_t i = 0; i < edges.size(); ++i) {
    const auto& e = edges[i];
    if (i > 0 && edges[i - 1][0] == e[0] && edges[i - 1][1] == e[1]) continue;
    out.links.push_back(
        {e[0], e[1], Family::structural, def.rest_scale * norm(out.x[e[1]] - out.x[e[0]]), factor});
  }
  if (def.flexural_rigidity > 0) add_hinges(edges, out);
  return mesh_shares(shape);
}

std::vector<double> build_block(const SoftBlockShape& shape, const XpbdDef& def, Body& out) {
  SoftBlock block = make_soft_block(shape);
  out.x = std::move(block.x), out.triangles = std::move(block.triangles);
  for (const auto& [a, b] : block.edges) {
    out.links.push_back({a, b, Family::structural, def.rest_scale * norm(out.x[b] - out.x[a]), 1});
  }
  const double scale = def.rest_scale * def.rest_scale * def.rest_scale;
  for (const auto& t : block.tetrahedra) {
    const Vec3 &a = out.x[t[0]], &b = out.x[t[1]], &c = out.x[t[2]], &d = out.x[t[3]];
    const Vec3 e1 = b - a, e2 = c - a, e3 = d - a;
    const Mat3 edges{{e1.x, e2.x, e3.x, e1.y, e2.y, e3.y, e1.z, e2.z, e3.z}};
    const Mat3 inverse = (1 / (def.rest_scale * determinant(edges))) * transposed(cofactor(edges));
    out.tetrahedra.push_back({t, scale * dot(e1, cross(e2, e3)) / 6, inverse});
  }
  return block.share;
}

/// Repeats the body for every copy, one after another.
void multiply(const std::vector<CopyDef>& copies, std::vector<double>& share, Body& body) {
  if (copies.empty()) return;
  const Body one = std::move(body);
  const std::vector<double> shares = std::move(share);
  body = {}, share = {};
  for (const CopyDef& c : copies) {
    const auto first = static_cast<uint32_t>(body.x.size());
    const auto [sine, cosine] = trig::sincos(0.5 * c.angle);
    const Vec3 axis = normalized(c.axis) * sine;
    const Rotation turn = rotation(Quat{cosine, axis.x, axis.y, axis.z});
    for (const Vec3& x : one.x) body.x.push_back(c.position + turn.apply(x));
    body.velocities.insert(body.velocities.end(), one.x.size(), c.velocity);
    share.insert(share.end(), shares.begin(), shares.end());
    const auto add = [first](const auto& from, auto& to) {
      for (auto member : from) {
        for (uint32_t& p : member.points) p += first;
        to.push_back(member);
      }
    };
    for (Link l : one.links) l.a += first, l.b += first, body.links.push_back(l);
    for (auto t : one.triangles) body.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    add(one.hinges, body.hinges), add(one.angles, body.angles);
    // Tetrahedra keep rest edges in the copy's own frame: F then contains the copy's rotation, which stores
    // no energy.
    add(one.tetrahedra, body.tetrahedra);
  }
}

/// Triangles of zero area are left out of the membrane.
void build_sheet(const XpbdDef& def, Body& out) {
  const double scale = def.rest_scale;
  for (const auto& t : out.triangles) {
    const Vec3 e1 = (out.x[t[1]] - out.x[t[0]]) * scale, e2 = (out.x[t[2]] - out.x[t[0]]) * scale;
    const double area2 = norm(cross(e1, e2)), l1 = norm(e1);
    if (!(area2 > 0)) continue;
    // In-plane coordinates: e1 = (l1, 0), e2 = (c, area2 / l1).
    const double c = dot(e1, e2) / l1;
    out.sheet.push_back({t, 0.5 * area2 * def.thickness, {1 / l1, -c / area2, 0, l1 / area2}});
  }
}

void add_named_pins(const XpbdDef& def, const std::string& name, Body& out) {
  const auto n = static_cast<uint32_t>(out.x.size());
  if (def.cloth_grid) {
    const auto rows = named_grid_points(*def.cloth_grid, name);
    out.pins.insert(out.pins.end(), rows.begin(), rows.end());
  }
  if (def.block) {
    const auto& b = *def.block;
    const auto nx = static_cast<uint32_t>(b.cells_x) + 1, ny = static_cast<uint32_t>(b.cells_y) + 1,
               nz = static_cast<uint32_t>(b.cells_z) + 1;
    for (uint32_t p = 0; p < n; ++p) {
      const uint32_t i = p % nx, j = p / nx % ny, k = p / nx / ny % nz;
      if ((name == "bottom" && j == 0) || (name == "top" && j + 1 == ny) || (name == "x0" && i == 0) ||
          (name == "x1" && i + 1 == nx) || (name == "z0" && k == 0) || (name == "z1" && k + 1 == nz)) {
        out.pins.push_back(p);
      }
    }
  }
  if (name == "first" || name == "ends") out.pins.push_back(0);
  if (name == "last" || name == "ends") out.pins.push_back(n - 1);
}

}  // namespace

std::array<Vec3, 2> deformation(const SheetTriangle& t, const double* x) {
  const Vec3 o = load3(x, t.points[0]), e1 = load3(x, t.points[1]) - o, e2 = load3(x, t.points[2]) - o;
  return {e1 * t.inverse[0] + e2 * t.inverse[2], e1 * t.inverse[1] + e2 * t.inverse[3]};
}

Body build_body(const XpbdDef& def, const Vec3& down) {
  Body out;
  std::vector<double> share;
  if (def.rope) share = build_rope(*def.rope, down, def, out);
  if (def.helix) share = build_helix(*def.helix, def, out);
  if (def.hair) share = build_hair(*def.hair, def, out);
  if (def.cloth_grid) share = build_grid(*def.cloth_grid, def, out);
  if (def.mesh) share = build_mesh(*def.mesh, def, out);
  if (def.block) share = build_block(*def.block, def, out);

  multiply(def.copies, share, out);
  if (is_membrane(def)) build_sheet(def, out);

  // A vertex of no triangle has no share of the area: it gets the mass of a point instead.
  for (const double s : share) out.masses.push_back(def.density && s > 0 ? s * *def.density : def.mass);
  for (const LoadDef& l : def.loads) out.masses[static_cast<size_t>(l.point)] += l.mass;

  for (const int64_t i : def.pins) out.pins.push_back(static_cast<uint32_t>(i));
  for (const std::string& name : def.pinned) add_named_pins(def, name, out);
  if (def.rod && !def.hair) {
    for (const std::string& name : def.rod->clamped) add_named_pins(def, name, out);
  }
  std::sort(out.pins.begin(), out.pins.end());
  out.pins.erase(std::unique(out.pins.begin(), out.pins.end()), out.pins.end());

  out.capacity = out.x.size();
  if (def.tear)
    out.capacity += static_cast<size_t>(def.tear->most_splits.value_or(static_cast<int64_t>(out.x.size())));

  out.stiffness = {def.youngs_modulus.value_or(def.stiffness),
                   def.youngs_modulus.value_or(def.shear_stiffness),
                   def.rope || def.helix || def.hair ? def.bending_rigidity : def.flexural_rigidity,
                   def.block && def.youngs_modulus ? *def.youngs_modulus : def.bulk_modulus};
  return out;
}

}  // namespace truestep::xpbd
