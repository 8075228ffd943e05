// A run of a scene sampled at equal intervals, with the CPU time of its steps.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/base/thread_clock.h"
#include "engine/session/world/world.h"
#include "engine/studies/study.h"

namespace truestep {

/// Which numbers of the state are compared: one field of one system.
struct TraceField {
  size_t system = 0;
  std::string name = "state";
};

struct TraceRequest {
  TraceField field;
  uint64_t steps_per_sample = 1;
  size_t samples = 1;
  double cpu_limit = 1e9;                     ///< s; a run that takes longer is abandoned
  std::vector<std::string> observables = {};  ///< of the same system, recorded beside the field
};

struct Trace {
  enum class End : uint8_t { complete, unstable, over_budget } end = End::complete;
  std::vector<double> times;                  ///< s; the start is sample 0
  std::vector<std::vector<double>> values;    ///< flat field at each time
  std::vector<std::vector<double>> observed;  ///< the observables at each time, NaN if undefined
  double cpu_seconds = 0;                     ///< of the steps alone
  uint64_t steps = 0;
  std::string detail;  ///< why it ended early
};

/// Steps the world from its initial state in the calling thread. Never throws Instability; Error "cancelled".
Trace trace(const World& world, const TraceRequest& request, const StudyContext& context);

/// Values of a field as doubles; "state": the whole configuration (core/equations/configuration.h). Error
/// "scene_invalid" with pointer "/quantity" when the system has no such field.
std::vector<double> field_values(const System& system, const State& state, const std::string& name);

/// |a - b|_2 / |b|_2; infinity when the lengths differ or a number is not finite. 0 where
/// the difference and `b` are both smaller than `least`.
double relative_error(const std::vector<double>& a, const std::vector<double>& b, double least = 0);
/// Size of values that are no more than rounding of the largest ones of a trajectory: what has come to rest
/// at 0 has no relative error of its own.
double rounding_size(const std::vector<std::vector<double>>& values);

}  // namespace truestep
