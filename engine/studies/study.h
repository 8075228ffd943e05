// Studies: questions about a scene that take many runs of it. Each kind is a parameter table and a function;
// it gets the scene as a document, so that it can vary it, and returns a table, plots and a summary. Times
// are CPU seconds of the one stepping thread (so that a shared machine distorts them less).
#pragma once
#include <atomic>
#include <boost/json.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/studies/study_result.h"

namespace truestep {

/// The study's connection to its surroundings.
struct StudyContext {
  const ThreadArena& arena;  ///< independent runs may share these threads; timed runs never do
  const std::atomic<bool>& cancelled;
  std::function<void(double fraction, const std::string& note)> progress;
  /// Sweeps: rows of an earlier, interrupted study of the same request; their cases are not run again.
  std::vector<boost::json::object> finished_rows = {};
  /// Sweeps: called once per finished case, from any thread, one call at a time.
  std::function<void(const boost::json::object& row)> row_finished = {};
  /// Throws when a scene of this cost may not be built; called first for every variant, from any thread.
  std::function<void(const Cost&)> admit = {};
  /// When it is reached, runs are abandoned as over budget.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();

  /// Error "cancelled" when a stop was requested.
  void check() const;
};

struct StudyKind {
  std::string_view name;  ///< as in a request's "kind"
  std::string_view sentence;
  const DefTable& (*table)();
  /// `def` is the struct of `table`. Errors as for creating a session, and "study_failed".
  StudyResult (*run)(const boost::json::value& scene, const void* def, StudyContext& context);
};

std::span<const StudyKind> study_kinds();
const StudyKind* find_study_kind(std::string_view name);

/// A request {"kind": ..., "scene": {...} | "gallery": name, parameters of the kind ...}.
struct StudyRequest {
  const StudyKind* kind = nullptr;
  boost::json::value scene;
  std::shared_ptr<void> def;
};

/// Error "scene_invalid" with every fault of the scene and of the parameters.
StudyRequest read_study_request(const boost::json::value& request);
/// The same for a given kind, without "kind".
StudyRequest read_request_of(const StudyKind& kind, const boost::json::value& request);
/// Runs the study; the result's summary names kind and scene.
StudyResult run_study(const StudyRequest& request, StudyContext& context);

}  // namespace truestep
