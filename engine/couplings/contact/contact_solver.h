// Answers the touches of one substep, one after another in the order of their
// times, each with the velocities and places that the earlier ones left behind.
#pragma once
#include <optional>
#include <vector>

#include "engine/couplings/contact/contact_def.h"
#include "engine/couplings/contact/contact_pair.h"
#include "engine/couplings/exchange.h"

namespace truestep::contact {

/// Kept from step to step for its memory alone.
struct ContactSolverScratch {
  std::vector<Touch> queue, answered;
  std::vector<HullContact> contacts;  ///< one per answered touch
};

class PointContactSolver {
 public:
  /// `points` and `other` are written to; `q` says where they came from and what touches.
  PointContactSolver(const ContactDef& law, const ContactQuery& q, Points& points, Points& other,
                     ContactSolverScratch& scratch);

  /// Answers the touches of a round in the order of their times; returns how many acted.
  size_t answer_all(const std::vector<Touch>& touches, uint32_t round);
  /// After the last answers: moves apart what is still within reach, and forgets the substep.
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
