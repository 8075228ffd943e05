#include "engine/systems/nbody/collisions/impacts.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/integrators/control/last_force.h"
#include "engine/integrators/field_equations.h"
#include "engine/integrators/table/integrators.h"
#include "engine/systems/nbody/collisions/block_watch.h"
#include "engine/systems/nbody/collisions/collisions.h"
#include "engine/systems/nbody/collisions/meetings.h"
#include "engine/systems/nbody/collisions/pair_meeting.h"
#include "engine/systems/nbody/collisions/supported_field.h"

namespace truestep::nbody {

namespace {

constexpr int kFewPieces = 256, kManyPieces = 32;  // of a step; with more than kEveryPair bodies
constexpr int kNearMisses = 16;

/// Scratch memory of a step.
struct Work {
  std::vector<double> x, v, start, end, point;
  std::vector<std::vector<double>> carried;  // the method's columns
  std::vector<Touch> touches, parts;
  std::vector<Pair> missed;
  Meetings::Memory meetings;
};

class Impacts final : public StepWatcher {
 public:
  Impacts(const ForceField& field, const Integrator& method, const IntegratorOptions& options,
          const CollisionsDef& def, State& s, const StepInput& in)
      : field_(field),
        method_(method),
        options_(options),
        def_(def),
        s_(s),
        balls_(s),
        in_(in),
        w_(in.workspace.object<Work>("nbody.impacts")),
        meetings_(def, s, in, method.stepping == Integrator::Stepping::fixed, w_.meetings) {}

  void run() {
    const auto internal = s_.find("integrator.internal_step");
    const double end = in_.t + in_.h;
    double t = in_.t, h = in_.h, proposed = 0;
    const int most = bodies() <= kEveryPair ? kFewPieces : kManyPieces;
    for (int piece = 0; h > 1e-12 * in_.h; ++piece) {
      blunt_ = piece >= most;
      if (internal) proposed = std::min(in_.h, s_.f64(*internal)[0]);
      const std::optional<double> used = advance(t, h);
      if (!used) break;
      t += *used, h = end - t;
      meetings_.resolve(t, std::exchange(hit_, {}), blunt_);
    }
    // A short piece at the end says nothing about the next step.
    if (internal && h < in_.h) s_.f64(*internal)[0] = std::max(s_.f64(*internal)[0], proposed);
    if (blunt_) {
      ++impact(s_, Impact::left_over);
      meetings_.resolve(end, std::exchange(hit_, {}), blunt_);
    }
    meetings_.hold();
  }

  Verdict accepted(double t0, double& t1, double* y1, const Interpolant& between) override {
    const size_t n = bodies();
    w_.start.resize(6 * n), w_.end.resize(6 * n), w_.point.resize(6 * n);
    const double h = t1 - t0;
    const auto piece = [n](const std::vector<double>& from, const double* to, double length) {
      return PathPiece{from.data(), from.data() + 3 * n, to, to + 3 * n, n, length};
    };
    between.at(0, w_.start.data());
    // How far the path may be from the cubic through its ends, in parts of its length.
    constexpr double kSlack = 0.05;
    constexpr int kParts = 8;
    find(piece(w_.start, y1, h), kSlack, w_.touches);
    if (w_.touches.empty()) return Verdict::go_on;
    w_.missed.clear();
    for (int k = 1; k <= kParts; ++k) {
      const double from = (k - 1) / static_cast<double>(kParts), to = k / static_cast<double>(kParts);
      between.at(to, w_.end.data());
      find(piece(w_.start, w_.end.data(), h / kParts), 0, w_.parts);
      for (const Touch& touch : w_.parts) {
        const auto look = [&](double theta) {
          between.at(theta, w_.point.data());
          return gap(touch.a, touch.b, w_.point.data(), w_.point.data() + 3 * n);
        };
        const auto theta = time_of_meeting(
            [&](double at) {
              Gap g = look(at);
              g.closing *= h;
              return g;
            },
            from + touch.share / kParts, 1, kTouching * balls_.reach(touch.a, touch.b));
        if (!theta) {
          w_.missed.push_back({touch.a, touch.b});
          continue;
        }
        t1 = t0 + *theta * h;
        hit_ = {touch.a, touch.b};
        std::copy(w_.point.begin(), w_.point.end(), y1);
        return Verdict::stop;
      }
      std::swap(w_.start, w_.end);
    }
    return Verdict::go_on;
  }

