// Splitting methods on x'' = a(t, x, v) (splitting.h), and velocity Verlet, which keeps its last
// acceleration. A velocity-dependent acceleration is evaluated at the velocity half a kick ahead, as for
// force fields. Without watchers, the last drift of a step and the first of the next are merged.
#include "engine/integrators/explicit/arrays.h"
#include "engine/integrators/symplectic/splitting.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

namespace {

// Between the ends of a step: cubic Hermite interpolation of x by its own velocities, v linear in between
// them; y = (x, v).
class Straight final : public Interpolant {
 public:
  Straight(size_t n, const double* y0, const double* y1, double h) : n_(n), y0_(y0), y1_(y1), h_(h) {}
  void at(double s, double* y) const override {
    const double r = 1 - s, w = s * s * (3 - 2 * s), w0 = h_ * s * r * r, w1 = -h_ * s * s * r;
    const double d = 6 * s * r / h_, d0 = r * (1 - 3 * s), d1 = s * (3 * s - 2);
    for (size_t i = 0; i < n_; ++i) {
      const double rise = y1_[i] - y0_[i], v0 = y0_[n_ + i], v1 = y1_[n_ + i];
      y[i] = y0_[i] + (w * rise + (w0 * v0 + w1 * v1));
      y[n_ + i] = d * rise + d0 * v0 + d1 * v1;
    }
  }

 private:
  size_t n_;
  const double *y0_, *y1_;
  double h_;
};

template <size_t W>
class SplittingStepper {
 public:
  explicit SplittingStepper(Advance& in)
      : in_(in),
        second_(*in.f.second_order()),
        n_(in.f.size() / 2),
        moving_(second_.depends_on_velocity()),
        a_(in, "integrator.splitting", n_),
        old_(in, "integrator.splitting_old", 2 * n_) {
    std::copy_n(in.y, n_, a_[kX]);
    std::copy_n(in.y + n_, n_, a_[kV]);
  }
  void drift(double h) {
    double* x = a_[kX];
    const double* v = a_[kV];
    a_.loop([=](size_t i) { x[i] = std::fma(h, v[i], x[i]); });
  }
  // a at the velocity advanced by `ahead` times the acceleration.
  void accelerate(double t, double ahead) {
    double *a = a_[kA], *p = a_[kPredicted];
    const double* v = a_[kV];
    second_.acceleration(t, a_[kX], moving_ ? v : nullptr, a);
    if (in_.statistics) ++in_.statistics->rates;
    if (!moving_ || ahead == 0) return;
    a_.loop([=](size_t i) { p[i] = std::fma(ahead, a[i], v[i]); });
    second_.acceleration(t, a_[kX], p, a);
    if (in_.statistics) ++in_.statistics->rates;
  }
  void kick(double h) {
    double* v = a_[kV];
    const double* a = a_[kA];
    a_.loop([=](size_t i) { v[i] = std::fma(h, a[i], v[i]); });
  }
  // step(t, h, first, last) over all steps of the run.
  template <class Step>
  void run(Step step) {
    const uint64_t count = in_.fixed_steps;
    const double h = (in_.t_end - in_.t) / static_cast<double>(count);
    const auto at = [&](uint64_t i) { return i == count ? in_.t_end : in_.t + static_cast<double>(i) * h; };
    for (uint64_t i = 0; i < count; ++i) {
      if (in_.watcher) std::copy_n(in_.y, 2 * n_, old_[0]);
      step(at(i), h, in_.watcher || i == 0, in_.watcher || i + 1 == count);
      if (in_.statistics) ++in_.statistics->steps;
      if (!in_.watcher) continue;
      store();
      double t1 = at(i + 1);
      const auto verdict = in_.watcher->accepted(at(i), t1, in_.y, Straight(n_, old_[0], in_.y, h));
      if (verdict == StepWatcher::Verdict::go_on) continue;
      in_.reached = t1;
      return;
    }
    store();
    in_.reached = in_.t_end;
  }

 private:
  enum : size_t { kX, kV, kA, kPredicted, kCount };
  void store() {
    std::copy_n(a_[kX], n_, in_.y);
    std::copy_n(a_[kV], n_, in_.y + n_);
  }
  Advance& in_;
  const SecondOrder& second_;
  size_t n_;
  bool moving_;
  Arrays<W, kCount> a_;
  Arrays<2 * W, 1> old_;
};

/// Two or three positions in one vector register.
template <class Run>
void for_width(const Advance& in, Run run) {
  with_width<4>(positions_of(in), run);
}

void advance_splitting(Advance& in, const Splitting& s) {
  for_width(in, [&]<size_t W>() {
    SplittingStepper<W> m(in);
    m.run([&](double t, double h, bool first, bool last) {
      if (first) m.drift(s.drift[0] * h);
      double place = s.drift[0];
      for (size_t i = 0; i < s.kicks; ++i) {
        m.accelerate(t + place * h, 0.5 * s.kick[i] * h);
        m.kick(s.kick[i] * h);
        const double following = i + 1 < s.kicks || last ? s.drift[i + 1] : s.drift[i + 1] + s.drift[0];
        m.drift(following * h);
        place += s.drift[i + 1];
      }
    });
  });
}

}  // namespace

void advance_leapfrog(Advance& in) {
  advance_splitting(in, kLeapfrog);
}
void advance_yoshida4(Advance& in) {
  advance_splitting(in, kYoshida4);
}
void advance_yoshida6(Advance& in) {
  advance_splitting(in, kYoshida6);
}
void advance_yoshida8(Advance& in) {
  advance_splitting(in, kYoshida8);
}
void advance_kahan_li8(Advance& in) {
  advance_splitting(in, kKahanLi8);
}
void advance_pefrl(Advance& in) {
  advance_splitting(in, kPefrl);
}

void advance_symplectic_euler(Advance& in) {
  for_width(in, [&]<size_t W>() {
    SplittingStepper<W> m(in);
    m.run([&](double t, double h, bool, bool) {
      m.accelerate(t, 0);
      m.kick(h);
      m.drift(h);
    });
  });
}

void advance_velocity_verlet(Advance& in) {
  const bool moving = in.f.second_order() && in.f.second_order()->depends_on_velocity();
  for_width(in, [&]<size_t W>() {
    SplittingStepper<W> m(in);
    bool stands = false;
    m.run([&](double t, double h, bool, bool) {
      if (!stands) m.accelerate(t, 0);
      m.kick(0.5 * h);
      m.drift(h);
      m.accelerate(t + h, 0.5 * h);
      m.kick(0.5 * h);
      stands = !moving;
    });
  });
}

}  // namespace truestep
