#include "engine/geometry/read/msh.h"

#include <algorithm>
#include <span>

#include "engine/geometry/read/msh_sections.h"

namespace truestep {

namespace {

constexpr uint32_t kUnused = 0xffffffff;
constexpr const char* kEntityNames[] = {"point_", "curve_", "surface_", "volume_"};
constexpr const char* kFormNames[] = {"triangles", "quadrangles", "tetrahedra", "hexahedra"};
constexpr uint8_t kTypeOf[] = {2, 3, 4, 5};  // Gmsh's, by form

[[noreturn]] void fail(std::string_view text, const std::string& message) {
  const auto lines = static_cast<size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  throw MeshFault(MeshFault::Unit::line, lines, message);
}

// The form of the elements of highest dimension, which must be the same for all.
CellForm form_of(const MshSections& file, std::string_view text) {
  bool has[4] = {};
  for (const MshElement& e : file.elements) {
    for (size_t f = 0; f < 4; ++f) has[f] = has[f] || e.type == kTypeOf[f];
  }
  const size_t low = has[2] || has[3] ? 2 : 0;
  if (!has[low] && !has[low + 1])
    fail(text, "the file has no triangles, quadrangles, tetrahedra or hexahedra");
  if (has[low] && has[low + 1]) {
    fail(text, std::string("the file has ") + kFormNames[low] + " and " + kFormNames[low + 1] +
                   ": a mesh must consist of one form");
  }
  return static_cast<CellForm>(has[low] ? low : low + 1);
}

void add_groups(const MshSections& file, const std::vector<uint32_t>& kept, CellFile& out) {
  std::map<MshSections::Group, std::vector<uint32_t>> members;
  for (const MshElement& e : file.elements) {
    for (const MshSections::Group& g : file.entities[e.entity]) {
      for (size_t a = 0; a < msh_corners(e.type); ++a) {
        const uint32_t p = kept[file.corners[e.first + a]];
        if (p != kUnused) members[g].push_back(p);
      }
    }
  }
  for (auto& [group, vertices] : members) {
    const auto name = file.names.find(group);
    const std::string text =
        name != file.names.end() ? name->second : kEntityNames[group.first] + std::to_string(group.second);
    auto same =
        std::find_if(out.groups.begin(), out.groups.end(), [&](const auto& g) { return g.name == text; });
    if (same == out.groups.end()) same = out.groups.insert(same, {text, {}});
    same->vertices.insert(same->vertices.end(), vertices.begin(), vertices.end());
    std::sort(same->vertices.begin(), same->vertices.end());
    same->vertices.erase(std::unique(same->vertices.begin(), same->vertices.end()), same->vertices.end());
  }
}

}  // namespace

size_t corners_of(CellForm form) {
  return msh_corners(kTypeOf[static_cast<size_t>(form)]);
}

const char* name_of(CellForm form) {
  return kFormNames[static_cast<size_t>(form)];
}

CellFile read_msh(std::string_view text) {
  const MshSections file = read_msh_sections(text);
  CellFile out;
  out.form = form_of(file, text);
  const uint8_t type = kTypeOf[static_cast<size_t>(out.form)];
  const size_t corners = corners_of(out.form);
  std::vector<uint32_t> kept(file.nodes.size(), kUnused);
  const auto each_corner = [&](auto visit) {
    for (const MshElement& e : file.elements) {
      for (size_t a = 0; e.type == type && a < corners; ++a) visit(file.corners[e.first + a]);
    }
  };
  each_corner([&](uint32_t p) { kept[p] = 0; });
  for (size_t p = 0; p < kept.size(); ++p) {
    if (kept[p] == kUnused) continue;
    kept[p] = static_cast<uint32_t>(out.vertices.size());
    out.vertices.push_back(file.nodes[p]);
  }
  each_corner([&](uint32_t p) { out.cells.push_back(kept[p]); });
  add_groups(file, kept, out);
  return out;
}

SurfaceFile surface_of(const CellFile& mesh) {
  using Face = std::array<uint32_t, 4>;
  // Corners of faces, anticlockwise as seen from outside; a triangle repeats its last one.
  constexpr Face kTetrahedron[] = {{0, 2, 1, 1}, {0, 1, 3, 3}, {1, 2, 3, 3}, {0, 3, 2, 2}};
  constexpr Face kHexahedron[] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                  {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  constexpr Face kTriangle[] = {{0, 1, 2, 2}}, kQuadrangle[] = {{0, 1, 2, 3}};
  const std::span<const Face> sides[] = {kTriangle, kQuadrangle, kTetrahedron, kHexahedron};
  const size_t corners = corners_of(mesh.form);
  struct Known {
    Face key, face;
    size_t order;
  };
  std::vector<Known> faces;
  for (size_t k = 0; k < mesh.cells.size(); k += corners) {
    for (const Face& side : sides[static_cast<size_t>(mesh.form)]) {
      Known f{{}, {}, faces.size()};
      for (size_t a = 0; a < 4; ++a) f.face[a] = mesh.cells[k + side[a]];
      f.key = f.face;
      if (f.key[3] == f.key[2]) f.key[3] = kUnused;
      std::sort(f.key.begin(), f.key.end());
      faces.push_back(f);
    }
  }
  const bool solid = mesh.form >= CellForm::tetrahedra;
  if (solid) {
    // Faces shared by two elements are inside.
    std::sort(faces.begin(), faces.end(), [](const Known& a, const Known& b) {
      return a.key != b.key ? a.key < b.key : a.order < b.order;
    });
    std::vector<Known> border;
    for (size_t i = 0; i < faces.size();) {
      size_t end = i + 1;
      while (end < faces.size() && faces[end].key == faces[i].key) ++end;
      if (end == i + 1) border.push_back(faces[i]);
      i = end;
    }
    std::sort(border.begin(), border.end(), [](const Known& a, const Known& b) { return a.order < b.order; });
    faces = std::move(border);
  }
  SurfaceFile out;
  std::vector<uint32_t> kept(mesh.vertices.size(), kUnused);
  for (const Known& f : faces) {
    for (const uint32_t p : f.face) kept[p] = 0;
  }
  for (size_t p = 0; p < kept.size(); ++p) {
    if (kept[p] == kUnused) continue;
    kept[p] = static_cast<uint32_t>(out.vertices.size());
    out.vertices.push_back(mesh.vertices[p]);
  }
  for (const Known& f : faces) {
    const auto p = [&](size_t a) { return kept[f.face[a]]; };
    if (f.face[3] == f.face[2]) {
      out.triangles.push_back({p(0), p(1), p(2)});
      continue;
    }
    // The diagonal from the first corner, unless it runs outside of the quadrangle.
    const auto half = [&](size_t a, size_t b, size_t c) {
      const Vec3& x = out.vertices[p(a)];
      return cross(out.vertices[p(b)] - x, out.vertices[p(c)] - x);
    };
    const size_t from = dot(half(0, 1, 2), half(0, 2, 3)) < 0 ? 1 : 0;
    out.triangles.push_back({p(from), p(from + 1), p(from + 2)});
    out.triangles.push_back({p(from), p(from + 2), p((from + 3) % 4)});
  }
  return out;
}

}  // namespace truestep
