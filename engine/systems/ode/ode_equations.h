// A compiled model as the right-hand side for integrators, together with the scratch memory of one thread.
#pragma once
#include <cmath>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/interrupt.h"
#include "engine/systems/ode/ode_model.h"

namespace truestep::ode {

/// A program with its registers: variables t, parameters, states.
class OdeEvaluation {
 public:
  explicit OdeEvaluation(const ExpressionProgram& program)
      : program_(program), registers_(program.registers()) {
    program_.start(registers_.data());
  }
  void set_parameters(std::span<const double> p) {
    if (program_.outputs() > 0) std::copy(p.begin(), p.end(), registers_.begin() + 1);
  }
  void operator()(double t, const double* y, size_t n, size_t parameters, double* out) {
    registers_[0] = t;
    std::copy_n(y, n, registers_.data() + 1 + parameters);
    program_.run(registers_.data(), out);
  }
  void set_parameter(size_t i, double value) {
    if (program_.outputs() > 0) registers_[1 + i] = value;
  }
  /// States given in two parts.
  void operator()(double t, const double* x, const double* v, size_t half, size_t parameters, double* out) {
    registers_[0] = t;
    double* y = registers_.data() + 1 + parameters;
    std::copy_n(x, half, y);
    if (v) std::copy_n(v, half, y + half);
    program_.run(registers_.data(), out);
  }

 private:
  const ExpressionProgram& program_;
  std::vector<double, CacheLineAllocator<double>> registers_;
};

class OdeContacts;
class OdeSlides;

class OdeEquations final : public RightHandSide, public SecondOrder {
 public:
  /// The model must outlive this.
  explicit OdeEquations(const OdeModel& model);
  void set_parameters(std::span<const double> p);
  const OdeModel& model() const { return model_; }
  /// States at rest are held there; null: nothing rests. Valid until the next call.
  void rest_on(OdeContacts* contacts) { contacts_ = contacts; }
  /// Sides that slide are as they must be; null: none slides. Valid until the next call.
  void slide_on(OdeSlides* slides) { slides_ = slides; }
  /// Times are taken as within these (s): on the inner side of jumps at both ends of an integration.
  void stay_within(double low, double high) { low_ = low, high_ = high; }

  size_t size() const override { return model_.size(); }
  void rate(double t, const double* y, double* dydt) const override {
    interruption_point();
    if (slides_) slide(rate_, t, y);
    rate_(inside(t), y, model_.size(), parameters_, dydt);
    if (contacts_) support_rates(t, y, dydt);
  }
  MatrixShape jacobian_shape() const override { return model_.jacobian.shape(); }
  /// Covers both the first-order equations and the second-order ones, if any.
  bool has_jacobian() const override {
    // The constraint of a contact is not part of the compiled derivatives.
    return !contacts_ && !slides_ && model_.jacobian.program.outputs() > 0 &&
           (!model_.second_order || model_.acceleration_jacobian.program.outputs() > 0);
  }
  void jacobian(double t, const double* y, double* values) const override {
    jacobian_(inside(t), y, model_.size(), parameters_, values);
  }
  std::string name_of(size_t i) const override { return '"' + model_.labels[i] + '"'; }
  bool autonomous() const override { return model_.autonomous; }
  const SecondOrder* second_order() const override { return model_.second_order ? this : nullptr; }

  void acceleration(double t, const double* x, const double* v, double* a) const override {
    if (slides_) slide(acceleration_, t, both(x, v));
    acceleration_(inside(t), x, v, model_.size() / 2, parameters_, a);
    if (contacts_) support_accelerations(t, x, v, a);
  }
  bool depends_on_velocity() const override { return model_.depends_on_velocity; }
  MatrixShape shape() const override { return model_.acceleration_jacobian.shape(); }
  void jacobian(double t, const double* x, const double* v, double* dadx, double* dadv) const override;

 private:
  double inside(double t) const { return t < low_ ? low_ : t > high_ ? high_ : t; }
  void slide(OdeEvaluation& of, double t, const double* y) const;
  const double* both(const double* x, const double* v) const;
  void support_rates(double t, const double* y, double* dydt) const;
  void support_accelerations(double t, const double* x, const double* v, double* a) const;

  const OdeModel& model_;
  size_t parameters_;
  double low_ = -HUGE_VAL, high_ = HUGE_VAL;  // s
  OdeContacts* contacts_ = nullptr;
  OdeSlides* slides_ = nullptr;
  mutable OdeEvaluation rate_, jacobian_, acceleration_, acceleration_jacobian_;
  mutable std::vector<double> both_;    ///< da/dx and da/dv together
  mutable std::vector<double> states_;  ///< positions and velocities together
};

}  // namespace truestep::ode
