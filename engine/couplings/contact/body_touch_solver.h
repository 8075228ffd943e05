// Solves the touches of points and bodies in one substep by Gauss-Seidel sweeps over all touches. At its end,
// with gap = n . (q - place) - reach and u the velocity of the points relative to the body at q:
//   positions   gap >= wanted,  P_n >= 0,  |P_t| <= mu P_n  against sliding since the touch began
//   velocities  u_n >= wanted,  J_n >= 0,  |J_t| <= mu J_n
// Wanted is 0, or for a touch that bounces, what its flight from the time of the touch gives. Points do not
// spin, so impulses act on the body at the point's centre: linear and angular momentum are exchanged to
// rounding, with friction too. Newton's law of restitution for several simultaneous touches, some of which
// bounce and others hold, may add energy (Brach 1989, "Rigid body collisions"): if the total work of all
// answers, against the substep's forces and in velocities, is a gain, they are undone and nothing bounces.
#pragma once
#include <vector>

#include "engine/couplings/contact/body_touch_search.h"
#include "engine/couplings/contact/contact_def.h"
#include "engine/couplings/exchange.h"

namespace truestep::contact {

struct SolvedTouch {
  BodyTouch touch;
  double mass[9];                ///< rows of W, 1/kg: u' = u + W J
  double normal = 0;             ///< n . W n
  double gap = 0, speed = 0;     ///< target values
  double push = 0, impulse = 0;  ///< along n: kg m, N s
  Vec3 drag, rub;                ///< perpendicular to n
  Vec3 pull;                     ///< m/s^2, averaged over the substep, of the points relative to the body
  enum class Kind : uint8_t { near, touches, bounces } kind = Kind::near;
};

class BodyTouchSolver {
 public:
  BodyTouchSolver(const ContactDef& law, Points& points, Bodies& bodies, double h)
      : law_(law), points_(points), bodies_(bodies), h_(h) {}

  enum class Bounces : uint8_t { no, yes };
  /// Solves all touches; returns how many were active. `out` is what the points gave to the bodies.
  size_t run(const std::vector<BodyTouch>& touches, const BodyTouchQuery& q, Bounces bounces,
             std::vector<SolvedTouch>& solved, Exchange& out);
  /// m/s^2, averaged over the substep, of the points of a touch relative to the body.
  static Vec3 pull(const BodyTouch& t, const BodyTouchQuery& q, double h);
  /// m, present gap of a touch.
  static double gap(const BodyTouch& t, const Points& points, const Bodies& bodies);

 private:
  /// Masses for answers to impulses where the bodies are now.
  void weigh(SolvedTouch& s) const;
  void prepare(const BodyTouch& t, const BodyTouchQuery& q, Bounces bounces, SolvedTouch& s) const;
  double place(SolvedTouch& s, Exchange& out);
  double stop(SolvedTouch& s, Exchange& out);
  /// All places, then all velocities.
  void sweep(std::vector<SolvedTouch>& solved, Exchange& out);
  /// Undoes what was done for a touch, which from then on does not bounce.
  void take_back(SolvedTouch& s);

  const ContactDef& law_;
  Points& points_;
  Bodies& bodies_;
  double h_;
};

}  // namespace truestep::contact
