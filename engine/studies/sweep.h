// Many runs of a scene with other parameters: every combination of given values, or random draws between
// bounds. Cases are numbered, independent and run in parallel, one thread each; a case's numbers depend only
// on its own parameters, so an interrupted sweep continues from its existing rows.
#pragma once
#include <string>
#include <vector>

#include "engine/studies/study.h"

namespace truestep {

struct SweepAxis {
  std::string pointer;         ///< into the scene
  std::vector<double> values;  ///< or:
  std::optional<double> min, max;
  int64_t count = 5;
  enum class Scale : uint8_t { linear, logarithmic } scale = Scale::linear;
};

struct SweepParams {
  std::vector<SweepAxis> axes;
  enum class Mode : uint8_t { grid, random } mode = Mode::grid;
  int64_t draws = 100;  ///< random: number of cases
  uint64_t seed = 0;
  std::vector<std::string> measure;  ///< quantities as in a scene's "expect"
  std::optional<double> horizon;     ///< s
};

const DefTable& sweep_table();
StudyResult run_sweep(const boost::json::value& scene, const void* def, StudyContext& context);

/// Maximum number of cases in a sweep.
inline constexpr size_t kMaxSweepCases = 100'000;

}  // namespace truestep
