// Nodes, elements, surface and named sets of a body at rest.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/systems/fem/fem_def.h"

namespace truestep::fem {

/// A face that belongs to one element only; for a sheet, a whole element.
struct Facet {
  static constexpr uint32_t kWhole = 0xffffffff;
  uint32_t cell, face;
};

struct Mesh {
  const Element* kind = nullptr;
  std::vector<Vec3> x;          ///< m; for second order: corners first
  std::vector<uint32_t> nodes;  ///< of element k from k * kind->size()
  bool sheet = false;           ///< elements of two dimensions, in space
  std::vector<Facet> surface;
  std::vector<Facet> rim;  ///< for a sheet: edges that belong to one element
  struct Set {
    std::string name;
    std::vector<uint32_t> nodes;  ///< ascending
  };
  std::vector<Set> sets;

  size_t cells() const { return nodes.size() / kind->size(); }
  std::span<const uint32_t> cell(size_t k) const { return {nodes.data() + k * kind->size(), kind->size()}; }
  /// Nodes of a facet in the order of its face.
  uint32_t facet_node(const Facet& f, size_t a) const {
    return cell(f.cell)[f.face == Facet::kWhole ? a : kind->faces[f.face].nodes[a]];
  }
  const Element& facet_kind(const Facet& f) const {
    return f.face == Facet::kWhole ? *kind : *kind->faces[f.face].kind;
  }
  const Set* find(std::string_view name) const;
  /// Facets all of whose nodes belong to a set; for a sheet without any, edges of its rim.
  std::vector<Facet> facets_of(const Set& set) const;
  /// m, diagonal of the box around all nodes.
  double diagonal() const;
  /// Triangles to draw: the surface, or a plane body itself.
  std::vector<std::array<uint32_t, 3>> triangles() const;
  /// The element that each of them belongs to.
  std::vector<uint32_t> triangle_cells() const;
};

Mesh build_mesh(const FemDef& def);

/// d x / d xi at a quadrature point and its determinant (area or volume over the reference one). For a sheet,
/// x is measured in the sheet's plane, with the first axis along the image of xi.
struct Jacobian {
  Mat3 j;
  double size;
};
Jacobian jacobian(const Mesh& mesh, size_t cell, size_t point);
/// Three elements that share a face (an edge in the plane), which can have only two sides; nothing if there
/// are none.
std::optional<std::array<size_t, 3>> first_crowded_face(const Mesh& mesh);
/// The first element that is inverted or has zero size at a point; npos: none.
size_t first_bad_cell(const Mesh& mesh);

}  // namespace truestep::fem
