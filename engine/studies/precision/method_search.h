// Finds the cheapest method and setting that keep a scene within an error, in bounded time: a reference
// solution, then a handful of methods known to pay at such an error, each at a guessed setting that is
// corrected by its own measured error (error ~ tolerance, error ~ step^order). When the time does not suffice
// for the horizon, a part of it is measured and the errors are extrapolated.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/studies/precision/reference.h"
#include "engine/studies/study.h"

namespace truestep {

struct MethodQuestion {
  size_t system = 0;
  std::string quantity = "state";
  double tolerance = 1e-4;  ///< relative error over the horizon
  double horizon = 1;       ///< s
  double budget = 1;        ///< limit of the search, in CPU seconds
};

/// One method at one setting.
struct MeasuredMethod {
  std::string integrator;
  double setting = 0;      ///< tolerance of an adaptive method, step (s) of a fixed one
  double error = 0;        ///< over the horizon; infinity: it failed
  double cpu_seconds = 0;  ///< of its steps over the measured part
  friend bool operator==(const MeasuredMethod&, const MeasuredMethod&) = default;
};

struct MethodAnswer {
  std::optional<Reference> reference;
  enum class JudgedBy : uint8_t { path, energy, nothing } judged_by = JudgedBy::path;
  double measured_horizon = 0;  ///< s
  std::vector<MeasuredMethod> measured;
  std::optional<MeasuredMethod> best;  ///< meets the tolerance; judged by energy, or absent: see judged_by
  bool out_of_time = false;            ///< some methods were not tried
};

/// Runs for at most about `budget` seconds, and ten times what the scene itself takes to run. Error
/// "cancelled".
MethodAnswer search_method(const boost::json::value& document, const MethodQuestion& question,
                           const StudyContext& context);

}  // namespace truestep
