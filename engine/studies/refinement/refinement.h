// One scene at many resolutions: documents in which one system is divided 1, 2, 4 ... times as finely, values
// at the points of the coarsest level, which all levels share, and the solution that errors are measured
// against: the scene's exact one (its observable error.exact), otherwise the limit extrapolated from the
// finest three resolutions (Richardson 1911),
//   u ~ u_f + (u_f - u_{f-1}) / (2^p - 1),   2^p = |u_{f-1} - u_{f-2}| / |u_f - u_{f-1}|.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/core/def/resolution.h"
#include "engine/scene/scene.h"
#include "engine/session/world/world.h"
#include "engine/studies/study.h"
#include "engine/studies/trajectory.h"

namespace truestep {

/// What is refined: the steps, the system's resolution, or both together.
enum class Refine : uint8_t { time, space, both };
/// The quantity of errors against numbers that the scene expects at its end, instead of a field.
inline constexpr const char* kExpectedQuantity = "expect";
/// Their names in that order, for parameter tables.
std::vector<std::string> refine_names();
inline constexpr const char* kRefineSentence =
    "time: shorter steps; space: a finer system, integrated so accurately that time adds no error; both: "
    "finer, with steps that shrink so that errors in time and space fall at the same rate";

class Refinement {
 public:
  /// System `id`, or the first that has a resolution if that is empty. Error "scene_invalid" with pointer
  /// "/system" when no system fits, naming the types that have one.
  Refinement(const boost::json::value& scene, const std::string& id, const StudyContext& context);

  size_t system() const { return system_; }
  /// "id.cells"
  std::string subject() const;
  /// Order in space that the system promises; 0: none.
  int promised_order() const;
  /// How much coarser the coarsest level is than the scene: 1, 2 or 4.
  double coarsening() const { return coarsening_; }
  /// The scene divided 2^level times as finely as the coarsest level; Error "scene_invalid" with pointer
  /// "/refine" when that is impossible.
  boost::json::value document(int level) const;

  /// What a run records for `at_common`, and error.exact if the scene knows its solution; of
  /// kExpectedQuantity what the scene expects of the system to equal a number at the end. Error
  /// "scene_invalid" with pointer
  /// "/quantity" when there is no such field or nothing is expected.
  TraceRequest request(const std::string& quantity, const World& coarsest) const;
  /// The largest relative distance of observables, in the order of the request, from what the scene expects;
  /// absolute where that is 0.
  double off_expected(const std::vector<double>& observed) const;
  /// Values (of the part with `quantity`) at the points of the coarsest level.
  std::vector<double> at_common(const World& coarsest, const World& world, const TraceField& field,
                                const std::vector<double>& values) const;

 private:
  Scene scene_;
  size_t system_ = 0;
  const Resolution* resolution_ = nullptr;
  double coarsening_ = 1;
  bool has_exact_ = false;
  std::vector<ExpectParams> expected_;  ///< of the system to equal a number at the end, by observables' names
};

/// Values of all levels at common points, and the relative errors derived from them.
struct LevelErrors {
  std::vector<double> errors;     ///< relative, of every level
  std::vector<double> per_level;  ///< order from level k to k + 1; NaN when meaningless
  std::optional<double> settled;  ///< the order, if the last ones agree
  std::optional<double> mean;     ///< over at least three halvings, whether or not they agree
  std::string reason, against;    ///< why none settled; what the errors are relative to
  std::vector<double> limit;      ///< the extrapolated solution at the common points, unless an exact one
                                  ///< exists
};
/// `exact`: relative errors against the exact solution, or empty. Differences below `floor` are meaningless.
LevelErrors judge_levels(const std::vector<std::vector<double>>& common, const std::vector<double>& exact,
                         double floor);

struct ConvergenceParams;
/// The convergence study for space and both.
StudyResult run_refinement(const boost::json::value& scene, const ConvergenceParams& params,
                           StudyContext& context);

}  // namespace truestep
