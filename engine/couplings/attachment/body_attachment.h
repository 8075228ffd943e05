// The coupling type "attachment" between points and rigid bodies: pairs (point i, place p on body k), r = x_i
// - p, u its velocity relative to the body there, K = w_i + n . K_k n.
// Spring: J = -h/2 (k (|r| - L) + c u.n) n on the point at both ends of the substep, -J on the body at p;
// stiffer springs, h sqrt(k K) > 1, are solved together with both sides as in attachment.h, those with a
// length L > 0 along themselves only, like rigid links. Rigid link: |r| = L by RATTLE (Andersen 1983) between
// point and body, along the link's direction at the substep's start; with L = 0 the two places coincide and J
// has any direction. When the points are solved implicitly, the link's impulse is that of both solved as one
// (points_on_bodies.h), and its lasting part, like that of a stiff spring, is given to both before their own
// steps. The angular momentum that a position correction would change is given to the body's spin
// (core/ports/body_port.h).
#pragma once
#include <memory>

#include "engine/couplings/attachment/attachment_def.h"
#include "engine/couplings/exchange.h"
#include "engine/couplings/points_on_bodies.h"

namespace truestep::attachment {

class BodyAttachment final : public Coupling {
 public:
  /// Exactly one side must have bodies, the other points. Error "scene_invalid" when a pair names something
  /// that does not exist.
  static std::unique_ptr<const BodyAttachment> make(const AttachmentDef& def, const CouplingContext& context);

  State initial_state() const override;
  void begin(const CoupledStates& s, const StepInput& input) const override;
  void end(const CoupledStates& s, const StepInput& input) const override;
  /// The exchange; energy.potential (J) of springs; length.error (m) of rigid links; pairs.
  void observe(const ConstCoupledStates& s, Observables& out) const override;
  double stored_energy(const ConstCoupledStates& s) const override;
  void draw(const ConstCoupledStates& s, std::vector<DrawnString>& out) const override;
  std::vector<std::string> doubts() const override { return doubts_; }
  std::vector<PlanRow> plan() const override;
  std::optional<double> step_seconds(const ConstCoupledStates& s, double h) const override;

 private:
  struct Pair {
    uint64_t point, body;  ///< ids
    Vec3 place;            ///< m, in the body's frame
    double rest;           ///< m
  };
  /// A pair that exists and can move.
  struct Live {
    size_t pair;
    BodyLink link;
    Vec3 place;
    double rest;
    Vec3 start;  ///< m, r at the substep's start
    bool kicked = false;
  };
  BodyAttachment(const AttachmentDef& def, const PointsOnBodies& sides) : def_(def), sides_(sides) {}
  State& points(const CoupledStates& s) const { return bodies_first_ ? s.b : s.a; }
  State& bodies(const CoupledStates& s) const { return bodies_first_ ? s.a : s.b; }
  bool rigid() const { return def_.link == AttachmentDef::Link::rigid; }
  const char* pass() const { return rigid() ? "links" : "springs"; }
  /// Visits every existing pair: visit(index, point row, body row).
  void each(const auto& points, const auto& bodies, auto&& visit) const;
  enum class When : uint8_t { start, later };
  std::vector<Live>& live(const Points& points, const Bodies& bodies, const StepInput& in,
                          When when = When::later) const;
  /// Whether a spring is soft enough to be kicked at both ends of a substep.
  bool may_be_kicked(size_t pair, const BodyLink& link, const auto& points, const auto& bodies,
                     double h) const;
  void pull(const std::vector<Live>& live, Points& points, Bodies& bodies, double h, Exchange& sum) const;
  void damp(const std::vector<Live>& live, Points& points, Bodies& bodies, double h, Exchange& sum) const;
  static void give(const BodyLink& link, const Vec3& impulse, Points& points, Bodies& bodies, double h);
  void give_last(const CoupledStates& s, const StepInput& in, Exchange& sum) const;
  void solve_springs(const CoupledStates& s, const StepInput& in, std::vector<Live>& live,
                     Exchange& sum) const;
  void solve_links(const CoupledStates& s, const StepInput& in, std::vector<Live>& live, Exchange& sum) const;
  void restore_lengths(const std::vector<Live>& live, Points& points, Bodies& bodies, double h,
                       Exchange& sum) const;
  void match_velocities(const std::vector<Live>& live, Points& points, Bodies& bodies, Exchange& sum) const;
  void book_sum(State& own, Exchange sum) const;

  AttachmentDef def_;
  PointsOnBodies sides_;
  bool bodies_first_ = false, at_centres_ = false;
  std::vector<Pair> pairs_;
  std::vector<std::string> doubts_;
};

}  // namespace truestep::attachment
