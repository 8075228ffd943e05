// The coupling type "contact" between points and rigid bodies: no point comes closer to a body's surface than
// its own radius (half a cloth's thickness), and no corner or ball of a body passes a triangle between the
// points. Touches are found along the paths of both sides (body_touch_search.h) and answered by impulses with
// Newton's restitution and Coulomb friction (body_touch_solver.h), equal and opposite along one line. Every
// point responds by its own mass, so the step has to resolve the springs between the points: a system whose
// method solves for its points together (linear_implicit_euler, implicit_euler) is refused, because there the
// response of a single point, m d / h^2, is less than that of its springs, and the difference would create
// energy. Runs once more after all couplings, like contact_guard.h. Points that lie on a free body or slide
// over it slowly do not keep it awake: it may fall asleep, is an obstacle while it sleeps, and wakes when
// something meets it faster or the load on it changes.
#pragma once
#include <memory>

#include "engine/core/ports/body_sleep.h"
#include "engine/core/ports/changing_triangles.h"
#include "engine/couplings/contact/body_touch_solver.h"

namespace truestep::contact {

class BodyContact final : public Coupling {
 public:
  /// Exactly one side must have bodies, the other points. Error "scene_invalid" when the points' method
  /// solves for them together.
  static std::unique_ptr<const BodyContact> make(const ContactDef& def, const CouplingContext& context);

  State initial_state() const override;
  void begin(const CoupledStates& s, const StepInput& input) const override;
  void midway(const CoupledStates& s, const StepInput& input) const override;
  void end(const CoupledStates& s, const StepInput& input) const override;
  bool guard(const CoupledStates& s, const StepInput& input) const override;
  /// The exchange, contacts (1) and penetration (m, the deepest) of the last substep.
  void observe(const ConstCoupledStates& s, Observables& out) const override;
  std::vector<PlanRow> plan() const override;
  std::optional<double> step_seconds(const ConstCoupledStates& s, double h) const override;

 private:
  struct Scratch;
  BodyContact(const ContactDef& def, const PointPort& points, const BodyPort& bodies)
      : def_(def), point_columns_(points), body_columns_(bodies) {}
  State& points(const CoupledStates& s) const { return bodies_first_ ? s.b : s.a; }
  State& bodies(const CoupledStates& s) const { return bodies_first_ ? s.a : s.b; }
  size_t answer(const CoupledStates& s, const StepInput& in, Scratch& scratch,
                BodyTouchSolver::Bounces bounces, Exchange& sum) const;
  void book_sum(State& own, Exchange sum) const;
  /// Finds the bodies that these touches leave at rest, those that no point meets fast: `calm`, with their
  /// sleep timers; touches of sleeping bodies get a body that stays.
  void find_rest(std::vector<BodyTouch>& touches, const BodyTouchQuery& q, const State& bodies, double h,
                 Scratch& scratch) const;
  /// After the touches were answered: keeps calm bodies at rest, and adds up every body's load.
  void keep_rest(State& bodies, Scratch& scratch) const;
  /// Wakes sleeping bodies whose load differs from the one they fell asleep under.
  void compare_loads(State& own, State& bodies, double h, const Scratch& scratch) const;

  ContactDef def_;
  PointPort point_columns_;
  BodyPort body_columns_;
  const BodySleep* sleep_ = nullptr;  // of free bodies; null: they never sleep
  size_t remembered_ = 0;  // bodies of the start, whose loads are kept; others stay awake while touched
  bool bodies_first_ = false;
  bool points_are_tied_ = false;  // energy taken up by springs cannot be told from energy lost
  std::string points_id_, bodies_id_;
  SolidsOf hulls_;
  std::vector<TouchForm> forms_;
  bool meets_edges_ = false;  // whether any body has edges
  double reach_ = 0;          ///< m
};

}  // namespace truestep::contact
