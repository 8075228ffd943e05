// One step of a chain of rods by each of the three treatments of its constraints (rod_chain.h).
#pragma once
#include "engine/systems/rod_chain/rods.h"

namespace truestep::rods {

/// Memory of a step; nothing in it outlives one.
struct Scratch {
  BlockTridiagonal matrix;
  std::vector<Vec3> force;
  std::vector<Rod> rods, from, stage, rates, sum;
};

/// Springs of k (N/m) and c (N s/m) for h (s); semi-implicit Euler.
void step_penalty(const Chain& chain, std::span<Rod> rods, double h, double k, double c, Scratch& s);
/// Free flight and projection until no gap is wider than `tolerance` (m), or rounding is reached.
void step_projection(const Chain& chain, std::span<Rod> rods, double h, double tolerance, Scratch& s);
/// Exact multipliers, RK4, then places and velocities are projected.
void step_lagrange(const Chain& chain, std::span<Rod> rods, double h, double tolerance, Scratch& s);

}  // namespace truestep::rods
