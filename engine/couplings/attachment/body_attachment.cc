#include "engine/couplings/attachment/body_attachment.h"

#include <algorithm>
#include <cmath>

#include "engine/couplings/sides.h"

namespace truestep::attachment {

namespace {

/// Links are swept until each is within this part of its length (or of a metre); rounding itself is 1e-16.
constexpr double kLengthTolerance = 1e-13;
constexpr int kMostSweeps = 200;
/// Newton steps towards the lengths and directions at the end at most, and their own accuracy.
constexpr int kMostSolutions = 30;
constexpr double kAccuracy = 1e-12;
/// Stretch from which a spring's turning is solved for: what it was given at the start has a direction, too.
constexpr double kLeastTurned = 1e-9;

/// What the last two impulses have in common: forces last, blows do not.
Vec3 lasting(const Vec3& j, const Vec3& before) {
  const double d = dot(j, before), jj = norm2(j);
  return d > 0 ? j * std::min(1.0, d / jj) : Vec3{};
}

Vec3 arm_of(const auto& bodies, uint32_t body, const Vec3& place) {
  return rotation(bodies.orientation(body)).apply(place);
}

/// r of a pair.
Vec3 separation(const auto& points, size_t point, const auto& bodies, uint32_t body, const Vec3& place) {
  return points.place(point) - bodies.place(body) - arm_of(bodies, body, place);
}

/// Correction of r that restores |r| = L along the direction d of the substep's start; along r itself where
/// the link has turned too far for that.
Vec3 length_correction(const Vec3& r, const Vec3& d, double rest) {
  if (rest == 0) return -r;
  const double rd = dot(r, d), dd = norm2(d), excess = norm2(r) - rest * rest;
  const double discriminant = rd * rd - dd * excess;
  if (rd > 0 && discriminant > 0) return d * (-excess / (rd + std::sqrt(discriminant)));
  return normalized(r) * rest - r;
}

[[noreturn]] void refuse(const std::string& pointer, const std::string& code, const std::string& why,
                         const std::string& value, const std::string& allowed) {
  throw Error("scene_invalid", why, {{pointer, code, why, value, allowed, "", ""}});
}

/// Row that an index of the scene names.
size_t named_row(int64_t index, size_t rows, const std::string& id, const char* noun,
                 const std::string& pointer) {
  const auto n = static_cast<int64_t>(rows);
  const int64_t row = index < 0 ? n + index : index;
  if (row >= 0 && row < n) return static_cast<size_t>(row);
  refuse(pointer, "out_of_range", "\"" + id + "\" has " + std::to_string(n) + " " + noun + " at t = 0",
         std::to_string(index),
         n > 0 ? std::to_string(-n) + " to " + std::to_string(n - 1) : "nothing is there");
}

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
    p.rest = def.rest_length.value_or(norm(separation(points, i, bodies, static_cast<uint32_t>(j), p.place)));
    out->pairs_.push_back(p);
  }
  return out;
}

