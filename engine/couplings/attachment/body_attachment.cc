#include "engine/couplings/attachment/body_attachment.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/collision/point_distance.h"
#include "engine/couplings/attachment/link_work.h"
#include "engine/couplings/attachment/links.h"
#include "engine/couplings/attachment/places.h"
#include "engine/couplings/sides.h"
#include "engine/geometry/solid.h"

namespace truestep::attachment {

namespace {

[[noreturn]] void refuse(const std::string& pointer, const std::string& code, const std::string& why,
                         const std::string& value, const std::string& allowed) {
  throw Error("scene_invalid", why, {pointer, code, why, value, allowed, "", ""});
}

/// Row with an index from the scene.
size_t named_row(int64_t index, size_t rows, const std::string& id, const char* noun,
                 const std::string& pointer) {
  const auto n = static_cast<int64_t>(rows);
  const int64_t row = index < 0 ? n + index : index;
  if (row >= 0 && row < n) return static_cast<size_t>(row);
  refuse(pointer, "out_of_range", "\"" + id + "\" has " + std::to_string(n) + " " + noun + " at t = 0",
         std::to_string(index),
         n > 0 ? std::to_string(-n) + " to " + std::to_string(n - 1) : "there is no such row");
}

/// Share of the distance to a body's centre within which a point is at its surface: it is more likely meant
/// to hold there. A ball's surface and centre pull alike.
constexpr double kAtSurface = 0.1;

/// The doubt about a pair that ties a point to a body's centre; empty if there is none.
std::string off_centre(const ConstPoints& points, size_t i, const ConstBodies& bodies, size_t j,
                       const std::string& points_id, const std::string& bodies_id) {
  const Solid* solid = bodies.form(j).solid;
  if (!solid || solid->kind == SolidKind::sphere) return "";
  const Vec3 at = points.place(i), arm = at - bodies.place(j);
  const double away = norm(arm);
  const auto near =
      point_distance(*solid, rotation(bodies.orientation(j)).apply_inverse(arm), away, mesh_sides(*solid));
  if (!near || std::abs(near->distance) > kAtSurface * away) return "";
  const auto point = [](const Vec3& p) {
    return '[' + short_number(p.x) + ", " + short_number(p.y) + ", " + short_number(p.z) + ']';
  };
  return "point " + std::to_string(i) + " of \"" + points_id + "\" is tied to the centre of body " +
         std::to_string(j) + " of \"" + bodies_id + "\", " + short_number(away, 3) +
         " m away, though it is at its surface: places [" + point(at) + "] would tie it there";
}

/// Fraction of a spring's stretch that may change in a substep for its force to be predicted. With 0.15 none
/// of 20,000 bodies on ropes gains energy. Long springs that are never predicted do (three of 4,000; two of
/// these with 0.03 still), and stiff ones when only the direction's change is bounded (five of 8,000, to 0.1
/// rad). Those eight gain nothing with 0.1 and 0.2 either.
constexpr double kSteady = 0.15;

}  // namespace

std::unique_ptr<const BodyAttachment> BodyAttachment::make(const AttachmentDef& def,
                                                           const CouplingContext& context) {
  const bool first = context.a.system.ports().bodies.has_value();
  const CouplingSide &body_side = first ? context.a : context.b, &point_side = first ? context.b : context.a;
  const PointPort columns = require_points(point_side, first ? "b" : "a");
  const BodyPort body_columns = *body_side.system.ports().bodies;
  std::unique_ptr<BodyAttachment> out(
      new BodyAttachment(def, PointsOnBodies(point_side.system, columns, body_columns)));
  out->bodies_first_ = first;
  out->at_centres_ = def.places.empty();
  const ConstPoints points(point_side.state, columns);
  const ConstBodies bodies(body_side.state, body_columns);
  const auto &point_rows = first ? def.b_points : def.a_points,
             &body_rows = first ? def.a_points : def.b_points;
  const std::string at_points = first ? "/b_points/" : "/a_points/",
                    at_bodies = first ? "/a_points/" : "/b_points/";
  for (size_t k = 0; k < point_rows.size(); ++k) {
    const std::string number = std::to_string(k);
    const size_t i = named_row(point_rows[k], points.count, point_side.id, "points", at_points + number);
    const size_t j = named_row(body_rows[k], bodies.count(), body_side.id, "bodies", at_bodies + number);
    Pair p{points.id_of(i), bodies.id_of(j), {}, 0};
    if (!def.places.empty()) {
      p.place = rotation(bodies.orientation(j)).apply_inverse(def.places[k] - bodies.place(j));
    }
    if (def.places.empty()) {
      std::string doubt = off_centre(points, i, bodies, j, point_side.id, body_side.id);
      if (!doubt.empty()) out->doubts_.push_back(std::move(doubt));
    }
    p.rest = def.rest_length.value_or(norm(separation(points, i, bodies, static_cast<uint32_t>(j), p.place)));
    out->pairs_.push_back(p);
  }
  return out;
}

State BodyAttachment::initial_state() const {
  State s = exchange_state();
  if (sides_.together()) s.add({kPairForce, "N", Scalar::f64, 6}, pairs_.size());
  return s;
}

void BodyAttachment::book_sum(State& own, Exchange sum) const {
  if (bodies_first_) sum.impulse = -sum.impulse;
  book(own, sum);
}

void BodyAttachment::each(const auto& points, const auto& bodies, auto&& visit) const {
  for (size_t k = 0; k < pairs_.size(); ++k) {
    const auto i = points.row_of(pairs_[k].point), j = bodies.row_of(pairs_[k].body);
    if (i && j && (points.inverse_mass(*i) > 0 || bodies.dynamic(*j))) {
      visit(k, static_cast<uint32_t>(*i), static_cast<uint32_t>(*j));
    }
  }
}

bool BodyAttachment::may_be_kicked(size_t pair, const BodyLink& link, const auto& points, const auto& bodies,
                                   double h) const {
  // Bound: one over the mass plus one over the inertia at the arm.
  const uint32_t b = link.body;
  const Vec3& place = pairs_[pair].place;
  double k = link.inverse_mass(points);
  if (!bodies.free()) {
    const Vec3 arm = arm_of(bodies, b, place);
    for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) k += bodies.inverse_mass(b, arm, n);
  } else if (bodies.dynamic(b)) {
    const BodyForm& f = bodies.form(b);
    const double least = std::min({f.moments.x, f.moments.y, f.moments.z});
    k += 1 / f.mass + norm2(place) / least;
  }
  double share = 0;
  for (const Pair& p : pairs_) share += p.point == pairs_[pair].point || p.body == pairs_[pair].body;
  return h * h * def_.stiffness * k * share <= (sides_.together() ? kMostKickedTogether : kMostKicked);
}

