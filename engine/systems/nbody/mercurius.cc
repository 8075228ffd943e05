#include "engine/systems/nbody/mercurius.h"

#include <limits>

#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"
#include "engine/kernels/gravity/kepler_motion.h"
#include "engine/systems/nbody/encounter.h"
#include "engine/systems/nbody/nbody_field.h"

namespace truestep::nbody {

namespace {

/// Pairs are searched slightly beyond their changeover radius, because the cubic between a step's ends is not
/// exactly their path.
constexpr double kMargin = 1.2;

/// Scratch memory of a step; row 0 of `x` and `v` is the centre of mass.
struct Scratch {
  std::vector<Vec3> x, v, x1, v1;  // m, m/s: at the drift's start and end
  std::vector<double> mu, reach;   // m^3/s^2, m
  std::vector<uint8_t> meets;
  Encounter encounter;
};

class Step {
 public:
  Step(const NbodyField& field, State& s, const StepInput& in, double tolerance)
      : s_(s),
        in_(in),
        tolerance_(tolerance),
        w_(in.workspace.object<Scratch>("nbody.mercurius")),
        n_(s.rows(Columns::position)) {
    const double g = parameter(s, Parameter::gravitational_constant),
                 eps = parameter(s, Parameter::softening);
    eps2_ = eps * eps;
    w_.x.resize(n_), w_.v.resize(n_), w_.x1.resize(n_), w_.v1.resize(n_);
    w_.mu.resize(n_), w_.reach.resize(n_), w_.meets.resize(n_);
    w_.encounter.mu.reserve(n_), w_.encounter.reach.reserve(n_), w_.encounter.y.reserve(6 * n_);
    for (size_t i = 0; i < n_; ++i) {
      w_.mu[i] = g * s.f64(Columns::mass)[i];
      const NbodyField::Orbit& o = field.orbits()[i];
      w_.reach[i] = std::max(3 * o.hill_radius, 0.4 * in.h * o.circular_speed);
    }
  }

  void go() {
    from_state();
    kick(0.5 * in_.h);
    jump(0.5 * in_.h);
    drift();
    jump(0.5 * in_.h);
    kick(0.5 * in_.h);
    to_state();
  }

 private:
  void from_state() {
    const auto x = s_.f64(Columns::position), v = s_.f64(Columns::velocity);
    Vec3 middle, mean;
    double total = 0;
    for (size_t i = 0; i < n_; ++i) {
      const double m = s_.f64(Columns::mass)[i];
      middle += load3(x.data(), i) * m, mean += load3(v.data(), i) * m, total += m;
    }
    middle = middle / total, mean = mean / total;
    for (size_t i = 1; i < n_; ++i) {
      w_.x[i] = load3(x.data(), i) - load3(x.data(), 0);
      w_.v[i] = load3(v.data(), i) - mean;
    }
    w_.x[0] = middle + mean * in_.h, w_.v[0] = mean;
  }

  void to_state() {
    const auto x = s_.f64(Columns::position), v = s_.f64(Columns::velocity);
    const auto mass = s_.f64(Columns::mass);
    Vec3 sun, momentum;
    double total = mass[0];
    for (size_t i = 1; i < n_; ++i) sun += w_.x[i] * mass[i], momentum += w_.v[i] * mass[i], total += mass[i];
    sun = w_.x[0] - sun / total;
    store3(x.data(), 0, sun), store3(v.data(), 0, w_.v[0] - momentum / mass[0]);
    for (size_t i = 1; i < n_; ++i) {
      store3(x.data(), i, sun + w_.x[i]), store3(v.data(), i, w_.v[0] + w_.v[i]);
    }
  }

  void kick(double h) {
    for (size_t i = 1; i < n_; ++i) {
      for (size_t j = i + 1; j < n_; ++j) {
        const Vec3 d = w_.x[j] - w_.x[i];
        const double r2 = norm2(d), soft2 = r2 + eps2_;
        if (!(soft2 > 0)) continue;
        const double l = changeover(std::sqrt(r2), std::max(w_.reach[i], w_.reach[j]));
        const double f = h * l / (soft2 * std::sqrt(soft2));
        w_.v[i] += d * (f * w_.mu[j]), w_.v[j] -= d * (f * w_.mu[i]);
      }
    }
  }

