// One run of a scene without anybody watching: its observables over time, what it should measure and did, and
// the hash of its last state.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/studies/study.h"

namespace truestep {

struct RunParams {
  std::optional<double> duration;        ///< s; the scene's when absent
  std::vector<std::string> observables;  ///< names or their beginnings up to a dot; empty: all
  int64_t max_points = 2000;             ///< rows of the table, at most
};

/// No kind of study: it has a route of its own.
const StudyKind& run_kind();

}  // namespace truestep
