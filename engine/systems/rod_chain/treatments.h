// One step of a chain of rods with each of the three treatments of its constraints (rod_chain.h).
#pragma once
#include "engine/core/equations/right_hand_side.h"
#include "engine/systems/rod_chain/rods.h"

namespace truestep::rod_chain {

/// Scratch memory of a step.
struct Scratch {
  BlockTridiagonal matrix;
  std::vector<Vec3> force;
  std::vector<Rod> rods, from, stage, rates, sum;
  std::vector<Hand> hands;
  std::vector<Change> pulls;  ///< accelerations by hands, one per rod
};

/// The chain with exact joint forces as first-order equations: x, u, v, w of every rod.
class RodEquations final : public RightHandSide {
 public:
  /// Both must outlive this.
  RodEquations(const Chain& chain, Scratch& scratch, size_t rods)
      : chain_(chain), scratch_(scratch), rods_(rods) {}
  size_t size() const override { return kNumbers * rods_; }
  void rate(double t, const double* y, double* dydt) const override;
  bool autonomous() const override { return true; }

  static constexpr size_t kNumbers = 12;
  static void write(std::span<const Rod> rods, double* y);
  static void read(const double* y, std::span<Rod> rods);

 private:
  const Chain& chain_;
  Scratch& scratch_;
  size_t rods_;
};

/// Springs with k (N/m) and c (N s/m) for h (s): half of the way, the impulses of a step, the other half
/// (leapfrog; forces of dampers follow the velocities before the impulses).
void step_penalty(const Chain& chain, std::span<Rod> rods, double h, double k, double c, Scratch& s);
/// Free flight and projection until no gap is wider than `tolerance` (m), or rounding is reached. False when
/// positions without gaps are too far away to be found; the rods are then unchanged.
[[nodiscard]] bool step_projection(const Chain& chain, std::span<Rod> rods, double h, double tolerance,
                                   Scratch& s);
/// Exact multipliers, RK4, then projection of positions and velocities.
void step_lagrange(const Chain& chain, std::span<Rod> rods, double h, double tolerance, Scratch& s);
/// Makes the rates of all gaps 0 by impulses in the joints.
void close_rates(const Chain& chain, std::span<Rod> rods, Scratch& s);
/// Completes a step with multipliers: normalises directions, makes spins perpendicular to them, then closes
/// gaps and their rates.
void close_gaps(const Chain& chain, std::span<Rod> rods, double tolerance, Scratch& s);

}  // namespace truestep::rod_chain