std::vector<BodyAttachment::Live>& BodyAttachment::live(const Points& points, const Bodies& bodies,
                                                        const StepInput& in, When when) const {
  auto& out = in.workspace.object<std::vector<Live>>("body_attachment.live");
  out.clear();
  each(points, bodies, [&](size_t k, uint32_t i, uint32_t j) {
    Live l{k, {}, pairs_[k].place, pairs_[k].rest, {}, false};
    l.link.rows[0] = i, l.link.body = j, l.link.held = pairs_[k].place;
    if (!rigid()) {
      // A spring kicked at the start is also kicked at the end; responses of jointed bodies change along the
      // way.
      double& kicked = in.workspace.doubles("body_attachment.kicked", pairs_.size())[k];
      if (when == When::start) kicked = may_be_kicked(k, l.link, points, bodies, in.h);
      l.kicked = kicked != 0;
    }
    out.push_back(l);
  });
  return out;
}

void BodyAttachment::begin(const CoupledStates& s, const StepInput& in) const {
  const ProfileScope scope(in.profile, pass());
  Exchange sum;
  {
    Points points(this->points(s), sides_.points());
    Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
    if (!rigid()) {
      const auto& pairs = live(points, bodies, in, When::start);
      pull(pairs, points, bodies, in.h, sum);
      damp(pairs, points, bodies, in.h, sum);
    }
    double* start = in.workspace.doubles("body_attachment.start", 3 * pairs_.size()).data();
    each(points, bodies, [&](size_t k, uint32_t i, uint32_t j) {
      store3(start, k, separation(points, i, bodies, j, pairs_[k].place));
    });
  }
  if (sides_.together()) give_last(s, in, sum);
  book_sum(s.own, sum);
}