  void jump(double h) {
    const auto mass = s_.f64(Columns::mass);
    Vec3 p;
    for (size_t i = 1; i < n_; ++i) p += w_.v[i] * mass[i];
    const Vec3 shift = p * (h / mass[0]);
    for (size_t i = 1; i < n_; ++i) w_.x[i] += shift;
  }

  void drift() {
    for (size_t i = 1; i < n_; ++i) {
      w_.x1[i] = w_.x[i], w_.v1[i] = w_.v[i];
      gravity::kepler_motion(w_.x1[i], w_.v1[i], w_.mu[0], in_.h);
    }
    if (find_encounters()) resolve_encounters();
    for (size_t i = 1; i < n_; ++i) w_.x[i] = w_.x1[i], w_.v[i] = w_.v1[i];
  }

  bool find_encounters() {
    bool any = false;
    std::fill(w_.meets.begin(), w_.meets.end(), 0);
    for (size_t i = 1; i < n_; ++i) {
      for (size_t j = i + 1; j < n_; ++j) {
        if (!(w_.mu[i] > 0 || w_.mu[j] > 0)) continue;  // they do not feel each other
        const double least = closest_on_cubic(w_.x[j] - w_.x[i], (w_.v[j] - w_.v[i]) * in_.h,
                                              w_.x1[j] - w_.x1[i], (w_.v1[j] - w_.v1[i]) * in_.h);
        if (least > kMargin * std::max(w_.reach[i], w_.reach[j])) continue;
        w_.meets[i] = w_.meets[j] = 1, any = true;
      }
    }
    return any;
  }

  void resolve_encounters() {
    Encounter& e = w_.encounter;
    e.sun = w_.mu[0], e.eps2 = eps2_;
    e.mu.clear(), e.reach.clear();
    for (size_t i = 1; i < n_; ++i) {
      if (w_.meets[i]) e.mu.push_back(w_.mu[i]), e.reach.push_back(w_.reach[i]);
    }
    const size_t m = e.mu.size();
    e.y.resize(6 * m);
    for (size_t i = 1, k = 0; i < n_; ++i) {
      if (w_.meets[i]) store3(e.y.data(), k, w_.x[i]), store3(e.y.data(), m + k, w_.v[i]), ++k;
    }
    static const Integrator& inner = *find_integrator("ias15");
    Carry carry;
    Advance advance{.f = e,
                    .t = 0,
                    .t_end = in_.h,
                    .y = e.y.data(),
                    .workspace = in_.workspace,
                    .carry = carry,
                    .tolerance = {.relative = tolerance_, .absolute = tolerance_}};
    inner.advance(advance);
    for (size_t i = 1, k = 0; i < n_; ++i) {
      if (w_.meets[i]) w_.x1[i] = load3(e.y.data(), k), w_.v1[i] = load3(e.y.data(), m + k), ++k;
    }
  }

  State& s_;
  const StepInput& in_;
  double tolerance_, eps2_ = 0;
  Scratch& w_;
  size_t n_;
};

void mercurius_step(const ForceField& field, State& s, const StepInput& in,
                    const IntegratorOptions& options) {
  Step(static_cast<const NbodyField&>(field), s, in, options.tolerance).go();
}

}  // namespace

const Integrator& mercurius() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  static const Integrator kRow{.name = kMercuriusName,
                               .title = "ellipses outside, ias15 in encounters",
                               .order = 2,
                               .imaginary_limit = kNone,
                               .real_limit = kNone,
                               .structure = Integrator::Structure::symplectic,
                               .equations = Integrator::Equations::second_order,
                               .source = "Chambers 1999, MNRAS 304:793; Rein et al. 2019, MNRAS 485:5490",
                               .step = mercurius_step};
  return kRow;
}

}  // namespace truestep::nbody
