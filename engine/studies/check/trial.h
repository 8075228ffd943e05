// One run of a scene that is tested, and what came of it.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/scene_test.h"
#include "engine/session/expectation.h"

namespace truestep {

/// What to run.
struct Trial {
  boost::json::value document;  ///< a scene
  int threads = 1;
  bool resumed = false;        ///< saved halfway and continued by another session
  bool drops_scratch = false;  ///< begins every step without scratch memory
  bool compared = false;       ///< whether the bits of all its states are compared with another run's
  std::vector<TestCommand> commands;
  std::vector<NamedText> plan;  ///< reasons that stages are to have
  bool sleepers = false;        ///< whether what sleeps is woken to see whether it moves
};

struct TrialResult {
  std::vector<Verdict> verdicts;
  uint64_t hash = 0;  ///< of all states of a run that is compared, else of the last one
  uint64_t steps = 0;
  std::vector<Issue> refused;          ///< faults of a scene that was not accepted
  std::optional<std::string> refusal;  ///< the sentence above them
  std::optional<std::string> failure;  ///< the instability that ended the run
  std::string not_finite;              ///< an observable
  std::vector<std::string> commands;   ///< what came of those that should have been refused
  std::vector<std::string> plan;       ///< stages without the reason that they should have
  double moved = 0, moved_at = 0;      ///< m in 0.4 s by a sleeping row once woken, and when (s)
  double cpu_seconds = 0;
};

/// Runs a scene over its duration. Throws only what interrupts work (base/interrupt.h).
TrialResult run_trial(const Trial& trial);

/// CPU seconds that it is estimated to take, 0 when that cannot be told.
double estimated_seconds(const Trial& trial);

}  // namespace truestep
