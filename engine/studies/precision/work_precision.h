// Run time against error (work-precision, Hairer, Norsett, Wanner 1993, section II.10): every method at many
// steps or tolerances on one scene; the CPU time of its steps against its relative error
//   |x - x_ref|_2 / |x_ref|_2   at the end, and the largest over equally spaced samples of the path.
#pragma once
#include <string>
#include <vector>

#include "engine/studies/precision/reference.h"
#include "engine/studies/refinement/refinement.h"
#include "engine/studies/study.h"

namespace truestep {

struct WorkPrecisionParams {
  std::string system, quantity = "state";
  std::vector<std::string> integrators;  ///< empty: all that serve the system
  std::vector<double> steps;             ///< s; empty: chosen around the scene's own
  std::vector<double> tolerances;        ///< empty: 1e-3 ... 1e-12
  std::optional<double> horizon;         ///< s
  int64_t samples = 16, repeats = 3;
  double budget = 30;  ///< s of CPU for everything
  Refine refine = Refine::time;
  int64_t halvings = 4;  ///< of the spacing, if that is refined
  /// Internal: s, the steps in which adaptive methods run; default: as long as the scene allows.
  std::optional<double> adaptive_step = {};
};

const DefTable& work_precision_table();
StudyResult run_work_precision(const boost::json::value& scene, const void* def, StudyContext& context);

/// One measured run.
struct WorkPoint {
  std::string integrator;
  double setting = 0;  ///< dt in s, or the tolerance of an adaptive method
  double cpu_seconds = 0, error_end = 0, error_path = 0;
  uint64_t steps = 0;
  std::string status = {};  ///< ok, at the floor, unstable, over budget
  double refined = 1;       ///< resolution relative to the scene's own
};

struct WorkMeasurement {
  Reference reference;
  std::vector<WorkPoint> points;
  struct Refusal {
    std::string integrator, reason;
  };
  std::vector<Refusal> refused;
  double horizon = 0;         ///< s
  double duration = 0;        ///< s, the requested horizon, longer than `horizon` when the budget did not
                              ///< suffice
  bool steps_matter = false;  ///< steps do more than integrate
};

/// The measurement itself, for other studies. Without a horizon it covers as much of the scene's duration as
/// the budget allows; Error "study_failed" at "/horizon" when a given one is too long for any reference.
WorkMeasurement measure_work(const boost::json::value& scene, const WorkPrecisionParams& params,
                             StudyContext& context);

/// The same with the system divided more finely from point to point (refinement.h): errors at the end only,
/// against the scene's exact solution or the limit of ever finer ones.
WorkMeasurement measure_refined_work(const boost::json::value& scene, const WorkPrecisionParams& params,
                                     StudyContext& context);

/// Adds "note" when the horizon is shorter than requested, and "warning" when trajectories are meaningless
/// over it.
void describe_reach(const WorkMeasurement& measurement, boost::json::object& summary);

/// CPU seconds at which a method reaches `error`, interpolated log-log between its points; empty when its
/// points do not span it.
std::optional<double> cpu_at_error(const std::vector<WorkPoint>& points, std::string_view integrator,
                                   double error);

}  // namespace truestep
