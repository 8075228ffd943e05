// One unattended run of a scene: its observables over time, what it should measure and did, and the hash of
// its final state.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/studies/study.h"

namespace truestep {

struct RunParams {
  std::optional<double> duration;        ///< s; the scene's when absent
  std::vector<std::string> observables;  ///< names or prefixes up to a dot; empty: all
  int64_t max_points = 2000;             ///< most rows of the table
};

/// Not a study: it has a route of its own.
const StudyKind& run_kind();

}  // namespace truestep
