// Answers the touches of one substep, one after another in the order of their
// times, each with the velocities and places that the earlier ones left behind.
#pragma once
#include <optional>
#include <vector>

#include "engine/couplings/contact_def.h"
#include "engine/couplings/contact_search.h"
#include "engine/couplings/exchange.h"

namespace truestep {

/// Kept from step to step for its memory alone.
struct ContactSolverScratch {
  std::vector<Touch> queue, answered;
  std::vector<HullContact> contacts;  ///< one per answered touch
};

class ContactSolver {
 public:
  /// `points` and `other` are written to; `q` says where they came from and what touches.
  ContactSolver(const ContactDef& law, const ContactQuery& q, Points& points, Points& other,
                ContactSolverScratch& scratch);

  /// Answers touches in the order of their times; returns how many acted.
  size_t answer_all(const std::vector<Touch>& touches);
  /// After the last answers: moves apart what is still within reach, and forgets the substep.
  void finish();
  /// What the points gave to the solids.
  const Exchange& exchange() const { return exchange_; }

 private:
  /// A point and the corners of a solid with the inverse masses that an impulse at the weights feels.
  struct Pair {
    size_t point;
    SolidList::Corners corners;
    HullWeights b;
    double w;                     ///< 1/kg of the point
    std::array<double, 3> share;  ///< b_i w_i
    double k;                     ///< K
  };
  Pair pair(const Touch& t, const HullWeights& b) const;
  /// Value of the point less the blend of the corners'.
  Vec3 relative(const Pair& c, const double* point, const double* other) const;
  Vec3 relative_acceleration(const Pair& c) const;
  /// Changes the relative value by `by` and keeps the sum weighted with the masses.
  void change(const Pair& c, double* point, double* other, const Vec3& by) const;
  bool answer(const Pair& c, const HullContact& at);
  bool settle(const Touch& t, HullContact& at);

  const ContactDef& law_;
  const ContactQuery& q_;
  Points &p_, &o_;
  RowTraces &pt_, &ot_;
  ContactSolverScratch& scratch_;
  Exchange exchange_;
};

}  // namespace truestep
