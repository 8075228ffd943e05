// A scene with its test: the runs that the test asks for, and what is wrong with their results. The runs are
// independent of each other and may be made by any threads, in any order.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/studies/check/trial.h"

namespace truestep {

/// One thing that is not as it should be.
struct CheckFinding {
  std::string variation;  ///< "precision = \"f32\", dt = 0.01"; empty: the scene as it stands
  std::string quantity;   ///< of an expectation, or: instability, refused, commands, plan, not_finite, still,
                          ///< same, agree, control
  std::optional<double> measured;
  std::string wanted;  ///< "at most 0.01"
  std::string detail;  ///< a sentence
};

class SceneCheck {
 public:
  /// A scene document; its key "test" may be missing. Error "scene_invalid" for faults of "test", or of a
  /// change that it makes.
  explicit SceneCheck(const boost::json::value& document);

  const std::string& why() const { return test_.why; }
  size_t size() const { return runs_.size(); }
  const Trial& trial(size_t i) const { return runs_[i].trial; }
  const std::string& variation(size_t i) const { return runs_[i].label; }
  /// Different runs may be made at the same time.
  void run(size_t i) { runs_[i].result = run_trial(runs_[i].trial); }
  const TrialResult& result(size_t i) const { return runs_[i].result; }
  /// After all runs; empty when all is well.
  std::vector<CheckFinding> findings() const;

 private:
  struct Run {
    std::string label;
    Trial trial;
    size_t of_case = 0;
    std::optional<size_t> control;
    std::vector<size_t> at;  ///< per entry of `vary`, the place in its list
    TrialResult result;
  };
  void add_runs(const boost::json::value& scene, size_t of_case, std::optional<size_t> control);
  void add_run(const boost::json::value& scene, Run run);
  void measure_agreements(boost::json::value& document) const;
  bool changes_no_bit(const std::string& axis) const;
  bool varies(size_t axis, std::optional<size_t> control) const;
  void judge(const Run& run, std::vector<CheckFinding>& out) const;
  void compare(size_t of_case, std::optional<size_t> control, std::vector<CheckFinding>& out) const;
  void compare_order(const TestAgreement& a, const std::vector<const Run*>& group,
                     std::vector<CheckFinding>& out) const;
  void judge_control(size_t control, std::vector<CheckFinding>& out) const;
  std::vector<std::vector<const Run*>> groups(size_t axis, size_t of_case,
                                              std::optional<size_t> control) const;

  SceneTest test_;
  std::vector<Run> runs_;
};

}  // namespace truestep
