// Answers the touches of one substep in order of time, each with the velocities and positions left by the
// earlier ones.
#pragma once
#include <optional>
#include <vector>

#include "engine/couplings/contact/contact_def.h"
#include "engine/couplings/contact/contact_pair.h"
#include "engine/couplings/exchange.h"

namespace truestep::contact {

/// Kept between steps only to reuse its memory.
struct ContactSolverScratch {
  std::vector<Touch> queue, answered;
  std::vector<HullContact> contacts;  ///< one per answered touch
};

class PointContactSolver {
 public:
  /// Writes to `points` and `other`; `q` has their paths and touches.
  PointContactSolver(const ContactDef& law, const ContactQuery& q, Points& points, Points& other,
                     ContactSolverScratch& scratch);

  /// Answers the touches of a round in order of time; returns how many were active.
  size_t answer_all(const std::vector<Touch>& touches, uint32_t round);
  /// After the last answers: separates pairs still within reach, and forgets the substep.
  void finish();
  /// What the points gave to the solids.
  const Exchange& exchange() const { return exchange_; }

 private:
  Vec3 relative_acceleration(const ContactPair& c) const;
  bool answer(const ContactPair& c, const HullContact& at);
  bool settle(const Touch& t, HullContact& at);

  const ContactDef& law_;
  const ContactQuery& q_;
  Points &p_, &o_;
  RowTraces &pt_, &ot_;
  ContactSolverScratch& scratch_;
  Exchange exchange_;
  uint32_t round_ = 0;
};

}  // namespace truestep::contact
