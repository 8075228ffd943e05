// The search for a stability limit: steps are tried from below, finely around a guess, and the limit is
// bisected; then for spans above it where steps are stable again, as compositions of leapfrog have.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/studies/stability_trial.h"

namespace truestep {

class BorderSearch {
 public:
  BorderSearch(const boost::json::value& scene, const StabilityParams& p, size_t system, std::string method,
               StudyContext& context)
      : params_(p), trial_(scene, system, std::move(method), context) {}

  struct Span {
    double from = 0, to = 0;  ///< s
  };
  struct Found {
    double dt = 0;
    enum class Kind : uint8_t { limit, always, never, over_budget } kind = Kind::limit;
    int runs = 0;
    std::vector<Span> again;  ///< stable spans above the first limit
  };

  /// The first limit between `guess` / 256 and 256 `guess`, and stable spans within a factor of four above
  /// it. Steps are tried from below, `resolution` apart near the guess and near a limit, as some compositions
  /// lose stability over only 1.4 %; every limit is bisected. To end within `cpu_limit` s, runs get shorter,
  /// then steps set further apart; at worst the result is incomplete.
  Found find(double guess, double cpu_limit);
  int64_t steps() const { return trial_.steps(); }
  bool unsolved() const { return trial_.unsolved(); }
  /// Spans narrower than this fraction of the step may have been missed.
  double resolution() const { return resolution_; }

 private:
  void plan_runs(double dt, double cpu_limit);
  /// Advances from `low`, which is stable, to `next`; false at a limit, which is then known.
  bool advance(double& low, double next, Found& found);
  /// `holds` and `fails`: steps on either side of a limit. Returns the last stable step.
  double bisect(double holds, double fails);
  void find_again(Found& found);

  const StabilityParams& params_;
  StabilityTrial trial_;
  double resolution_ = 0;
  std::optional<double> border_;  ///< a step just above the first limit
};

}  // namespace truestep
