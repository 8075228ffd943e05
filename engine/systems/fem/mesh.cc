#include "engine/systems/fem/mesh.h"

#include <algorithm>
#include <map>

#include "engine/geometry/box.h"
#include "engine/geometry/make/soft_block.h"
#include "engine/math/quaternion.h"
#include "engine/math/trig.h"

namespace truestep::fem {

namespace {

using Bits = std::vector<std::pair<std::string, std::vector<uint8_t>>>;

// Corners alone, with the sets that they belong to.
struct Coarse {
  std::vector<Vec3> x;
  std::vector<uint32_t> nodes;
  Bits sets;
};

// Points of a set, ascending.
std::vector<uint32_t> points_of(const SetDef& d, const std::vector<Vec3>& points) {
  std::vector<uint32_t> out;
  for (const int64_t p : d.points) out.push_back(static_cast<uint32_t>(p));
  for (uint32_t p = 0; (d.low || d.high) && p < points.size(); ++p) {
    const Vec3 &x = points[p], low = d.low.value_or(x), high = d.high.value_or(x);
    const bool in =
        low.x <= x.x && x.x <= high.x && low.y <= x.y && x.y <= high.y && low.z <= x.z && x.z <= high.z;
    if (in) out.push_back(p);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

void add_lattice_sets(const std::array<uint32_t, 3>& counts, int dimension, Bits& out) {
  const char* names[] = {"x0", "x1", "y0", "y1", "z0", "z1"};
  const uint32_t n = counts[0] * counts[1] * counts[2];
  for (int side = 0; side < 2 * dimension; ++side) {
    std::vector<uint8_t> in(n, 0);
    for (uint32_t p = 0; p < n; ++p) {
      const uint32_t at[] = {p % counts[0], p / counts[0] % counts[1], p / counts[0] / counts[1]};
      in[p] = at[side / 2] == (side % 2 ? counts[static_cast<size_t>(side / 2)] - 1 : 0);
    }
    out.emplace_back(names[side], std::move(in));
  }
}

Coarse coarse_block(const SoftBlockShape& shape, const Element& kind) {
  SoftBlock block = make_soft_block(shape);
  Coarse out;
  out.x = std::move(block.x);
  const auto nx = static_cast<uint32_t>(shape.cells_x) + 1, ny = static_cast<uint32_t>(shape.cells_y) + 1,
             nz = static_cast<uint32_t>(shape.cells_z) + 1;
  if (kind.simplex) {
    for (const auto& t : block.tetrahedra) out.nodes.insert(out.nodes.end(), t.begin(), t.end());
  } else {
    for (uint32_t k = 0; k + 1 < nz; ++k) {
      for (uint32_t j = 0; j + 1 < ny; ++j) {
        for (uint32_t i = 0; i + 1 < nx; ++i) {
          const uint32_t p = (k * ny + j) * nx + i, up = nx * ny;
          for (const uint32_t q : {p, p + 1, p + 1 + nx, p + nx}) out.nodes.push_back(q);
          for (const uint32_t q : {p, p + 1, p + 1 + nx, p + nx}) out.nodes.push_back(q + up);
        }
      }
    }
  }
  add_lattice_sets({nx, ny, nz}, 3, out.sets);
  return out;
}

Coarse coarse_quad(const QuadShape& shape, const Element& kind) {
  const auto nx = static_cast<uint32_t>(shape.cells_x) + 1, ny = static_cast<uint32_t>(shape.cells_y) + 1;
  const auto& c = shape.corners;
  Coarse out;
  for (uint32_t j = 0; j < ny; ++j) {
    for (uint32_t i = 0; i < nx; ++i) {
      const double u = static_cast<double>(i) / shape.cells_x, v = static_cast<double>(j) / shape.cells_y;
      out.x.push_back((1 - v) * ((1 - u) * c[0] + u * c[1]) + v * ((1 - u) * c[3] + u * c[2]));
    }
  }
  for (uint32_t j = 0; j + 1 < ny; ++j) {
    for (uint32_t i = 0; i + 1 < nx; ++i) {
      const uint32_t p = j * nx + i, q[] = {p, p + 1, p + 1 + nx, p + nx};
      // Diagonals alternate, so that none is preferred.
      const std::vector<size_t> order = !kind.simplex      ? std::vector<size_t>{0, 1, 2, 3}
                                        : (i + j) % 2 == 0 ? std::vector<size_t>{0, 1, 2, 0, 2, 3}
                                                           : std::vector<size_t>{0, 1, 3, 1, 2, 3};
      for (const size_t k : order) out.nodes.push_back(q[k]);
    }
  }
  add_lattice_sets({nx, ny, 1}, 2, out.sets);
  return out;
}

// Repeats the mesh for every copy, one after another.
void multiply(const std::vector<CopyDef>& copies, Coarse& coarse) {
  if (copies.empty()) return;
  const Coarse one = std::move(coarse);
  coarse = {};
  for (const auto& [name, in] : one.sets) coarse.sets.emplace_back(name, std::vector<uint8_t>{});
  for (const CopyDef& c : copies) {
    const auto first = static_cast<uint32_t>(coarse.x.size());
    const auto [sine, cosine] = trig::sincos(0.5 * c.angle);
    const Vec3 axis = normalized(c.axis) * sine;
    const Rotation turn = rotation(Quat{cosine, axis.x, axis.y, axis.z});
    for (const Vec3& x : one.x) coarse.x.push_back(c.position + turn.apply(x));
    for (const uint32_t p : one.nodes) coarse.nodes.push_back(first + p);
    for (size_t k = 0; k < one.sets.size(); ++k) {
      const auto& in = one.sets[k].second;
      coarse.sets[k].second.insert(coarse.sets[k].second.end(), in.begin(), in.end());
    }
  }
}

// Adds nodes in the middles of edges, faces and cells, each once.
void elevate(const Coarse& coarse, Mesh& out, Bits& sets) {
  const Element& kind = *out.kind;
  std::map<std::vector<uint32_t>, uint32_t> known;
  const size_t cells = coarse.nodes.size() / kind.corners;
  for (size_t k = 0; k < cells; ++k) {
    const uint32_t* corners = coarse.nodes.data() + k * kind.corners;
    for (const auto& support : kind.supports) {
      if (support.size() == 1) {
        out.nodes.push_back(corners[support[0]]);
        continue;
      }
      std::vector<uint32_t> key;
      for (const uint32_t c : support) key.push_back(corners[c]);
      std::sort(key.begin(), key.end());
      const auto [at, fresh] = known.emplace(key, static_cast<uint32_t>(out.x.size()));
      if (fresh) {
        Vec3 middle;
        for (const uint32_t p : key) middle += coarse.x[p];
        out.x.push_back(middle / static_cast<double>(key.size()));
        for (auto& [name, in] : sets) {
          in.push_back(std::all_of(key.begin(), key.end(), [&](uint32_t p) { return in[p] != 0; }));
        }
      }
      out.nodes.push_back(at->second);
    }
  }
}

struct Face {
  std::vector<uint32_t> corners;  // ascending
  Facet facet;
};

// Faces of all elements, those with the same corners grouped in the order of their elements.
std::vector<Face> sorted_faces(const Mesh& mesh) {
  std::vector<Face> faces;
  for (uint32_t k = 0; k < mesh.cells(); ++k) {
    for (uint32_t f = 0; f < mesh.kind->faces.size(); ++f) {
      Face face{{}, {k, f}};
      const uint32_t corners = mesh.kind->faces[f].kind->corners;
      for (size_t a = 0; a < corners; ++a) face.corners.push_back(mesh.facet_node({k, f}, a));
      std::sort(face.corners.begin(), face.corners.end());
      faces.push_back(std::move(face));
    }
  }
  std::stable_sort(faces.begin(), faces.end(), [](auto& a, auto& b) { return a.corners < b.corners; });
  return faces;
}

// Faces that belong to one element only, in the order of the elements.
std::vector<Facet> outer_faces(const Mesh& mesh) {
  const std::vector<Face> faces = sorted_faces(mesh);
  std::vector<Facet> out;
  for (size_t i = 0; i < faces.size(); ++i) {
    const bool twin = (i > 0 && faces[i - 1].corners == faces[i].corners) ||
                      (i + 1 < faces.size() && faces[i + 1].corners == faces[i].corners);
    if (!twin) out.push_back(faces[i].facet);
  }
  std::sort(out.begin(), out.end(), [](const Facet& a, const Facet& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.face < b.face;
  });
  return out;
}

void add_sets(const FemDef& def, const Bits& sets, Mesh& mesh) {
  for (const auto& [name, in] : sets) {
    Mesh::Set set{name, {}};
    for (uint32_t p = 0; p < in.size(); ++p) {
      if (in[p]) set.nodes.push_back(p);
    }
    mesh.sets.push_back(std::move(set));
  }
  std::vector<uint32_t> border;
  for (const Facet& f : mesh.sheet ? mesh.rim : mesh.surface) {
    for (size_t a = 0; a < mesh.facet_kind(f).size(); ++a) border.push_back(mesh.facet_node(f, a));
  }
  std::sort(border.begin(), border.end());
  border.erase(std::unique(border.begin(), border.end()), border.end());
  mesh.sets.push_back({"border", std::move(border)});
  mesh.sets.push_back({"all", {}});
  for (uint32_t p = 0; p < mesh.x.size(); ++p) mesh.sets.back().nodes.push_back(p);
  for (const SetDef& d : def.sets) {
    Mesh::Set set{d.name, points_of(d, mesh.x)};
    mesh.sets.push_back(std::move(set));
  }
}

}  // namespace

const Mesh::Set* Mesh::find(std::string_view name) const {
  if (name == "bottom") name = "y0";
  if (name == "top") name = "y1";
  for (const Set& s : sets) {
    if (s.name == name) return &s;
  }
  return nullptr;
}

std::vector<Facet> Mesh::facets_of(const Set& set) const {
  std::vector<uint8_t> in(x.size(), 0);
  for (const uint32_t p : set.nodes) in[p] = 1;
  std::vector<Facet> out;
  const auto add_inside = [&](const std::vector<Facet>& facets) {
    for (const Facet& f : facets) {
      bool all = true;
      for (size_t a = 0; a < facet_kind(f).size(); ++a) all = all && in[facet_node(f, a)];
      if (all) out.push_back(f);
    }
  };
  add_inside(surface);
  if (out.empty()) add_inside(rim);
  return out;
}

double Mesh::diagonal() const {
  Box box = Box::nothing();
  for (const Vec3& p : x) box.cover(p);
  return norm(box.high - box.low);
}

std::vector<std::array<uint32_t, 3>> Mesh::triangles() const {
  std::vector<std::array<uint32_t, 3>> out;
  if (kind->dimension == 2) {
    for (size_t k = 0; k < cells(); ++k) {
      for (const auto& t : kind->triangles) out.push_back({cell(k)[t[0]], cell(k)[t[1]], cell(k)[t[2]]});
    }
    return out;
  }
  for (const Facet& f : surface) {
    for (const auto& t : kind->faces[f.face].kind->triangles) {
      out.push_back({facet_node(f, t[0]), facet_node(f, t[1]), facet_node(f, t[2])});
    }
  }
  return out;
}

std::vector<uint32_t> Mesh::triangle_cells() const {
  std::vector<uint32_t> out;
  if (kind->dimension == 2) {
    for (uint32_t k = 0; k < cells(); ++k) out.insert(out.end(), kind->triangles.size(), k);
    return out;
  }
  for (const Facet& f : surface) out.insert(out.end(), kind->faces[f.face].kind->triangles.size(), f.cell);
  return out;
}

Mesh build_mesh(const FemDef& def) {
  Mesh out;
  out.kind = &element_of(kind_of(cell_of(def)));
  Coarse coarse;
  if (def.block) coarse = coarse_block(*def.block, *out.kind);
  if (def.quad) coarse = coarse_quad(*def.quad, *out.kind);
  if (def.mesh) {
    coarse.x = def.mesh->vertices;
    for (const int64_t p : def.mesh->cells) coarse.nodes.push_back(static_cast<uint32_t>(p));
    for (const SetDef& d : def.mesh->sets) {
      std::vector<uint8_t> in(coarse.x.size(), 0);
      for (const uint32_t p : points_of(d, coarse.x)) in[p] = 1;
      coarse.sets.emplace_back(d.name, std::move(in));
    }
  }
  if (def.fill) {
    Stuffing filled = stuff(*region_of(def), def.fill->spacing);
    coarse.x = std::move(filled.x);
    for (const auto& t : filled.tetrahedra) coarse.nodes.insert(coarse.nodes.end(), t.begin(), t.end());
  }
  multiply(def.copies, coarse);
  out.x = coarse.x;
  elevate(coarse, out, coarse.sets);
  out.sheet = is_sheet(def);
  out.surface = outer_faces(out);
  if (out.sheet) {
    out.rim = std::move(out.surface);
    out.surface.clear();
    for (uint32_t k = 0; k < out.cells(); ++k) out.surface.push_back({k, Facet::kWhole});
  }
  add_sets(def, coarse.sets, out);
  return out;
}

Jacobian jacobian(const Mesh& mesh, size_t cell, size_t point) {
  const Element& kind = *mesh.kind;
  const auto nodes = mesh.cell(cell);
  Jacobian out{};
  for (size_t a = 0; a < kind.size(); ++a) {
    const Vec3 &x = mesh.x[nodes[a]], &g = kind.gradient[point * kind.size() + a];
    const double xs[] = {x.x, x.y, x.z}, gs[] = {g.x, g.y, g.z};
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) out.j(r, c) += xs[r] * gs[c];
    }
  }
  if (mesh.sheet) {
    const Vec3 a = out.j.column(0), b = out.j.column(1), n = cross(a, b);
    if (!(norm2(n) > 0)) return out;
    const Vec3 e = normalized(a), f = normalized(cross(n, e));
    out.j = {{dot(a, e), dot(b, e), 0, 0, dot(b, f), 0, 0, 0, 0}};
  }
  if (kind.dimension == 2) out.j(2, 2) = 1;
  out.size = determinant(out.j);
  return out;
}

std::optional<std::array<size_t, 3>> first_crowded_face(const Mesh& mesh) {
  const std::vector<Face> faces = sorted_faces(mesh);
  for (size_t i = 2; i < faces.size(); ++i) {
    if (faces[i].corners != faces[i - 2].corners) continue;
    return std::array<size_t, 3>{faces[i - 2].facet.cell, faces[i - 1].facet.cell, faces[i].facet.cell};
  }
  return std::nullopt;
}

size_t first_bad_cell(const Mesh& mesh) {
  for (size_t k = 0; k < mesh.cells(); ++k) {
    // Relative to the element's own size, so that thin elements pass and flat ones do not.
    Vec3 low = mesh.x[mesh.cell(k)[0]], high = low;
    for (const uint32_t p : mesh.cell(k)) {
      const Vec3& x = mesh.x[p];
      low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
      high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    }
    const double length = norm(high - low);
    const double whole = mesh.kind->dimension == 2 ? length * length : length * length * length;
    for (size_t q = 0; q < mesh.kind->points.size(); ++q) {
      if (!(jacobian(mesh, k, q).size > 1e-12 * whole)) return k;
    }
  }
  return static_cast<size_t>(-1);
}

}  // namespace truestep::fem
