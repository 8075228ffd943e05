#include "server/sessions/creation.h"

namespace truestep {

bool SceneDraft::heavy() const {
  constexpr double kElements = 2e4;
  constexpr double kStep = 0.02;  // s: building a world evaluates a step's matrices
  return !report.scene || report.scene->header.accuracy || !(cost.elements < kElements) ||
         !(cost.seconds_per_step + cost.start_seconds < kStep);
}

SceneDraft read_draft(boost::json::value document) {
  SceneDraft draft{std::move(document), {}, {}};
  draft.report = read_scene(draft.document);
  if (draft.report.scene) draft.cost = estimate(*draft.report.scene);
  return draft;
}

}  // namespace truestep