State BodyAttachment::initial_state() const {
  State s = exchange_state();
  if (rigid() && sides_.together()) s.add({"pair_impulse", "N s", Scalar::f64, 6}, pairs_.size());
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

std::vector<BodyAttachment::Live>& BodyAttachment::live(const Points& points, const Bodies& bodies,
                                                        const StepInput& in, When when) const {
  auto& out = in.workspace.object<std::vector<Live>>("body_attachment.live");
  out.clear();
  each(points, bodies, [&](size_t k, uint32_t i, uint32_t j) {
    Live l{k, {}, pairs_[k].place, pairs_[k].rest, {}, false};
    l.link.rows[0] = i, l.link.body = j;
    if (!rigid()) {
      // What is kicked at the start is so at the end; answers of jointed bodies change with the way.
      double& kicked = in.workspace.doubles("body_attachment.kicked", pairs_.size())[k];
      if (when == When::start) kicked = may_be_kicked(l, points, bodies, in.h);
      l.kicked = kicked != 0;
    }
    out.push_back(l);
  });
  return out;
}

bool BodyAttachment::may_be_kicked(const Live& l, const Points& points, const Bodies& bodies,
                                   double h) const {
  // At most one over the mass and one over the inertia of what hangs at its arm.
  const uint32_t b = l.link.body;
  double k = l.link.inverse_mass(points);
  if (!bodies.free()) {
    const Vec3 arm = arm_of(bodies, b, l.place);
    for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) k += bodies.inverse_mass(b, arm, n);
  } else if (bodies.dynamic(b)) {
    const BodyForm& f = bodies.form(b);
    const double least = std::min({f.moments.x, f.moments.y, f.moments.z});
    k += 1 / f.mass + norm2(l.place) / least;
  }
  double share = 0;
  for (const Pair& p : pairs_) share += p.point == pairs_[l.pair].point || p.body == pairs_[l.pair].body;
  return h * h * def_.stiffness * k * share <= (sides_.together() ? kMostKickedTogether : kMostKicked);
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
  if (rigid() && sides_.together()) give_last(s, in, sum);
  if (!rigid() && sides_.together()) give_first(s, in, sum);
  book_sum(s.own, sum);
}

// Half of a substep's impulse of soft springs: J = -h/2 k (|r| - L) n.
void BodyAttachment::pull(const std::vector<Live>& live, Points& points, Bodies& bodies, double h,
                          Exchange& sum) const {
  for (const Live& l : live) {
    if (!l.kicked) continue;
    const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
    const Vec3 stretch = l.rest == 0 ? r : r - normalized(r) * l.rest,
               j = stretch * (-0.5 * h * def_.stiffness);
    l.link.push(points, bodies, j);
    sum.add(-j, 0);
  }
}

// du/dt = -c K u along n by the trapezoid rule: u' = u (1 - q) / (1 + q), q = c K h / 4.
void BodyAttachment::damp(const std::vector<Live>& live, Points& points, Bodies& bodies, double h,
                          Exchange& sum) const {
  if (def_.damping == 0) return;
  for (const Live& l : live) {
    if (!l.kicked) continue;
    const uint32_t b = l.link.body;
    const Vec3 r = separation(points, l.link.rows[0], bodies, b, l.place),
               u = l.link.relative(points, bodies);
    if (!(norm2(r) > 0)) continue;
    const Vec3 n = normalized(r);
    const double k = l.link.inverse_mass(points) + bodies.inverse_mass(b, l.link.arm(points, bodies), n);
    const double q = 0.25 * def_.damping * k * h, speed = dot(u, n), j = -2 * q / ((1 + q) * k) * speed;
    l.link.push(points, bodies, n * j);
    sum.add(n * -j, -j * (speed + 0.5 * k * j));
  }
}

// A body takes its part as a force that acts throughout the step.
void BodyAttachment::give(const BodyLink& link, const Vec3& j, Points& points, Bodies& bodies, double h) {
  const uint32_t b = link.body;
  const Vec3 v = bodies.velocity(b), w = bodies.spin(b);
  link.push(points, bodies, j);
  if (!bodies.free()) return bodies.shift(b, link.arm(points, bodies), j * (0.5 * h), {});
  if (bodies.dynamic(b)) {
    bodies.move(b, (bodies.velocity(b) - v) * (-0.5 * h), (bodies.spin(b) - w) * (-0.5 * h));
  }
}

// Forces last about as long as many steps do.
void BodyAttachment::give_last(const CoupledStates& s, const StepInput& in, Exchange& sum) const {
  Points points(this->points(s), sides_.points());
  Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
  const auto columns = s.own.find("pair_impulse");
  if (!columns) return;
  double* last = s.own.f64(*columns).data();
  for (const Live& l : live(points, bodies, in)) {
    const Vec3 j = lasting(load3(last, 2 * l.pair), load3(last, 2 * l.pair + 1));
    store3(last, 2 * l.pair + 1, load3(last, 2 * l.pair));
    store3(last, 2 * l.pair, j);
    if (j == Vec3{}) continue;
    give(l.link, j, points, bodies, in.h);
    sum.add(-j, 0);
  }
}

