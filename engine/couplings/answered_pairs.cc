#include "engine/couplings/answered_pairs.h"

#include <algorithm>
#include <cmath>

#include "engine/couplings/conjugate_gradients.h"

namespace truestep {

namespace {

/// Relative residual at which the impulses are accurate enough, and the maximum number of iterations beyond
/// one per unknown.
constexpr double kAccuracy = 1e-13;
constexpr size_t kSpare = 5, kMostIterations = 300;

Vec3 shape(const AnsweredPair& p, const Vec3& y) {
  return y * p.across + p.n * ((p.along - p.across) * dot(p.n, y));
}

}  // namespace

/// The points of one system, with impulses on them and the resulting changes.
struct AnsweredPairs::Side {
  Side(const AnswersImpulses* system, State& state, const PointPort& columns, Workspace& scratch)
      : system(system),
        state(state),
        points(state, columns),
        scratch(scratch),
        impulse(scratch.doubles("answer.impulse", 3 * points.count)),
        dv(scratch.doubles("answer.dv", 3 * points.count)) {}
  void answer(const StepInput& in, AnswersImpulses::Answer which) {
    const StepInput own{in.t, in.h, in.step, scratch, in.arena, nullptr};
    system->answer(state, own, which, impulse, dv);
  }
  void move(size_t i, double h) {
    const Vec3 d = load3(dv.data(), i);
    points.accelerate(i, d);
    points.shift(i, d * h);
  }

  const AnswersImpulses* system;
  State& state;
  Points points;
  Workspace& scratch;
  std::span<double> impulse, dv;
};

/// Both sides, or one that is attached to itself.
struct AnsweredPairs::Sides {
  Sides(const AnsweredPairs& p, const CoupledStates& s, const StepInput& in)
      : one(&s.a == &s.b),
        first(p.a_, s.a, p.columns_a_, in.workspace.object<Workspace>("answer.a")),
        second(p.b_, s.b, p.columns_b_, in.workspace.object<Workspace>(one ? "answer.a" : "answer.b")) {
    for (Side* side : {&first, &second}) std::fill(side->impulse.begin(), side->impulse.end(), 0.0);
  }
  Side& a() { return first; }
  Side& b() { return one ? first : second; }

  bool one;
  Side first, second;
};

template <class ImpulseOf>
void AnsweredPairs::respond(Sides& sides, const StepInput& in, AnswersImpulses::Answer which,
                            const std::vector<AnsweredPair>& pairs, ImpulseOf impulse_of) const {
  Side &a = sides.a(), &b = sides.b();
  for (const AnsweredPair& p : pairs) {
    store3(a.impulse.data(), p.a, Vec3{}), store3(b.impulse.data(), p.b, Vec3{});
  }
  for (size_t k = 0; k < pairs.size(); ++k) {
    const AnsweredPair& p = pairs[k];
    const Vec3 j = impulse_of(k);
    store3(a.impulse.data(), p.a, load3(a.impulse.data(), p.a) - j);
    store3(b.impulse.data(), p.b, load3(b.impulse.data(), p.b) + j);
  }
  if (a.system) a.answer(in, which);
  if (b.system && !sides.one) b.answer(in, which);
  for (const AnsweredPair& p : pairs) {
    if (!a.system) store3(a.dv.data(), p.a, load3(a.impulse.data(), p.a) * p.wa);
    if (!b.system) store3(b.dv.data(), p.b, load3(b.impulse.data(), p.b) * p.wb);
  }
}

void AnsweredPairs::answer_given(const CoupledStates& s, const StepInput& in,
                                 std::vector<AnsweredPair>& pairs) const {
  Sides sides(*this, s, in);
  respond(sides, in, AnswersImpulses::Answer::first, pairs, [&](size_t k) { return pairs[k].given; });
  for (AnsweredPair& p : pairs) p.change = load3(sides.b().dv.data(), p.b) - load3(sides.a().dv.data(), p.a);
}

void AnsweredPairs::solve(const CoupledStates& s, const StepInput& in,
                          std::vector<AnsweredPair>& pairs) const {
  Sides sides(*this, s, in);
  Side &a = sides.a(), &b = sides.b();
  const size_t n = pairs.size();
  const auto y = conjugate_gradients(
      n, in.workspace.object<Workspace>("answer.solve"),
      {kAccuracy, std::min(3 * n + kSpare, kMostIterations)}, [&](size_t k) { return pairs[k].right; },
      [&](std::span<const double> d) {
        respond(sides, in, AnswersImpulses::Answer::again, pairs,
                [&](size_t k) { return shape(pairs[k], load3(d.data(), k)); });
      },
      [&](size_t k, const Vec3& d) {
        const AnsweredPair& p = pairs[k];
        return d * p.give + shape(p, load3(b.dv.data(), p.b) - load3(a.dv.data(), p.a));
      });
  respond(sides, in, AnswersImpulses::Answer::again, pairs,
          [&](size_t k) { return shape(pairs[k], load3(y.data(), k)); });
  for (size_t k = 0; k < n; ++k) {
    AnsweredPair& p = pairs[k];
    p.impulse = shape(p, load3(y.data(), k));
    p.change = load3(b.dv.data(), p.b) - load3(a.dv.data(), p.a);
  }
}

void AnsweredPairs::move(const CoupledStates& s, const StepInput& in,
                         const std::vector<AnsweredPair>& pairs) const {
  Sides sides(*this, s, in);
  respond(sides, in, AnswersImpulses::Answer::again, pairs,
          [&](size_t k) { return pairs[k].impulse - pairs[k].given; });
  const auto move_side = [&](Side& side, bool of_a, bool of_b) {
    if (side.system) {
      for (size_t i = 0; i < side.points.count; ++i) side.move(i, in.h);
      return;
    }
    // A point that responds alone moves once, however many pairs are attached to it.
    const auto once = [&](size_t row) {
      side.move(row, in.h);
      store3(side.dv.data(), row, Vec3{});
    };
    for (const AnsweredPair& p : pairs) {
      if (of_a) once(p.a);
      if (of_b) once(p.b);
    }
  };
  move_side(sides.first, true, sides.one);
  if (!sides.one) move_side(sides.second, false, true);
}

}  // namespace truestep
