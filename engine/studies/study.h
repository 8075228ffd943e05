// Studies: questions about a scene that take many runs of it. Each kind is a parameter table and a function;
// it gets a scene as a document, because it varies the document, and returns a table, plots and a summary.
// Times are CPU seconds of the one thread that steps (so that a shared machine distorts them less).
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
#include "engine/core/build.h"
#include "engine/core/def.h"
#include "engine/studies/study_result.h"

namespace truestep {

/// What a running study tells and asks the outside.
struct StudyContext {
  const ThreadArena& arena;  ///< independent runs may share these threads; timed runs never do
  const std::atomic<bool>& cancelled;
  std::function<void(double fraction, const std::string& note)> progress;
  /// Sweeps: rows of an earlier, interrupted study of the same request; their cases are not run again.
  std::vector<boost::json::object> finished_rows = {};
  /// Sweeps: called once per finished case, from any thread, one call at a time.
  std::function<void(const boost::json::object& row)> row_finished = {};
  /// Throws when a scene of this cost may not be built; called before that, from any thread, for every
  /// variant.
  std::function<void(const Cost&)> admit = {};
  /// Runs are given up as over budget when it has come.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();

  /// Error "cancelled" when somebody asked to stop.
  void check() const;
};

struct StudyKind {
  std::string_view name;  ///< as in a request's "kind"
  std::string_view sentence;
  const DefTable& (*table)();
  /// `def` is the struct of `table`. Errors as a session's creation, and "study_failed".
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
/// The same for a kind that is known, without "kind".
StudyRequest read_request_of(const StudyKind& kind, const boost::json::value& request);
/// Runs it; the result's summary names kind and scene.
StudyResult run_study(const StudyRequest& request, StudyContext& context);

}  // namespace truestep