 private:
  size_t bodies() const { return balls_.count(); }
  double* x() { return balls_.x(); }
  double* v() { return balls_.v(); }
  Gap gap(uint32_t a, uint32_t b, const double* x, const double* v) const {
    return Gap::of(load3(x, b) - load3(x, a), load3(v, b) - load3(v, a), balls_.reach(a, b));
  }
  bool skipped(uint32_t a, uint32_t b) {
    return w_.meetings.met.resting(a, b) || std::ranges::find(w_.missed, Pair{a, b}) != w_.missed.end();
  }
  void find(const PathPiece& piece, double slack, std::vector<Touch>& out) {
    find_touches(
        piece, balls_.radii(), slack, [this](uint32_t a, uint32_t b) { return skipped(a, b); }, in_.workspace,
        out);
  }

  /// Until two bodies touch; returns how long that took (s), or nothing when the piece of h (s) is over.
  std::optional<double> advance(double t, double h) {
    w_.missed.clear();
    if (blunt_) {
      step(t, h);
      return std::nullopt;
    }
    if (method_.stepping == Integrator::Stepping::fixed || !method_.advance) return advance_whole(t, h);
    auto& watch = in_.workspace.object<FieldWatch>(kFieldWatch);
    watch.watcher = this;
    try {
      step(t, h);
    } catch (...) {
      watch.watcher = nullptr;
      throw;
    }
    watch.watcher = nullptr;
    const double end = t + h;
    return watch.reached < end - 1e-12 * in_.h ? std::optional(watch.reached - t) : std::nullopt;
  }

  std::optional<double> advance_whole(double t, double h) {
    keep();
    for (int tries = 0; tries < kNearMisses; ++tries) {
      if (tries > 0) restore();
      step_watched(t, h);
      if (w_.touches.empty()) return std::nullopt;
      if (bodies() > kEveryPair && method_.advance && weak(h)) {
        impact(s_, Impact::left_over) +=
            static_cast<double>(collide_apart(s_, def_, kept_piece(h), w_.touches, in_.workspace));
        return std::nullopt;
      }
      if (const auto used = locate(t, h)) return used;
    }
    ++impact(s_, Impact::left_over);
    return std::nullopt;
  }

  /// The time of the first touch, with the state there.
  std::optional<double> locate(double t, double h) {
    constexpr int kEarlier = 8;
    std::optional<double> used;
    Pair located{};
    for (int k = 0; k < kEarlier; ++k) {
      const Touch first = w_.touches.front();
      hit_ = {first.a, first.b};
      if (first.share == 0) {
        restore();
        return 0;
      }
      const double guess = first.share * (used ? *used : h);
      const auto found = time_of_meeting(
          [&](double after) {
            restore();
            step(t, after);
            return gap(first.a, first.b, x(), v());
          },
          guess, used ? *used : h, kTouching * balls_.reach(first.a, first.b));
      if (!found) {
        w_.missed.push_back({first.a, first.b});
        if (!used) return std::nullopt;
        hit_ = located;
        restore();
        step(t, *used);
        return used;
      }
      used = found, located = hit_;
      const MetPair before = w_.meetings.met.of(first.a, first.b);
      w_.meetings.met.of(first.a, first.b).resting = true;  // it is not looked for again
      find(kept_piece(*used), 0, w_.touches);
      w_.meetings.met.of(first.a, first.b) = before;
      if (w_.touches.empty() || w_.touches.front().share > 1 - 1e-9) return used;
    }
    return used;
  }

