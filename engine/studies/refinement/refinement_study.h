// One convergence study over resolution (refinement.h), level by level from the coarsest. Space: at every
// resolution the system's semi-discrete equations are integrated like a reference (two methods at tight
// tolerances), so that only the spatial error remains. Both: one method with a step that shrinks with the
// spacing, dt ~ dx^r, r the smallest integer with r (order in time) >= (order in space), and 2 when an
// explicit method's limit falls like dx^2.
#pragma once
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/equations/integrator.h"
#include "engine/studies/convergence.h"
#include "engine/studies/precision/reference.h"
#include "engine/studies/refinement/refinement.h"

namespace truestep {

class RefinementStudy {
 public:
  /// Whether steps (and tolerances) follow the spacing or stay those of the scene.
  enum class Steps : uint8_t { follow, keep };
  struct Level {
    double refined = 1;  ///< relative to the scene's own
    size_t rows = 0;
    double setting = 0, cpu_seconds = 0;
    std::string status = {};
  };

  /// Error "scene_invalid" when the scene has nothing to refine, or no such integrator.
  RefinementStudy(const boost::json::value& scene, const ConvergenceParams& p, StudyContext& context,
                  Steps steps = Steps::follow);

  /// Levels until the halvings or the budget are used up. Error "study_failed" when there is none.
  void run();
  StudyResult result() const;

  const std::vector<Level>& levels() const { return levels_; }
  const std::vector<std::vector<double>>& common() const { return common_; }
  /// Relative errors against the exact solution, or empty.
  const std::vector<double>& exact() const { return exact_; }
  double time_uncertainty() const { return uncertainty_; }
  double horizon() const { return horizon_; }
  std::string subject() const { return ladder_.subject(); }
  /// Whether the system steps itself, without an integrator that could be chosen.
  bool own_steps() const { return !coarsest_.system(ladder_.system()).integration().method; }
  bool says_exact() const { return !request_.observables.empty(); }
  bool expects() const { return p_.quantity == kExpectedQuantity; }

 private:
  std::string name(int level) const;
  void choose_steps();
  double limit(int level) const;
  bool add_level(int k, double left);
  double expected_error() const;
  std::optional<Reference> in_time(const boost::json::value& document, const World& world, double left);
  std::optional<Trace> with_tolerance(boost::json::value document, const char* name, double tolerance,
                                      double cpu_limit);
  Trace with_method(boost::json::value document, int k, double left, Level& level);

  const ConvergenceParams& p_;
  StudyContext& context_;
  Steps steps_;
  Refinement ladder_;
  World coarsest_;
  TraceRequest request_;
  double horizon_ = 0, substep_ = 0, growth_ = 4, uncertainty_ = 0;
  int order_ = 0, promised_ = 0;
  const Integrator* method_ = nullptr;  ///< for `both`; null: the system's own step
  bool adaptive_ = false;
  double first_ = 0;  ///< step or tolerance at the coarsest level
  int power_ = 1;     ///< power of the spacing that they follow
  std::vector<Level> levels_;
  std::vector<std::vector<double>> common_;
  std::vector<double> exact_;
  std::string methods_, note_;
};

}  // namespace truestep
