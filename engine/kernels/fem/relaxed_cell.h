// An element with incompatible modes as one with additional nodes, whose positions alpha minimise its energy:
// the modes' gradients follow those of the shape functions, so the functions of cell.h for nodes apply to the
// modes too. alpha is found by Newton's method from 0, with the definite stiffness where the exact one gives
// no descent.
#pragma once
#include <array>

#include "engine/kernels/fem/cell.h"

namespace truestep::fem {

class RelaxedCell {
 public:
  /// For an element with rule.modes > 0, at most 8 nodes and 8 points.
  RelaxedCell(const Material& material, const CellRule& rule, const Vec3* x);

  /// With the modes as nodes after the others, without modes of its own.
  const CellRule& rule() const { return rule_; }
  const Vec3* x() const { return x_.data(); }
  /// As cell_forces and cell_stiffness, for the nodes alone.
  double forces(const Material& material, Vec3* forces) const;
  void stiffness(const Material& material, Definite definite, double* k) const;

 private:
  static constexpr size_t kNodes = 8, kPoints = 8, kAll = kNodes + kMostModes, kOwn = 3 * kMostModes;
  /// r = dE/d alpha; returns E.
  double residual(const Material& material, std::array<double, kOwn>& r, double& size) const;
  bool improve(const Material& material, Definite definite, const std::array<double, kOwn>& r, double energy);

  size_t nodes_, modes_;
  std::array<Vec3, kAll * kPoints> gradients_;
  std::array<Vec3, kAll> x_;
  CellRule rule_;
};

}  // namespace truestep::fem