  void step(double t, double h) {
    StepInput piece = in_;
    piece.t = t, piece.h = h;
    // A part of a step does not end at a multiple of its own length.
    if (h != in_.h) piece.step = std::numeric_limits<uint64_t>::max();
    const bool any = std::ranges::any_of(w_.meetings.met.all(), [](const MetPair& p) { return p.resting; });
    if (!any) return method_.step(field_, s_, piece, options_);
    // What a method remembers of the last force belongs to other supports.
    const auto forget = [&] { in_.workspace.object<LastForce>("integrator.last_force") = {}; };
    forget();
    const SupportedField field(field_, w_.meetings.met.all());
    // The accelerations against which ias15 measures its error vanish where bodies rest.
    static const Integrator* const kAtRest = find_integrator("dop853");
    if (method_.name == "ias15" && kAtRest) {
      IntegratorOptions options = options_;
      options.tolerance = std::max(options.tolerance, 1e-10);
      kAtRest->step(field, s_, piece, options);
    } else {
      method_.step(field, s_, piece, options_);
    }
    forget();
  }
  /// With the touches of the whole piece.
  void step_watched(double t, double h) {
    if (method_.advance || method_.stepping == Integrator::Stepping::fixed) {
      step(t, h);
      find(kept_piece(h), 0, w_.touches);
      return;
    }
    auto& watch = in_.workspace.object<BlockWatch>(kBlockWatch);
    watch.on = true, watch.touches.clear();
    watch.skip = [this](uint32_t a, uint32_t b) { return skipped(a, b); };
    step(t, h);
    watch.on = false;
    w_.touches = watch.touches;
  }

  PathPiece kept_piece(double h) { return {w_.x.data(), w_.v.data(), x(), v(), bodies(), h}; }
  bool carried(State::Column c) const {
    return s_.info(c).type == Scalar::f64 && s_.info(c).name.starts_with("integrator.");
  }
  void keep() {
    w_.x.assign(x(), x() + 3 * bodies()), w_.v.assign(v(), v() + 3 * bodies());
    w_.carried.resize(s_.columns());
    for (State::Column c = 0; c < s_.columns(); ++c) {
      if (!carried(c)) continue;
      const auto values = s_.f64(c);
      w_.carried[c].assign(values.begin(), values.end());
    }
  }
  void restore() {
    std::ranges::copy(w_.x, x()), std::ranges::copy(w_.v, v());
    for (State::Column c = 0; c < s_.columns(); ++c) {
      if (!carried(c)) continue;
      s_.resize(c, w_.carried[c].size() / s_.info(c).width);
      std::ranges::copy(w_.carried[c], s_.f64(c).begin());
    }
  }

  /// Whether what the pairs that touch do to each other's speed during a step is nothing to it.
  bool weak(double h) {
    if (def_.response == Response::merge) return true;
    constexpr double kNothing = 0.01;
    const PathPiece piece = kept_piece(h);
    return std::ranges::all_of(w_.touches, [&](const Touch& t) {
      const double r = balls_.reach(t.a, t.b), u = norm(piece.between(t.a, t.b).slope(t.share)) / h;
      return balls_.gravitational_constant() * (balls_.mass(t.a) + balls_.mass(t.b)) / (r * r) * h <=
             kNothing * u;
    });
  }

  const ForceField& field_;
  const Integrator& method_;
  const IntegratorOptions& options_;
  const CollisionsDef& def_;
  State& s_;
  const Balls balls_;
  const StepInput& in_;
  Work& w_;
  Meetings meetings_;
  Pair hit_{};          ///< found by `advance`
  bool blunt_ = false;  ///< no more collisions in this step
};

}  // namespace

void step_with_collisions(const ForceField& field, const Integrator& method, const IntegratorOptions& options,
                          const CollisionsDef& def, State& s, const StepInput& in) {
  Impacts(field, method, options, def, s, in).run();
}

}  // namespace truestep::nbody
