// Accuracy on request: a scene says how accurate it should be instead of naming a method and a step, and gets
// the cheapest method that was measured to achieve it on this very scene, together with the measurements.
// Where trajectories are meaningless (chaos, contacts), methods are judged by energy drift, and the report
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

/// For a document with "accuracy"; its session step stays (methods of fixed step divide it into substeps).
/// Spends at most about `budget` CPU seconds, 0.8 when steps take milliseconds, and ten times what the scene
/// takes to run; without time to measure, the method is the one whose order promises most. Error
/// "accuracy_unreachable", saying what is reachable, when nothing meets it.
AccuracyOutcome choose_method(const boost::json::value& document, double budget, StudyContext& context);

struct SettledScene {
  Scene scene;                 ///< as it will run
  boost::json::object report;  ///< from choose_method; empty when the scene asks for no accuracy
};

/// Reads a document and, if it asks for an accuracy, lets choose_method settle how. Errors of both. Code that
/// only reads scenes (validation, schema) does not use this: choosing takes seconds. Wall time is bounded
/// too, at three times the budget. `admit` (may be empty) throws when a scene of that cost may not be built.
SettledScene settle_accuracy(const boost::json::value& document, double budget, const ThreadArena& arena,
                             std::function<void(const Cost&)> admit = {});

}  // namespace truestep
