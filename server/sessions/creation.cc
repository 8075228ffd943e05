#include "server/sessions/creation.h"

#include "engine/base/hash.h"
#include "engine/scene/json/json_write.h"

namespace truestep {

bool SceneDraft::heavy() const {
  constexpr double kElements = 2e4;
  constexpr double kStep = 0.02;  // s: building a world evaluates a step's matrices
  return !report.scene || report.scene->header.accuracy || !(cost.elements < kElements) ||
         !(cost.seconds_per_step + cost.start_seconds < kStep);
}

SceneDraft read_draft(boost::json::value document) {
  SceneDraft draft;
  Hasher hasher;
  hasher.text(write_json(document));
  draft.hash = hasher.value();
  draft.report = read_scene(document);
  if (draft.report.scene && draft.report.scene->header.accuracy) draft.document = std::move(document);
  if (draft.report.scene) draft.cost = estimate(*draft.report.scene);
  return draft;
}

}  // namespace truestep
