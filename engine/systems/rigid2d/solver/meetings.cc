#include "engine/systems/rigid2d/solver/meetings.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/flat/distance.h"
#include "engine/math/trig.h"
#include "engine/rigid/toi_clamp.h"

namespace truestep::rigid2d {
namespace {

/// The motion of a body in the step without contacts.
struct Course {
  flat::Sweep sweep;
  Vec2 velocity;
  double spin = 0;
};

struct Courses {
  const Model& model;
  const State& s;
  const Pairs& pairs;
  double h;

  Course of(uint32_t body) const {
    const Pose& from = pairs.pose[body];
    if (body >= model.count() || pairs.active[body] == kStill) return {{from, 0, {}}, {}, 0};
    const double* v = s.f64(columns::velocity).data() + 3 * size_t{body};
    const double w = s.f64(columns::angular_velocity)[body];
    return {{from, h * w, {h * v[0], h * v[1]}}, {v[0], v[1]}, w};
  }
  /// m that any point of `b` moves in the step, seen from `a`, at most.
  double way(const Course& a, const Course& b, double reach) const {
    const Vec2 arm = b.sweep.from.p - a.sweep.from.p;
    return h * (flat::norm(b.velocity - a.velocity - a.spin * flat::left_of(arm)) +
                std::abs(b.spin - a.spin) * reach);
  }
};

/// r about the centre of a body turned by `angle`, minus r.
Vec2 turned_by(double angle, Vec2 r) {
  const trig::SinCos turn = trig::sincos(angle);
  return flat::Rotation{turn.cos, turn.sin} * r - r;
}

/// The contact of two shapes as they are after the fraction f of the step, brought back to its start: with
/// the separations that the solver, which turns the arms, sees go to those at f.
bool contact_at(const Outline& of_a, const Course& a, const Outline& of_b, const Course& b, double f,
                double margin, flat::Contact& out, Vec2& apart) {
  const Pose at_a = a.sweep.at(f), at_b = b.sweep.at(f);
  if (!flat::touch(of_a, of_b, at_a.to(at_b), margin, out)) return false;
  apart = at_b.p - at_a.p;
  out.normal = at_a.q * out.normal;
  const Vec2 n = out.normal, shift = f * (b.sweep.shift - a.sweep.shift);
  for (uint32_t k = 0; k < out.points; ++k) {
    flat::ContactPoint& p = out.point[k];
    p.at = at_a.q * p.at;
    // The rounding does not turn.
    const Vec2 ra = p.at - of_a.radius * n, rb = p.at - apart + of_b.radius * n;
    p.separation -= flat::dot(n, shift + turned_by(f * b.sweep.angle, rb) - turned_by(f * a.sweep.angle, ra));
  }
  return true;
}

struct Finder {
  const Model& model;
  const State& s;
  Pairs& pairs;
  Courses courses;
  std::span<const uint32_t> status;
  size_t known;  // hits that were there before
  bool wakes = false;

