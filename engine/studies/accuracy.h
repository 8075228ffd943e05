// Accuracy as a request: a scene says how accurate it wants to be instead of naming a method and a step, and
// gets the cheapest method that was measured to be so on this very scene, together with the measurements.
// Where paths mean nothing (chaos, contacts) methods are judged by the drift of the energy, and the report
// says so.
#pragma once
#include <boost/json.hpp>

#include "engine/scene/scene.h"
#include "engine/studies/study.h"

namespace truestep {

struct AccuracyOutcome {
  boost::json::value scene;    ///< the document with integrator, step and tolerance filled in
  boost::json::object report;  ///< what was measured and why this was chosen
};

/// For a document that has "accuracy"; its session step stays (methods of fixed step divide it into
/// substeps). Spends at most about `budget` CPU seconds, 0.8 where steps take milliseconds, and ten times
/// what the scene takes to run; without time to measure, the method is the one whose order promises most.
/// Error "accuracy_unreachable" with what is reachable when nothing meets it.
AccuracyOutcome choose_method(const boost::json::value& document, double budget, StudyContext& context);

struct SettledScene {
  Scene scene;                 ///< as it will run
  boost::json::object report;  ///< that of choose_method; empty when the scene asked for no accuracy
};

/// Reads a document and, when it asks for an accuracy, lets choose_method fill in how. Errors of both. What
/// only reads scenes (validation, schema) does not come here: choosing takes seconds. The clock bounds it,
/// too, at three times the budget. `admit` (may be empty) throws when a scene of that cost may not be built.
SettledScene settle_accuracy(const boost::json::value& document, double budget, const ThreadArena& arena,
                             std::function<void(const Cost&)> admit = {});

}  // namespace truestep
