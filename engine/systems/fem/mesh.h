// Nodes, elements, surface and named sets of a body at rest.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "engine/systems/fem/fem_def.h"

namespace truestep::fem {

/// A face of an element that no other element has.
struct Facet {
  uint32_t cell, face;
};

struct Mesh {
  const Element* kind = nullptr;
  std::vector<Vec3> x;          ///< m; of second order: corners first
  std::vector<uint32_t> nodes;  ///< of element k from k * kind->size()
  std::vector<Facet> surface;
  struct Set {
    std::string name;
    std::vector<uint32_t> nodes;  ///< ascending
  };
  std::vector<Set> sets;

  size_t cells() const { return nodes.size() / kind->size(); }
  std::span<const uint32_t> cell(size_t k) const { return {nodes.data() + k * kind->size(), kind->size()}; }
  /// Nodes of a facet in the order of its face.
  uint32_t facet_node(const Facet& f, size_t a) const { return cell(f.cell)[kind->faces[f.face].nodes[a]]; }
  const Set* find(std::string_view name) const;
  /// Facets all of whose nodes belong to a set.
  std::vector<Facet> facets_of(const Set& set) const;
  /// m, of the box around all nodes.
  double diagonal() const;
  /// Triangles to draw: the surface, or a plane body itself.
  std::vector<std::array<uint32_t, 3>> triangles() const;
};

Mesh build_mesh(const FemDef& def);

/// d x / d xi at a point of the rule and its determinant (area or volume over the reference one).
struct Jacobian {
  Mat3 j;
  double size;
};
Jacobian jacobian(const Mesh& mesh, size_t cell, size_t point);
/// The first element that is turned inside out or has no size somewhere; npos: none.
size_t first_bad_cell(const Mesh& mesh);

}  // namespace truestep::fem
