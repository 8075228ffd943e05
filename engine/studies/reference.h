// The solution that a study measures errors against: two different methods at tight tolerances, of which the
// first is taken and the second says how far it can be trusted.
#pragma once
#include <boost/json.hpp>
#include <string>

#include "engine/studies/trajectory.h"

namespace truestep {

struct Reference {
  Trace trace;
  std::string method;      ///< e.g. "cvode_bdf at 1e-12"
  std::string checked_by;  ///< the other one
  double uncertainty = 0;  ///< largest relative difference of the two over the samples
  /// Errors below ten times the uncertainty say nothing about the method measured.
  double floor() const { return 10 * uncertainty; }
  /// The two agree so badly that the trajectory means nothing at this horizon: the motion is chaotic, or
  /// contacts make it discontinuous.
  bool meaningless() const { return !(uncertainty < 1e-2); }
};

/// `steps_per_sample` is that of the finest run compared. Error "study_failed" when no method can do it
/// within cpu_limit seconds.
Reference find_reference(const boost::json::value& document, const TraceRequest& request,
                         double sample_interval, double cpu_limit, const StudyContext& context);

/// {"method", "checked_by", "uncertainty"}
boost::json::object describe_reference(const Reference& reference);

}  // namespace truestep
