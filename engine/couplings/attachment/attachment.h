// The coupling type "attachment": pairs (i of a, j of b), r = x_j - x_i, u = v_j - v_i, K = w_i + w_j
// (inverse masses).
// Spring: J = -h/2 (k (|r| - L) + c u.n) n on j at both ends of the substep, -J on i; the damping by the
// trapezoid rule, which is stable for every c. Impulse method of Tuckerman, Berne, Martyna 1992, "Reversible
// multiple time scale molecular dynamics": order 2, stable for h sqrt(k K) < 2. Stiffer springs, h sqrt(k K)
// > 1, are solved together with both sides: J = -h (k (|r'| - L) + c u'.n) n with r' and u' at the substep's
// end, the spring force of implicit Euler.
// Rigid link: |r| = L by RATTLE (Andersen 1983) across the two systems. After both have moved, positions are
// corrected to the link's length along its direction at the substep's start, velocities along with them, and
// then u.n = 0. Links that share points are swept until all hold. When a side is solved implicitly, the
// link's impulse is that of the two systems solved as one: points respond with everything tied to them
// (core/equations/impulse_answer.h), because moving a point alone would stretch stiff springs.
// A particle that dies is released.
#pragma once
#include <memory>

#include "engine/core/coupling.h"
#include "engine/couplings/answered_pairs.h"
#include "engine/couplings/attachment/attachment_def.h"
#include "engine/couplings/exchange.h"

namespace truestep::attachment {

class Attachment final : public Coupling {
 public:
  /// Error "scene_invalid" when a system has no points to attach or a pair names a point that does not exist.
  static std::unique_ptr<const Attachment> make(const AttachmentDef& def, const CouplingContext& context);

  State initial_state() const override;
  void begin(const CoupledStates& s, const StepInput& input) const override;
  void end(const CoupledStates& s, const StepInput& input) const override;
  /// The exchange; energy.potential (J) of springs; length.error (m), largest ||r| - L| of rigid links;
  /// pairs.
  void observe(const ConstCoupledStates& s, Observables& out) const override;
  double stored_energy(const ConstCoupledStates& s) const override;
  void draw(const ConstCoupledStates& s, std::vector<DrawnString>& out) const override;
  std::vector<PlanRow> plan() const override;
  std::optional<double> step_seconds(const ConstCoupledStates& s, double h) const override;

 private:
  /// Ids of the two points, and how many pairs are attached to each of them.
  struct Pair {
    uint64_t a, b;
    double rest;  ///< m
    double a_share, b_share;
  };
  /// A pair whose points both exist and are not both held.
  struct Live {
    size_t pair, a, b;  ///< index of the pair, rows
    double wa, wb, rest;
  };
  Attachment(const AttachmentDef& def, const CouplingContext& context, PointPort a, PointPort b)
      : def_(def), a_(a), b_(b), answered_(context.a.system, context.b.system, a, b) {}
  /// Name of the pass.
  const char* pass() const { return def_.link == AttachmentDef::Link::rigid ? "links" : "springs"; }
  template <class Real>
  void collect(const PointsOf<Real>& a, const PointsOf<Real>& b, std::vector<Live>& out) const;
  void pull(Points& a, Points& b, const std::vector<Live>& live, double half, Exchange& sum) const;
  void damp(Points& a, Points& b, const std::vector<Live>& live, double half, Exchange& sum) const;
  static void restore_lengths(Points& a, Points& b, const std::vector<Live>& live, const double* start,
                              double h, Exchange& sum);
  static void match_velocities(Points& a, Points& b, const std::vector<Live>& live, Exchange& sum);
  /// Springs by impulses at both ends of a substep, springs too stiff for that, or all links.
  enum class Wanted : uint8_t { kicked, solved, links };
  /// Whether a spring is solved within the step: too stiff for kicks in substeps of h.
  bool is_solved(const Live& p, double h) const;
  std::vector<Live>& live_pairs(const Points& a, const Points& b, const StepInput& in, Wanted wanted) const;
  /// The motion of a pair without its impulse.
  struct FreePair {
    Vec3 r, u;
  };
  void give_last(const CoupledStates& s, double h, Points& a, Points& b, const std::vector<Live>& live) const;
  void ask(AnsweredPair& q, double rest, const Vec3& r, const Vec3& u, double h) const;
  void solve_pairs(const CoupledStates& s, const StepInput& in, const std::vector<Live>& live,
                   Exchange& sum) const;
  void close_lengths(const CoupledStates& s, const StepInput& in, const std::vector<Live>& live,
                     std::vector<AnsweredPair>& pairs, Exchange& sum) const;

  AttachmentDef def_;
  PointPort a_, b_;
  AnsweredPairs answered_;
  std::vector<Pair> pairs_;
};

std::unique_ptr<const Coupling> build_attachment(const void* def, const CouplingContext& context);

}  // namespace truestep::attachment
