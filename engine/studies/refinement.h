// One scene at many resolutions: documents in which one system is divided 1, 2, 4 ... times as finely, values
// at the places that the coarsest of them has, which all of them share, and the solution that errors are
// measured against: the scene's exact one (its observable error.exact), else the limit that the finest three
// resolutions point to (Richardson 1911),
//   u ~ u_f + (u_f - u_{f-1}) / (2^p - 1),   2^p = |u_{f-1} - u_{f-2}| / |u_f - u_{f-1}|.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/core/resolution.h"
#include "engine/session/world.h"
#include "engine/studies/study.h"
#include "engine/studies/trajectory.h"

namespace truestep {

/// What is made finer: the steps, the system's resolution, or both together.
enum class Refine : uint8_t { time, space, both };
/// Names in that order, for tables of parameters.
std::vector<std::string> refine_names();
inline constexpr const char* kRefineSentence =
    "time: shorter steps; space: the system divided more finely, integrated so accurately that time adds "
    "nothing; both: finer, with steps that shrink so that time and space lose errors at the same rate";

class Refinement {
 public:
  /// System `id`, or the first that has a resolution when that is empty. Error "scene_invalid" with pointer
  /// "/system" when no system fits, naming the types that have one.
  Refinement(const boost::json::value& scene, const std::string& id, const StudyContext& context);

  size_t system() const { return system_; }
  /// "id.cells"
  std::string subject() const;
  /// Order in space that the system promises; 0: none.
  int promised_order() const;
  /// How much coarser than the scene's own the coarsest level is: 1, 2 or 4.
  double coarsening() const { return coarsening_; }
  /// The scene divided 2^level times as finely as the coarsest; Error "scene_invalid" with pointer "/refine"
  /// where it cannot be.
  boost::json::value document(int level) const;

  /// What a run records for `at_common`, and error.exact where the scene says what its solution is.
  TraceRequest request(const std::string& quantity, const World& coarsest) const;
  /// Values (of the part that holds `quantity`) at the coarsest level's places.
  std::vector<double> at_common(const World& coarsest, const World& world, const TraceField& field,
                                const std::vector<double>& values) const;

 private:
  Scene scene_;
  size_t system_ = 0;
  const Resolution* resolution_ = nullptr;
  double coarsening_ = 1;
  bool has_exact_ = false;
};

/// Values of all levels at common places, and the relative errors that they tell.
struct LevelErrors {
  std::vector<double> errors;     ///< relative, of every level
  std::vector<double> per_level;  ///< order from level k to k + 1; NaN where it means nothing
  std::optional<double> settled;  ///< order, where the last ones agree
  std::string reason, against;    ///< why none settled; what the errors are relative to
  std::vector<double> limit;      ///< what they are measured against at the common places, where not exact
};
/// `exact`: relative errors against the exact solution, empty where there is none. Below `floor` differences
/// say nothing.
LevelErrors judge_levels(const std::vector<std::vector<double>>& common, const std::vector<double>& exact,
                         double floor);

struct ConvergenceParams;
/// The study of convergence for space and both.
StudyResult run_refinement(const boost::json::value& scene, const ConvergenceParams& params,
                           StudyContext& context);

}  // namespace truestep
