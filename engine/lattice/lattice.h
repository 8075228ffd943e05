// Nodes on a box in one to three dimensions, x running fastest. The outermost nodes lie on the sides: a
// side's given values are values of nodes, a string is held exactly at its ends, and all nodes of a lattice
// are nodes of the one with twice the cells, so that solutions are compared without interpolation. A periodic
// axis has as many nodes as cells, any other axis one more.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace truestep::lattice {

/// The condition on a side with outward normal n: u = g, du/dn = g, du/dn = transfer (g - u).
enum class SideKind : uint8_t { dirichlet, neumann, robin, periodic };
struct Side {
  SideKind kind = SideKind::neumann;
  double transfer = 0;  ///< 1/m
  friend bool operator==(const Side&, const Side&) = default;
};

struct Axis {
  size_t cells = 1;
  double origin = 0, spacing = 1;  ///< m
  std::array<Side, 2> sides{};     ///< low, high

  bool periodic() const { return sides[0].kind == SideKind::periodic; }
  size_t nodes() const { return periodic() ? cells : cells + 1; }
  /// Fraction of a spacing that belongs to node i: a half at an end.
  double share(size_t i) const { return !periodic() && (i == 0 || i == cells) ? 0.5 : 1.0; }
  bool fixed(size_t i) const {
    return (i == 0 && sides[0].kind == SideKind::dirichlet) ||
           (i == cells && sides[1].kind == SideKind::dirichlet);
  }
  /// The neighbours before and after node i; beyond an end, the mirrored node.
  size_t before(size_t i) const { return i > 0 ? i - 1 : periodic() ? cells - 1 : 1; }
  size_t after(size_t i) const { return i + 1 < nodes() ? i + 1 : periodic() ? 0 : nodes() - 2; }
  /// The faces between node i and those; face k lies between node k and the node after it.
  size_t face_before(size_t i) const { return i > 0 ? i - 1 : periodic() ? cells - 1 : 0; }
  size_t face_after(size_t i) const { return i + 1 < nodes() || periodic() ? i : i - 1; }
  double at(size_t i) const { return origin + static_cast<double>(i) * spacing; }
  friend bool operator==(const Axis&, const Axis&) = default;
};

/// Axes beyond `dimensions` have one node without coupling, at their origin.
struct Lattice {
  size_t dimensions = 1;
  std::array<Axis, 3> axes{};

  size_t count(size_t axis) const { return axis < dimensions ? axes[axis].nodes() : 1; }
  size_t nodes() const { return count(0) * count(1) * count(2); }
  size_t stride(size_t axis) const { return axis == 0 ? 1 : axis == 1 ? count(0) : count(0) * count(1); }
  std::array<size_t, 3> place(size_t node) const {
    const size_t nx = count(0), ny = count(1);
    return {node % nx, node / nx % ny, node / (nx * ny)};
  }
  bool fixed(const std::array<size_t, 3>& p) const {
    bool any = false;
    for (size_t a = 0; a < dimensions; ++a) any = any || axes[a].fixed(p[a]);
    return any;
  }
  /// m, m^2 or m^3, the part of the box that belongs to a node.
  double volume(const std::array<size_t, 3>& p) const {
    double v = 1;
    for (size_t a = 0; a < dimensions; ++a) v *= axes[a].spacing * axes[a].share(p[a]);
    return v;
  }
  friend bool operator==(const Lattice&, const Lattice&) = default;
};

}  // namespace truestep::lattice
