// Steps of any explicit Runge-Kutta method (tableau.h) on y' = f(t, y), the numbers read from its table: the
// bits of ExplicitPair, which is compiled for a method and costs a second of the compiler's time for each,
// where no benchmark shows that this pays. One pass per stage over the terms whose weight is not 0.
#pragma once
#include <array>

#include "engine/integrators/explicit/arrays.h"
#include "engine/integrators/explicit/drive.h"
#include "engine/integrators/explicit/tableau.h"

namespace truestep {

class TableauMethod final : public AdaptiveMethod {
 public:
  TableauMethod(const Tableau& tableau, Advance& in, SumOrder order = SumOrder::lanes);
  ~TableauMethod() override;

  void begin(double t) override { rate(t, a_[kY], a_[kK]); }
  double first_step() override;
  double attempt(double t, double h) override;
  double* candidate() override { return a_[kNew]; }
  const double* solution() const override { return a_[kY]; }
  const Interpolant& between(double t, double h) override;
  void accept(double t1) override;
  long long worst(double h) const override;
  /// Candidate = one step of length h from the solution; the first stage must be available. Always true.
  bool step(double t, double h);

  /// Cubic Hermite interpolation.
  void at(double theta, double* y) const override;

 private:
  enum : size_t { kY, kNew, kStage, kLast, kK, kCount = kK + Tableau::kMaxStages };
  /// The terms of sum_j w_j k_j with w_j != 0.
  struct Terms {
    std::array<double, Tableau::kMaxStages> w{};
    std::array<const double*, Tableau::kMaxStages> k{};
    size_t n = 0;
  };
  Terms terms(const Tableau::Weights& weights) const;
  /// out = y + h sum.
  void add(double h, const Terms& sum, const double* y, double* out) const;

  void rate(double t, const double* y, double* k) {
    in_.f.rate(t, y, k);
    ++rates_;
  }

  const Tableau& tableau_;
  bool fsal_;
  Advance& in_;
  size_t n_;
  Arrays<0, kCount> a_;
  uint64_t rates_ = 0;
  double h_ = 0;
  bool last_stands_ = false;
};

}  // namespace truestep
