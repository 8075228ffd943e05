// The solution that a study measures errors against: two different methods at tight tolerances; the first is
// the reference and the second tells how far it can be trusted.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <string>

#include "engine/studies/trajectory.h"

namespace truestep {

struct Reference {
  Trace trace;
  std::string method;      ///< e.g. "cvode_bdf at 1e-12"
  std::string checked_by;  ///< the other one
  double uncertainty = 0;  ///< largest relative difference of the two over the samples
  /// Difference of the two in the request's first observable at the end, in its unit.
  std::optional<double> observed_difference;
  /// Errors below ten times the uncertainty say nothing about the method measured.
  double floor() const { return 10 * uncertainty; }
  /// The two disagree so much that the trajectory is meaningless at this horizon: the motion is chaotic, or
  /// contacts make it discontinuous.
  bool meaningless() const { return !(uncertainty < 1e-2); }
};

/// How a search ended: with a reference, or how much of the horizon the best run covered in its time.
struct ReferenceSearch {
  std::optional<Reference> reference;
  double reached = 0;  ///< 0 to 1
};

/// How much effort a reference may take.
struct ReferenceEffort {
  double first_tolerance = 1e-7;  ///< of the first pair of runs; further pairs are a hundred times tighter
  double enough = 0;              ///< uncertainty at which no further pair is run
  bool stiff = false;             ///< implicit methods come first
};

/// `steps_per_sample` refers to the scene's own step. When steps do more than integrate (contacts, couplings,
/// births), the two runs also use different steps, an eighth and a quarter of the scene's, so that the
/// uncertainty includes the effect of the step.
ReferenceSearch find_reference(const boost::json::value& document, const TraceRequest& request,
                               double sample_interval, double cpu_limit, const StudyContext& context,
                               const ReferenceEffort& effort = {});

/// Whether this world's steps do more than integrate, so that the motion depends on their length even with a
/// perfect method.
bool steps_matter(const World& world);

/// {"method", "checked_by", "uncertainty"}
boost::json::object describe_reference(const Reference& reference);

}  // namespace truestep