// Loads typically last for many steps: both sides include the last forces in their own step, so that whatever
// is held is loaded while it moves; a rope left slack for a step would be straightened by its load along
// directions that it no longer has. A soft spring's force is that of its stretch, no larger than at the start
// and towards where both ends are moving: the last one lags by a step, from which a load on a long spring
// gained a tenth of its energy in two swings. A stiff spring's is not: what is predicted from a stretch that
// changes within the step feeds on itself, in its size and in the direction in which a light end was thrown.
void BodyAttachment::give_last(const CoupledStates& s, const StepInput& in, Exchange& sum) const {
  Points points(this->points(s), sides_.points());
  Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
  double* last = pair_forces(s.own);
  if (!last) return;
  for (const Live& l : live(points, bodies, in)) {
    Vec3 force = l.kicked ? Vec3{} : lasting(last, l.pair);
    if (!l.kicked && (!rigid() || l.rest > 0)) {
      const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
      const Vec3 change = l.link.relative(points, bodies) * in.h, later = r + change;
      const double stretch = norm(r) - l.rest;
      if (!rigid() && norm(change) <= kSteady * stretch) {
        force = normalized(later) * (-def_.stiffness * std::min(stretch, norm(later) - l.rest));
      } else if (l.rest > 0) {
        force = turned(force, r, later);
      }
    }
    pass_on(last, l.pair, force);
    if (force == Vec3{}) continue;
    give(l.link, force * in.h, points, bodies, in.h);
    sum.add(force * -in.h, 0);
  }
}

// A body takes its part as a force acting throughout the step.
void BodyAttachment::give(const BodyLink& link, const Vec3& j, Points& points, Bodies& bodies, double h) {
  const uint32_t b = link.body;
  const Vec3 v = bodies.velocity(b), w = bodies.spin(b);
  link.push(points, bodies, j);
  if (!bodies.free()) return bodies.shift(b, link.arm(points, bodies), j * (0.5 * h), {});
  if (bodies.dynamic(b)) {
    bodies.move(b, (bodies.velocity(b) - v) * (-0.5 * h), (bodies.spin(b) - w) * (-0.5 * h));
  }
}

void BodyAttachment::end(const CoupledStates& s, const StepInput& in) const {
  const ProfileScope scope(in.profile, pass());
  Points points(this->points(s), sides_.points());
  Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
  Exchange sum;
  std::vector<Live>& pairs = live(points, bodies, in);
  const double* start = in.workspace.doubles("body_attachment.start", 3 * pairs_.size()).data();
  for (Live& l : pairs) l.start = load3(start, l.pair);
  if (!rigid()) {
    solve_springs(s, in, pairs, sum);
    damp(pairs, points, bodies, in.h, sum);
    pull(pairs, points, bodies, in.h, sum);
  } else {
    if (sides_.together()) {
      solve_links(s, in, pairs, sum);
    } else {
      restore_lengths(pairs, points, bodies, in.h, sum);
    }
    match_velocities(pairs, points, bodies, sum);
  }
  book_sum(s.own, sum);
}

