// Run time against error (work-precision, Hairer, Norsett, Wanner 1993, section II.10): every method at many
// steps or tolerances on one scene; the CPU time of its steps beside its relative error
//   |x - x_ref|_2 / |x_ref|_2   at the end, and the largest over equally spaced samples of the path.
#pragma once
#include <string>
#include <vector>

#include "engine/studies/reference.h"
#include "engine/studies/study.h"

namespace truestep {

struct WorkPrecisionParams {
  std::string system, quantity = "state";
  std::vector<std::string> integrators;  ///< empty: all that serve the system
  std::vector<double> steps;             ///< s; empty: chosen around the scene's own
  std::vector<double> tolerances;        ///< empty: 1e-3 ... 1e-12
  std::optional<double> horizon;         ///< s
  int64_t samples = 16, repeats = 3;
  double budget = 40;  ///< s of CPU for everything
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
};

struct WorkMeasurement {
  Reference reference;
  std::vector<WorkPoint> points;
  struct Refusal {
    std::string integrator, reason;
  };
  std::vector<Refusal> refused;
  double horizon = 0;  ///< s
};

/// The measurement itself, for other studies.
WorkMeasurement measure_work(const boost::json::value& scene, const WorkPrecisionParams& params,
                             StudyContext& context);

/// CPU seconds at which a method reaches `error`, interpolated between its points in log-log; nothing when
/// its points do not span it.
std::optional<double> cpu_at_error(const std::vector<WorkPoint>& points, std::string_view integrator,
                                   double error);

}  // namespace truestep
