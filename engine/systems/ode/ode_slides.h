// Signs of expressions of the states, as dry friction has: -mu sign(v). While g(t, y) keeps its side, sign(g)
// is a constant s = -1 or 1 and the equations are smooth; where g crosses zero, s switches. Where both sides
// push back to g = 0, no step is short enough for that, and the solution slides along g = 0: s takes the
// value for which
//   g' = D(t, y) + sum_j A_j s_j = 0
// (Utkin's equivalent control, which is Filippov's solution where the equations are linear in s), until that
// value leaves [-1, 1]. The sides are the last parameters of the model, so that a state holds them.
#pragma once
#include <span>
#include <vector>

#include "engine/systems/ode/ode_equations.h"

namespace truestep::ode {

class OdeSlides {
 public:
  /// The model must outlive this.
  explicit OdeSlides(const OdeModel& model)
      : model_(model), values_(model.slides), out_(model.slides.outputs()), sides_(model.switched) {}
  /// The model's parameters, whose last are the sides, and 1 per side that slides.
  void attach(std::span<double> parameters, std::span<int32_t> sliding) {
    parameters_ = parameters, sliding_ = sliding;
  }
  size_t count() const { return model_.switched; }
  /// Number of the first parameter that is a side.
  size_t first() const { return model_.parameter_values.size() - count(); }
  bool sliding(size_t k) const { return sliding_[k] != 0; }
  bool any() const;

  /// All sides, with those that slide as they must be at t. Valid until the next call.
  std::span<const double> sides(double t, const double* y);
  /// What tells that a slide ends: positive while it lasts.
  double hold(size_t k, double t, const double* y) { return 1 - std::abs(sides(t, y)[k]); }
  /// g of a side that does not slide; within the rounding of the states from zero it is taken to be where it
  /// was.
  double clear_of_zero(size_t k, const double* y, double g) const;
  /// The event of a side's guard: g has crossed zero, or the slide has ended. Returns the side of zero that
  /// the guard is on from now on.
  int32_t turn(size_t k, double t, const double* y);
  /// Makes the sides fit states and parameters that something else has changed; `near`: the distance of g
  /// from zero that a slide may have drifted to. Returns whether anything has changed.
  bool refresh(double t, const double* y, double near);

 private:
  /// g, D, A_0 .. A_(m-1) of every side, D for the sides that do not slide.
  void evaluate(double t, const double* y);
  double at(size_t k, size_t i) const { return out_[k * (2 + count()) + i]; }
  /// Whether both sides push back to g = 0, with the value of s that holds it there.
  bool holds(size_t k, double t, const double* y, double& value);

  const OdeModel& model_;
  OdeEvaluation values_;
  std::span<double> parameters_;
  std::span<int32_t> sliding_;
  std::vector<double> out_, sides_, matrix_, all_;
  std::vector<size_t> rows_;
};

}  // namespace truestep::ode