void BodyAttachment::observe(const ConstCoupledStates& s, Observables& out) const {
  const ConstPoints points(bodies_first_ ? s.b : s.a, sides_.points());
  const ConstBodies bodies(bodies_first_ ? s.a : s.b, sides_.bodies());
  double error = 0, count = 0;
  each(points, bodies, [&](size_t k, uint32_t i, uint32_t j) {
    const Vec3 r = separation(points, i, bodies, j, pairs_[k].place);
    error = std::max(error, std::abs(norm(r) - pairs_[k].rest));
    ++count;
  });
  observe_exchange(s.own, out);
  if (rigid()) {
    out.add("length.error", error, "m");
  } else {
    out.add("energy.potential", stored_energy(s), "J");
  }
  out.add("pairs", count, "1");
}

void BodyAttachment::draw(const ConstCoupledStates& s, std::vector<DrawnString>& out) const {
  const ConstPoints points(bodies_first_ ? s.b : s.a, sides_.points());
  const ConstBodies bodies(bodies_first_ ? s.a : s.b, sides_.bodies());
  each(points, bodies, [&](size_t k, uint32_t i, uint32_t j) {
    const StringEnd point{bodies_first_ ? 1u : 0u, i, {}}, body{bodies_first_ ? 0u : 1u, j, pairs_[k].place};
    out.push_back(bodies_first_ ? DrawnString{body, point} : DrawnString{point, body});
  });
}

double BodyAttachment::stored_energy(const ConstCoupledStates& s) const {
  if (rigid()) return 0;
  const ConstPoints points(bodies_first_ ? s.b : s.a, sides_.points());
  const ConstBodies bodies(bodies_first_ ? s.a : s.b, sides_.bodies());
  double stored = 0;
  each(points, bodies, [&](size_t k, uint32_t i, uint32_t j) {
    const double stretch = norm(separation(points, i, bodies, j, pairs_[k].place)) - pairs_[k].rest;
    stored += 0.5 * def_.stiffness * stretch * stretch;
  });
  return stored;
}

// Every solution has a matrix of its own.
std::optional<double> BodyAttachment::step_seconds(const ConstCoupledStates& s, double h) const {
  const ConstPoints points(bodies_first_ ? s.b : s.a, sides_.points());
  const ConstBodies bodies(bodies_first_ ? s.a : s.b, sides_.bodies());
  double solved = 0, directions = 0;
  each(points, bodies, [&](size_t k, uint32_t i, uint32_t j) {
    BodyLink link;
    link.rows[0] = i, link.body = j, link.held = pairs_[k].place;
    if (!rigid() && bodies.free() && may_be_kicked(k, link, points, bodies, h)) return;
    ++solved, directions += pairs_[k].rest == 0 ? 3 : 1;
  });
  double seconds = kKickSeconds * static_cast<double>(pairs_.size()) + kSweepSeconds * solved;
  if (solved > 0 && sides_.together()) {
    const auto answer = sides_.answer_seconds();
    seconds += kClosings * (answer.first + (asked(directions) + 1) * answer.again);
  }
  return seconds;
}

std::vector<PlanRow> BodyAttachment::plan() const {
  using enum PlanRow::Status;
  const std::string count = std::to_string(pairs_.size()) + (pairs_.size() == 1 ? " pair" : " pairs");
  const std::string where = at_centres_ ? "the centre of a body" : "a point of a body";
  if (rigid()) {
    const char* together = sides_.together() ? ", solved together with everything attached to them" : "";
    return {{runs, pass(), count + " of a point and " + where + " at a fixed distance" + together},
            {skipped, "damping", "rigid links have none"}};
  }
  std::vector<PlanRow> rows{{runs, pass(),
                             count + " of a point and " + where +
                                 ", a kick at both ends of the substep; stiff ones solved together"}};
  if (def_.damping > 0) {
    rows.push_back({runs, "damping", "along the pairs"});
  } else {
    rows.push_back({skipped, "damping", "damping is 0"});
  }
  return rows;
}

}  // namespace truestep::attachment