// What a stretched spring pulls with at the start, so that what it holds is loaded while it moves: a rope
// that hung loose for a step would be straightened by its load along directions that it no longer has.
void BodyAttachment::give_first(const CoupledStates& s, const StepInput& in, Exchange& sum) const {
  Points points(this->points(s), sides_.points());
  Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
  double* given = in.workspace.doubles("body_attachment.given", 3 * pairs_.size()).data();
  for (const Live& l : live(points, bodies, in)) {
    if (l.kicked) continue;
    const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
    const double stretch = norm(r) - l.rest;
    const Vec3 j = stretch > 0 ? normalized(r) * (-in.h * def_.stiffness * stretch) : Vec3{};
    store3(given, l.pair, j);
    if (j == Vec3{}) continue;
    give(l.link, j, points, bodies, in.h);
    sum.add(-j, 0);
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

// J = -h f(r', u') with f = K r' - k L n + c (u'.n) n: couplings/attachment.cc has the equations.
void BodyAttachment::solve_springs(const CoupledStates& s, const StepInput& in, std::vector<Live>& all,
                                   Exchange& sum) const {
  Points points(this->points(s), sides_.points());
  Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
  auto& links = in.workspace.object<std::vector<AnsweredLink>>("body_attachment.links");
  links.clear();
  const double k = def_.stiffness, c = def_.damping, h = in.h;
  const double* given =
      sides_.together() ? in.workspace.doubles("body_attachment.given", 3 * pairs_.size()).data() : nullptr;
  for (const Live& l : all) {
    if (l.kicked) continue;
    const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
    const Vec3 u = l.link.relative(points, bodies), j0 = given ? load3(given, l.pair) : Vec3{};
    AnsweredLink a;
    a.link = l.link, a.n = l.rest == 0 ? Vec3{} : normalized(r);
    a.give = 1, a.along = std::sqrt(h * (h * k + c));
    if (l.rest == 0) {
      a.across = a.along;
      a.right = (r * k + u * c) * (-h / a.along) - j0 / a.along;
    } else {
      a.across = h * std::sqrt(k * std::max(kLeastTurned, 1 - l.rest / std::max(norm(r), l.rest)));
      const double along = dot(j0, a.n);
      a.right = a.n * (-h / a.along * (k * (dot(r, a.n) - l.rest) + c * dot(u, a.n)) - along / a.along) -
                (j0 - a.n * along) / a.across;
    }
    links.push_back(a);
  }
  if (links.empty()) return;
  sides_.solve(this->points(s), this->bodies(s), in, links, kAccuracy, 3 * links.size() + 10);
  sides_.move(this->points(s), this->bodies(s), in, links);
  for (const AnsweredLink& a : links) {
    const Vec3 u = a.link.relative(points, bodies);
    const double u2 = a.n == Vec3{} ? norm2(u) : dot(u, a.n) * dot(u, a.n);
    sum.add(-a.impulse, h * c * u2);
  }
}

// Newton's method for the lengths at the end, both sides solved as one.
void BodyAttachment::solve_links(const CoupledStates& s, const StepInput& in, std::vector<Live>& all,
                                 Exchange& sum) const {
  Points points(this->points(s), sides_.points());
  Bodies bodies(this->bodies(s), sides_.bodies(), &in.workspace);
  auto& links = in.workspace.object<std::vector<AnsweredLink>>("body_attachment.links");
  const auto column = s.own.find("pair_impulse");
  double* last = column ? s.own.f64(*column).data() : nullptr;
  for (int solution = 0; solution < kMostSolutions; ++solution) {
    links.clear();
    double worst = 0;
    for (const Live& l : all) {
      const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
      AnsweredLink a;
      a.link = l.link;
      a.n = l.rest == 0 ? Vec3{} : normalized(r);
      a.across = l.rest == 0 ? 1 : 0;
      a.right = (l.rest == 0 ? -r : a.n * (l.rest - norm(r))) / in.h;
      worst = std::max(worst, norm(a.right) * in.h / std::max(l.rest, 1.0));
      links.push_back(a);
    }
    if (worst <= kLengthTolerance) break;
    sides_.solve(this->points(s), this->bodies(s), in, links, kAccuracy, 3 * links.size() + 10);
    sides_.move(this->points(s), this->bodies(s), in, links);
    for (size_t k = 0; k < links.size(); ++k) {
      sum.add(-links[k].impulse, 0);
      if (last) store3(last, 2 * all[k].pair, load3(last, 2 * all[k].pair) + links[k].impulse);
    }
  }
}

// SHAKE's part: every correction of place is one of velocity, 1/h times it, too. The impulse acts on the body
// where the link does; what that and the correction leave of the angular momentum is of second order.
void BodyAttachment::restore_lengths(const std::vector<Live>& live, Points& points, Bodies& bodies, double h,
                                     Exchange& sum) const {
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double worst = 0;
    for (const Live& l : live) {
      const uint32_t b = l.link.body;
      const size_t i = l.link.rows[0];
      const Vec3 arm = arm_of(bodies, b, l.place), r = l.link.place(points) - bodies.place(b) - arm;
      const Vec3 dr = length_correction(r, l.start, l.rest);
      worst = std::max(worst, norm(dr) / std::max(l.rest, 1.0));
      const double size = norm(dr);
      if (!(size > 0)) continue;
      const double w = points.inverse_mass(i);
      const Vec3 n = dr / size, p = dr / (w + bodies.inverse_mass(b, arm, n)), j = p / h;
      points.accelerate(i, j * w);
      bodies.push(b, arm, -j);
      const Vec3 gained = (w > 0 ? cross(r, j) : Vec3{}) + l.link.gained(points, bodies, p);
      points.shift(i, p * w);
      bodies.shift(b, arm, -p, w > 0 ? gained : Vec3{});
      sum.add(-j, 0);
    }
    if (worst <= kLengthTolerance) break;
  }
}

// RATTLE's part: u.n = 0, or u = 0 where two places are one: then the directions are taken one by one.
void BodyAttachment::match_velocities(const std::vector<Live>& live, Points& points, Bodies& bodies,
                                      Exchange& sum) const {
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double worst = 0, fastest = 0;
    for (const Live& l : live) {
      const Vec3 arm = l.link.arm(points, bodies), u = l.link.relative(points, bodies);
      const Vec3 r = separation(points, l.link.rows[0], bodies, l.link.body, l.place);
      const Vec3 along = l.rest == 0 ? u : normalized(r) * dot(u, normalized(r));
      const double speed = norm(along);
      worst = std::max(worst, speed),
      fastest = std::max(fastest, norm(u) + norm(bodies.velocity(l.link.body)));
      if (!(speed > 0)) continue;
      const Vec3 n = along / speed;
      const double k = l.link.inverse_mass(points) + bodies.inverse_mass(l.link.body, arm, n);
      const Vec3 j = n * (-speed / k);
      l.link.push(points, bodies, j);
      sum.add(-j, 0.5 * speed * speed / k);
    }
    if (worst <= kLengthTolerance * fastest) break;
  }
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

std::vector<PlanRow> BodyAttachment::plan() const {
  using enum PlanRow::Status;
  const std::string count = std::to_string(pairs_.size()) + (pairs_.size() == 1 ? " pair" : " pairs");
  if (rigid()) {
    const char* together = sides_.together() ? ", solved for with all that is tied to them" : "";
    return {{runs, pass(), count + " of a point and a place on a body at a fixed distance" + together},
            {skipped, "damping", "rigid links have none"}};
  }
  std::vector<PlanRow> rows{
      {runs, pass(),
       count +
           " of a point and a place on a body, a kick at both ends of the substep; stiff ones solved for"}};
  if (def_.damping > 0) {
    rows.push_back({runs, "damping", "along the pairs"});
  } else {
    rows.push_back({skipped, "damping", "damping is 0"});
  }
  return rows;
}

}  // namespace truestep::attachment