  /// Shapes i and k.
  void meet(uint32_t i, uint32_t k) {
    if (i > k) std::swap(i, k);
    const uint32_t a = model.body_of[i], b = model.body_of[k];
    const Light &la = model.light[a], &lb = model.light[b];
    // What is fixed stops bodies after the step.
    if (la.motion == Motion::fixed || lb.motion == Motion::fixed || !may_touch(model, a, b)) return;
    if (la.sensor || lb.sensor || ((status[a] | status[b]) & kRemoved)) return;
    const Course of_a = courses.of(a), of_b = courses.of(b);
    if (la.motion == Motion::dynamic && lb.motion == Motion::dynamic) {
      // Shots are stopped after the step.
      const double both = la.inner + lb.inner;
      const double turning =
          courses.h * std::max(std::abs(of_a.spin) * la.reach, std::abs(of_b.spin) * lb.reach);
      if (turning < both) return;
      if (std::max(courses.way(of_a, of_b, lb.reach), courses.way(of_b, of_a, la.reach)) < both) return;
    }
    const auto passes = [&](const Light& who, const Course& from, const Course& to) {
      return who.motion == Motion::dynamic && may_pass_through(courses.way(from, to, who.reach), who.inner);
    };
    if (!passes(lb, of_a, of_b) && !passes(la, of_b, of_a)) return;
    const uint64_t key = uint64_t{i} << 32 | k;
    const auto begin = pairs.hits.begin(), end = begin + static_cast<std::ptrdiff_t>(known);
    const auto at = std::lower_bound(begin, end, key, [](const Hit& h, uint64_t x) { return h.key() < x; });
    const bool listed = at != end && at->key() == key;
    if (listed && at->what == Hit::What::touching) return;
    const Outline &shape_a = model.shapes[i].outline, &shape_b = model.shapes[k].outline;
    const auto hit = flat::time_of_impact(shape_a, of_a.sweep, shape_b, of_b.sweep, 0.25 * model.margin);
    if (!hit || hit->fraction == 0) return;
    Met met{.key = key};
    flat::Contact contact;
    if (!contact_at(shape_a, of_a, shape_b, of_b, hit->fraction, model.margin, contact, met.apart)) return;
    size_t where = static_cast<size_t>(at - begin);
    if (!listed) {
      where = pairs.hits.size();
      pairs.hits.push_back({.a = i, .b = k, .body_a = a, .body_b = b});
      if (pairs.contacts.size() < pairs.hits.size()) pairs.contacts.resize(pairs.hits.size());
    }
    Hit& h = pairs.hits[where];
    if (passes_one_way(model, s, h, contact)) return;
    h.what = Hit::What::touching;
    pairs.contacts[where] = contact;
    pairs.met.push_back(met);
    for (const uint32_t body : {a, b}) {
      if (is_asleep(model.light[body], status[body])) pairs.seeds[body] = 1, wakes = true;
    }
  }
};

/// Sorts the hits that were added among the others.
void sort_hits(Pairs& p, size_t known) {
  const auto before = [](const Hit& a, const Hit& b) { return a.key() < b.key(); };
  if (p.hits.size() == known) return;
  std::vector<uint32_t> order(p.hits.size());
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return before(p.hits[a], p.hits[b]); });
  std::vector<Hit> hits(order.size());
  std::vector<flat::Contact> contacts(order.size());
  for (size_t i = 0; i < order.size(); ++i) hits[i] = p.hits[order[i]], contacts[i] = p.contacts[order[i]];
  p.hits.swap(hits), p.contacts.swap(contacts);
}

}  // namespace

bool find_meetings(const Model& model, const State& s, double h, Pairs& p) {
  struct Fast {
    Box box;
    uint32_t shape = 0;
  };
  std::vector<Fast> fast;
  Finder finder{model, s, p, {model, s, p, h}, s.span<uint32_t>(columns::status), p.hits.size()};
  for (uint32_t body = 0; body < model.count(); ++body) {
    if (p.active[body] != kMovesFar) continue;
    const Body& b = model.bodies[body];
    const Course course = finder.courses.of(body);
    for (uint32_t i = b.first_shape; i < b.first_shape + b.shapes; ++i) {
      const Box box = flat::swept_box(model.shapes[i].outline, course.sweep, b.reach);
      fast.push_back({box, i});
      // Others move by less than half of the thinnest body.
      const auto visit = [&](uint32_t other) {
        if (p.active[model.body_of[other]] != kMovesFar) finder.meet(i, other);
      };
      p.broad.overlapping(box.grown(0.5 * model.thinnest), Mobility::moving, visit);
      if (b.motion == Motion::dynamic) {
        p.broad.overlapping(box.grown(0.5 * model.thinnest), Mobility::fixed, visit);
      }
    }
  }
  std::sort(fast.begin(), fast.end(), [](const Fast& a, const Fast& b) { return a.box.low.x < b.box.low.x; });
  for (size_t i = 0; i < fast.size(); ++i) {
    for (size_t k = i + 1; k < fast.size() && fast[k].box.low.x <= fast[i].box.high.x; ++k) {
      if (fast[k].box.low.y <= fast[i].box.high.y && fast[i].box.low.y <= fast[k].box.high.y) {
        finder.meet(fast[i].shape, fast[k].shape);
      }
    }
  }
  sort_hits(p, finder.known);
  std::sort(p.met.begin(), p.met.end(), [](const Met& a, const Met& b) { return a.key < b.key; });
  return finder.wakes;
}

}  // namespace truestep::rigid2d
