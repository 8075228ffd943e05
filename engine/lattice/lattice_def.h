// What scenes define about equations on a box: cells, size, sides, order in space; and the rows of their
// tables.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/def/def.h"
#include "engine/core/def/resolution.h"
#include "engine/core/equations/integrator_def.h"
#include "engine/lattice/box_sides.h"
#include "engine/lattice/divide_cells.h"
#include "engine/lattice/lattice.h"

namespace truestep::lattice {

struct SideDef {
  SideKind kind = SideKind::dirichlet;
  std::string value = "0";
  double transfer = 1;  ///< 1/m
};
using SidesDef = BoxSides<SideDef>;

struct LatticeDef : IntegratorParams {
  std::vector<int64_t> cells = {64};
  std::vector<double> size;    ///< m; empty: 1 along every axis
  std::optional<Vec3> origin;  ///< m, lower corner
  std::optional<SideDef> all;  ///< for sides that are not given individually
  SidesDef sides;
  enum class Order : uint8_t { second, fourth } order = Order::second;
  std::string initial = "0", source = "0";
  std::string exact;  ///< empty: not known
};

const DefTable& side_table();
/// Checks conditions that involve several members.
void check_lattice(const LatticeDef& d, const DefTable::Report& report);
/// `usual`: kind of the sides that are not given.
Lattice make_lattice(const LatticeDef& d, SideKind usual);
/// The text of a side's value; "0" if it is not given.
std::string side_value(const LatticeDef& d, size_t axis, size_t end);

/// Number of nodes, without overflow.
double lattice_nodes(const LatticeDef& d);

/// Bytes of a method's memory; `usual` is the method if the scene names none.
double lattice_workspace_bytes(const LatticeDef& d, std::string_view usual);
/// A step's cost from counts alone: typical numbers of evaluations and solves of the method (20 for an
/// adaptive one), each at its measured time per node. `usual` is the method if none is named.
double lattice_step_seconds(const LatticeDef& d, std::string_view usual);

/// For a struct D derived from LatticeDef.
template <class D>
const Resolution& resolution() {
  static const Resolution kCells{
      .parameter = "cells",
      .divide = [](void* d, double factor) { return divide_cells(static_cast<D*>(d)->cells, factor, 2); },
      .order =
          [](const void* d) { return static_cast<const D*>(d)->order == LatticeDef::Order::fourth ? 4 : 2; }};
  return kCells;
}

/// Adds the rows of LatticeDef to the table of a struct D derived from it.
template <class D>
TableOf<D>& add_lattice_rows(TableOf<D>& t, const char* initial_sentence, const char* source_sentence) {
  std::vector<int64_t> D::*cells = &LatticeDef::cells;
  std::vector<double> D::*size = &LatticeDef::size;
  std::optional<Vec3> D::*origin = &LatticeDef::origin;
  std::optional<SideDef> D::*all = &LatticeDef::all;
  SidesDef D::*sides = &LatticeDef::sides;
  LatticeDef::Order D::*order = &LatticeDef::order;
  std::string D::*initial = &LatticeDef::initial;
  std::string D::*source = &LatticeDef::source;
  std::string D::*exact = &LatticeDef::exact;
  return t
      .integers("cells", cells, between(2, 1e7), {1, 3},
                "cells along x, y and z, as many numbers as the box has dimensions; nodes lie between cells "
                "and on the sides")
      .required()
      .numbers("size", size, "m", above(0), {0, 3}, "lengths of the box; absent: 1 along every axis")
      .vector("origin", origin, "m", any(), "lower corner of the box")
      .object("side", all, side_table(), "all sides without their own entry in `sides`")
      .object("sides", sides, box_sides_table<SideDef>(side_table()), "individual sides")
      .choice("order", order, {"2", "4"},
              "of the error in space; 4 needs constant coefficients and no robin side")
      .expression("initial", initial, initial_sentence)
      .expression("source", source, source_sentence)
      .expression("exact", exact,
                  "the exact solution, an expression of x, y, z and t; observed as error.exact, the "
                  "difference from it");
}

}  // namespace truestep::lattice
