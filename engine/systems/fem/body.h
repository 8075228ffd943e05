// The constant part of a body: mesh, gradients of the shape functions at rest, masses, loads, holds and the
// order in which elements are assembled.
#pragma once
#include "engine/math/block_sparse.h"
#include "engine/math/expression/rows.h"
#include "engine/systems/fem/bending.h"
#include "engine/systems/fem/mesh.h"

namespace truestep::fem {

/// Displacements of a set of nodes; component c is prescribed if bit c of `axes` is set.
struct Hold {
  std::vector<uint32_t> nodes;
  uint8_t axes = 0;
  ExpressionRows displacement;  ///< of the prescribed components, in order; variables t, X, Y, Z
};

struct PressureFacet {
  Facet facet;
  double pressure;  ///< Pa
};

struct Body {
  Mesh mesh;
  bool plane = false, plane_stress = false, mean_volume = false;
  double thickness = 1;              ///< m, for a plane body or a sheet
  std::vector<Vec3> gradients;       ///< dN_a / dX, 1/m, at [(cell * points + q) * nodes + a]
  std::vector<double> weights;       ///< m^3 of point q, at [cell * points + q]
  size_t modes = 0;                  ///< incompatible modes of every element
  std::vector<Vec3> mode_gradients;  ///< 1/m, at [(cell * points + q) * modes + k]
  std::vector<double> masses;        ///< kg, lumped
  std::vector<double> loads;         ///< N, 3 a node: forces that keep their direction
  std::vector<PressureFacet> pressures;
  std::vector<Hold> holds;
  std::vector<uint8_t> axes;   ///< prescribed components of every node, as bits
  std::vector<uint32_t> pins;  ///< nodes held in all components, ascending
  struct Group {
    uint32_t begin, end;  ///< elements
  };
  std::vector<Group> groups;             ///< colour by colour: groups of one colour share no node
  std::vector<size_t> colours;           ///< where each colour begins in `groups`, and the end
  std::vector<BlockSparse::Pair> pairs;  ///< pairs of nodes with an element in common
  std::vector<BlockSparse::Slot>
      slots;  ///< for node pair (a, b) of a cell, at [(cell * nodes + a) * nodes + b]

  Bending bending;  ///< for a shell

  size_t points() const { return mesh.kind->points.size(); }
  size_t size() const { return mesh.kind->size(); }
};

/// Error "scene_invalid" for expressions that cannot be read and for holds that contradict each other.
Body build_body(const FemDef& def);

}  // namespace truestep::fem
