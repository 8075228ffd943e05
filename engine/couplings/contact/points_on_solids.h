// The points of one system against the solids of another, in one direction: the stages of a substep, with
// impulses as contact.h describes them. A contact has one of these, or two where both sides have faces.
#pragma once
#include <string>

#include "engine/core/coupling.h"
#include "engine/core/ports/changing_triangles.h"
#include "engine/couplings/contact/contact_def.h"
#include "engine/couplings/contact/contact_search.h"
#include "engine/couplings/exchange.h"

namespace truestep::contact {

class PointsOnSolids {
 public:
  /// Whose points are tested against whose solids.
  enum class Roles : uint8_t { a_on_b, b_on_a, on_itself };
  PointsOnSolids(Roles roles, const ContactDef& def, const CouplingContext& context, double reach);

  void begin(const CoupledStates& s, const StepInput& in) const;
  void midway(const CoupledStates& s, const StepInput& in) const;
  /// Returns the number of touches answered; what a gave to b is added to `sum`.
  size_t end(const CoupledStates& s, const StepInput& in, Exchange& sum) const;
  bool guard(const CoupledStates& s, const StepInput& in, Exchange& sum) const;

  /// "722 triangles, 38 capsules"
  std::string solids_text() const;
  const std::string& points_id() const { return points_id_; }
  const std::string& solids_id() const { return solids_id_; }
  bool has_faces() const { return !published_.start.triangles.empty(); }

 private:
  bool swapped() const { return roles_ == Roles::b_on_a; }
  /// Adds what the points gave to the solids.
  void add(Exchange& sum, const Exchange& given) const;
  SolidList solids(const State& state, const Points& of) const;

  Roles roles_;
  ContactDef def_;
  const char* memory_;  ///< name of its scratch
  std::string points_id_, solids_id_;
  PointPort points_, other_;
  SolidsOf published_;
  double reach_;  ///< m, distance at which a point touches
};

}  // namespace truestep::contact
