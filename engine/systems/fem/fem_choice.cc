#include "engine/systems/fem/fem_choice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/integrators/table/integrators.h"

namespace truestep::fem {

namespace {

// Nodes up to which second order is chosen, so that a scene of many cells stays as cheap as it asked to be;
// in motion, where every step is solved, fewer.
constexpr double kStillPlane = 20000, kMovingPlane = 5000, kStillSpace = 3000, kMovingSpace = 2000;
// Where Q2-P0 and pointwise quad9 err alike on Cook's membrane (4, 8 and 16 a side: by 4, 2 and 1 %).
constexpr double kRubber = 0.45;
// A body this much longer than thick bends rather than shears: its first-order error is that of bending.
constexpr double kSlender = 4;
constexpr double kStiff = 0.1, kMovingStiff = 0.05;
// Cells of second order bend into parabolas, along which they cannot keep their length.
constexpr double kLongCell = 20;

Cell first_order(const FemDef& d) {
  if (d.plane == Plane::shell && !d.block && !d.fill) return Cell::tri6;
  if (d.mesh) {
    constexpr Cell kFirst[] = {Cell::quad4, Cell::tri3, Cell::quad4, Cell::tet4, Cell::hex8};
    return kFirst[static_cast<size_t>(d.mesh->form)];
  }
  return d.block ? Cell::hex8 : d.fill ? Cell::tet4 : Cell::quad4;
}

Cell raised(Cell cell) {
  switch (cell) {
    case Cell::tri3:
      return Cell::tri6;
    case Cell::quad4:
      return Cell::quad9;
    case Cell::tet4:
      return Cell::tet10;
    case Cell::hex8:
      return Cell::hex27;
    default:
      return cell;
  }
}

bool is_first(Cell cell) {
  return raised(cell) != cell;
}
bool is_plane(Cell cell) {
  return element_of(kind_of(cell)).dimension == 2;
}
std::string name_of(Cell cell) {
  return cell_names()[static_cast<size_t>(cell)];
}
std::string stiffness_of(double excess) {
  return excess < 1 ? short_number(100 * excess, 2) + " % too stiffly"
                    : short_number(1 + excess, 2) + " times too stiffly";
}
std::string count_of(double nodes) {
  return std::to_string(static_cast<int64_t>(nodes)) + " nodes";
}

struct Side {
  double length;
  int cells;
};
// Of a block or a quad (its means), shortest first; none for others.
std::vector<Side> sides_of(const FemDef& d) {
  std::vector<Side> out;
  if (d.block) {
    const auto& b = *d.block;
    out = {{b.size.x, b.cells_x}, {b.size.y, b.cells_y}, {b.size.z, b.cells_z}};
  } else if (d.quad && d.quad->corners.size() == 4) {
    const auto& c = d.quad->corners;
    out = {{0.5 * (norm(c[1] - c[0]) + norm(c[2] - c[3])), d.quad->cells_x},
           {0.5 * (norm(c[3] - c[0]) + norm(c[2] - c[1])), d.quad->cells_y}};
  }
  std::stable_sort(out.begin(), out.end(), [](const Side& a, const Side& b) { return a.length < b.length; });
  return out;
}

bool slender(const std::vector<Side>& sides) {
  return !sides.empty() && sides.back().length >= kSlender * sides.front().length;
}
double longest_cell(const std::vector<Side>& sides) {
  double out = 0;
  for (size_t k = 1; k < sides.size(); ++k) out = std::max(out, sides[k].length / sides[k].cells);
  return out;
}

// Why second order is out of the question, or nothing.
std::string needs_first(const FemDef& d) {
  if (d.contact == Meeting::barrier) return "with a barrier every node is in the way of others";
  if (!d.pins.empty()) return "pins by index mean the corners of cells";
  for (const SetDef& s : d.sets) {
    if (!s.points.empty()) return "sets of indices mean the corners of cells";
  }
  if (d.incompatible_modes == Incompatible::wilson) return "it has incompatible modes";
  const Integrator* named = find_integrator(d.integrator);
  if (named && named->kind != Integrator::Kind::implicit)
    return "a method that does not solve its steps needs shorter ones in second order";
  return "";
}

bool resists_at_points(const FemDef& d, Cell cell) {
  const bool adapts = is_plane(cell) && d.plane != Plane::strain;
  return !adapts && volume_of(d) == Volume::pointwise;
}

}  // namespace

double bending_excess(const FemDef& d) {
  const std::vector<Side> sides = sides_of(d);
  if (sides.empty()) return 0;
  const double nu = d.poisson_ratio, slim = longest_cell(sides) / sides.front().length,
               across = sides.front().cells;
  return slim * slim / (2 * (1 + nu)) + nu * nu / ((1 - nu * nu) * across * across);
}

CellChoice choose_cell(const FemDef& d) {
  if (d.element != Cell::automatic) return {d.element, "named by the scene"};
  const Cell first = first_order(d), second = raised(first);
  if (first == second) return {first, "what a shell is made of"};
  if (is_plane(first) && d.plane >= Plane::membrane) return {first, "a membrane does not bend"};
  if (d.mesh && d.mesh->form == Form::as_element) return {first, ""};
  if (d.volume == Volume::mean && element_of(kind_of(first)).points.size() == 1)
    return {second, "of second order: volume mean needs several points"};
  const std::string why = needs_first(d);
  if (!why.empty()) return {first, "of first order: " + why};
  const bool moves = d.motion == Motion::dynamic, plane = is_plane(first);
  const double excess = bending_excess(d);
  if (moves && !plane) {
    const bool slim = slender(sides_of(d)), bends = slim && excess > kMovingStiff;
    const bool shears = first == Cell::tet4 && d.poisson_ratio >= kRubber;
    if (!bends && !shears)
      return {first, slim ? "of first order: that bends well enough here"
                          : "of first order: no thin body, in motion"};
  }
  const double most = plane ? (moves ? kMovingPlane : kStillPlane) : (moves ? kMovingSpace : kStillSpace);
  FemDef other = d;
  other.element = second;
  const double nodes = fem_counts(other).nodes;
  if (nodes > most)
    return {first, "of first order: " + name_of(second) + " would have some " + count_of(nodes)};
  if (excess > kMovingStiff)
    return {second, "of second order: " + name_of(first) + " would bend " + stiffness_of(excess)};
  return {second, "of second order: " + count_of(nodes) + " or so are few"};
}

Volume volume_of(const FemDef& d) {
  if (d.volume != Volume::automatic) return d.volume;
  const Cell cell = cell_of(d);
  const bool adapts = is_plane(cell) && d.plane != Plane::strain;
  const bool fits = d.incompatible_modes == Incompatible::none && d.integrator != "vertex_block_descent";
  const bool several = element_of(kind_of(cell)).points.size() > 1;
  return d.poisson_ratio >= kRubber && !adapts && fits && several ? Volume::mean : Volume::pointwise;
}

std::string volume_reason(const FemDef& d) {
  if (d.volume != Volume::automatic) return "named by the scene";
  std::string nu = "Poisson's ratio is " + short_number(d.poisson_ratio, 5);
  if (volume_of(d) == Volume::mean) return nu;
  if (d.poisson_ratio < kRubber) return nu;
  return "another treatment is not for these elements";
}

std::vector<Warning> locking_of(const FemDef& d) {
  std::vector<Warning> out;
  const Cell cell = cell_of(d);
  if (is_plane(cell) && d.plane >= Plane::membrane) return out;
  const std::vector<Side> sides = sides_of(d);
  const std::string more = name_of(raised(cell));
  const double excess = bending_excess(d), slim = sides.empty() ? 0 : longest_cell(sides) / sides[0].length;
  const bool stiff = is_first(cell) && slender(sides) && d.incompatible_modes == Incompatible::none;
  if (stiff && excess > kStiff) {
    out.push_back({.quantity = "locking.bending",
                   .value = excess,
                   .limit = kStiff,
                   .detail = name_of(cell) + " bends " + stiffness_of(excess) + " here (cells " +
                             short_number(slim, 3) + " times as long as the body is thick): element " + more +
                             " does not"});
  }
  if (!is_first(cell) && slim > kLongCell) {
    out.push_back({.quantity = "locking.stretch",
                   .value = slim,
                   .limit = kLongCell,
                   .detail = "cells " + short_number(slim, 3) +
                             " times as long as the body is thick cannot bend by more than its thickness: "
                             "more cells along it, of at most " +
                             short_number(kLongCell * sides[0].length, 3) +
                             " m, or a sheet (plane shell) in its place"});
  }
  if (d.poisson_ratio >= kRubber && resists_at_points(d, cell)) {
    const bool one = element_of(kind_of(cell)).points.size() == 1;
    out.push_back({.quantity = "locking.volume",
                   .value = d.poisson_ratio,
                   .limit = kRubber,
                   .detail = name_of(cell) + " with pointwise volume is too stiff at a Poisson's ratio of " +
                             short_number(d.poisson_ratio, 5) + ": " +
                             (one ? "element " + more + " with volume mean is not" : "volume mean is not")});
  }
  return out;
}

void settle_choices(FemDef& d) {
  const Cell cell = cell_of(d);
  d.volume = volume_of(d);
  d.element = cell;
}

}  // namespace truestep::fem
