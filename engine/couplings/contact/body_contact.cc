#include "engine/couplings/contact/body_contact.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/points/collider_set.h"
#include "engine/core/equations/impulse_answer.h"
#include "engine/couplings/sides.h"

namespace truestep::contact {

namespace {

/// Columns of the coupling's own state, for the last substep.
enum : State::Column {
  kBodyContacts = exchange_columns::end,  ///< u64
  kDeepest,                               ///< f64, m
  kLoads  ///< f64 x 3, N, per initial body: its load in the last substep in which it was awake
};
/// Most searches per substep; anything that has passed after the last one is found by the guard.
constexpr int kMostBodyRounds = 3;
/// m; touches deeper than this at the end are answered again.
constexpr double kPassed = 1e-9;
/// m/s^2: a change of load that would accelerate a sleeping body by more wakes it.
constexpr double kLoadSlack = 0.1;
}  // namespace

struct BodyContact::Scratch {
  PointMemory start;
  BodyMemory body_start;
  std::vector<uint32_t> form_of;
  BodyTouchSearch search;
  std::vector<SolvedTouch> solved;
  std::vector<BodyTouch> touches;                 ///< of bodies that may sleep
  std::vector<uint8_t> calm;                      ///< per body: whether these leave it at rest
  std::vector<double> timer;                      ///< s, of those
  std::vector<Vec3> load;                         ///< N s on every body in this substep
  std::vector<double> singles, left;              ///< positions as left by this coupling
  std::vector<PointEdge> edges;                   ///< of the hulls, empty when no body has any
  std::vector<std::array<uint32_t, 3>> edges_of;  ///< triangles whose edges those are
  double deepest = 0;

  BodyTouchQuery query(const BodyContact& c, const State& state, const Points& points, const Bodies& bodies) {
    const PublishedSolids hulls = c.hulls_.in(state);
    if (c.meets_edges_ && (edges.empty() || !std::ranges::equal(edges_of, hulls.triangles))) {
      find_edges(hulls, edges);
      edges_of.assign(hulls.triangles.begin(), hulls.triangles.end());
    }
    return {points, start, bodies, body_start, {hulls, 0}, c.reach_, c.forms_, form_of, edges};
  }
  /// Calls `visit` with every number that touches depend on, in order.
  static void each_place(const Points& points, const Bodies& bodies, auto&& visit) {
    const auto all = [&](const Vec3& a) { visit(a.x), visit(a.y), visit(a.z); };
    for (size_t i = 0; i < points.count; ++i) all(points.place(i));
    for (size_t i = 0; i < bodies.count(); ++i) {
      const Quat q = bodies.orientation(i);
      all(bodies.place(i)), all({q.x, q.y, q.z}), visit(q.w);
    }
  }
  void leave(const Points& points, const Bodies& bodies) {
    left.clear();
    each_place(points, bodies, [&](double x) { left.push_back(x); });
    deepest = 0;
    for (const SolvedTouch& t : solved)
      deepest = std::max(deepest, -BodyTouchSolver::gap(t.touch, points, bodies));
  }
  bool as_left(const Points& points, const Bodies& bodies) const {
    size_t k = 0;
    bool same = true;
    each_place(points, bodies, [&](double x) { same = same && k < left.size() && left[k++] == x; });
    return same;
  }
  /// Whether anything movable is where it must not be.
  static bool passed(const std::vector<BodyTouch>& touches, const Points& points, const Bodies& bodies) {
    return std::any_of(touches.begin(), touches.end(), [&](const BodyTouch& t) {
      return BodyTouchSolver::gap(t, points, bodies) < -kPassed &&
             (t.link.inverse_mass(points) > 0 || bodies.dynamic(t.link.body));
    });
  }
};

std::unique_ptr<const BodyContact> BodyContact::make(const ContactDef& def, const CouplingContext& context) {
  const bool bodies_first = context.a.system.ports().bodies.has_value();
  const CouplingSide &bodies = bodies_first ? context.a : context.b,
                     &points = bodies_first ? context.b : context.a;
  const Ports on_bodies = bodies.system.ports();
  const std::string member = bodies_first ? "b" : "a";
  const PointPort columns = require_points(points, member);
  if (answers_together(points.system)) {
    const std::string why =
        "the method of \"" + points.id +
        "\" solves for all its points together, so that single points cannot carry a body";
    throw Error("scene_invalid", why,
                {"/" + member, "unsuitable_system", why, '"' + points.id + '"',
                 "an explicit integrator, or none: the default then supports contact with bodies", "", ""});
  }
  std::unique_ptr<BodyContact> out(new BodyContact(def, columns, *on_bodies.bodies));
  out->bodies_first_ = bodies_first;
  out->points_id_ = points.id, out->bodies_id_ = bodies.id;
  out->hulls_ = SolidsOf(points.system);
  out->points_are_tied_ =
      !out->hulls_.start.triangles.empty() ||
      std::ranges::any_of(out->hulls_.start.segments, [](const auto& s) { return s[0] != s[1]; });
  out->reach_ = columns.radius + kContactSlop;
  const BodyAccess* access = on_bodies.bodies->access();
  if (const BodyOwner* owner = on_bodies.bodies->owner; owner && !access) out->sleep_ = owner->sleep();
  if (out->sleep_) out->remembered_ = ConstBodies(bodies.state, *on_bodies.bodies).count();
  const auto space = access ? access->space() : BodyAccess::Space::space;
  for (const BodyForm& f : on_bodies.bodies->forms) out->forms_.push_back(touch_form(f, space));
  out->meets_edges_ = std::ranges::any_of(out->forms_, [](const TouchForm& f) { return !f.edges.empty(); });
  return out;
}

State BodyContact::initial_state() const {
  State s = exchange_state();
  s.add({"contacts", "1", Scalar::u64}, 1);
  s.add({"deepest", "m"}, 1);
  if (sleep_) s.add({"load", "N", Scalar::f64, 3}, remembered_);
  return s;
}

void BodyContact::book_sum(State& own, Exchange sum) const {
  if (bodies_first_) sum.impulse = -sum.impulse;
  book(own, sum);
}

void BodyContact::begin(const CoupledStates& s, const StepInput& in) const {
  auto& scratch = in.workspace.object<Scratch>("body_contact");
  const ProfileScope scope(in.profile, "remember");
  ConstPoints points(this->points(s), point_columns_);
  points.copy_singles(scratch.singles);
  scratch.start.store(points);
  scratch.body_start.store(ConstBodies(bodies(s), body_columns_, &in.workspace));
}

void BodyContact::midway(const CoupledStates& s, const StepInput& in) const {
  auto& scratch = in.workspace.object<Scratch>("body_contact");
  const ProfileScope scope(in.profile, "remember");
  ConstPoints points(this->points(s), point_columns_);
  points.copy_singles(scratch.singles);
  scratch.start.follow(points, in.h);
  scratch.body_start.follow(ConstBodies(bodies(s), body_columns_, &in.workspace));
}

void BodyContact::end(const CoupledStates& s, const StepInput& in) const {
  auto& scratch = in.workspace.object<Scratch>("body_contact");
  Exchange sum;
  Points points(this->points(s), point_columns_);
  Bodies bodies(this->bodies(s), body_columns_, &in.workspace);
  scratch.form_of.resize(bodies.count());
  for (size_t i = 0; i < bodies.count(); ++i) scratch.form_of[i] = bodies.form_index(i);
  scratch.load.assign(sleep_ ? bodies.count() : 0, {});
  s.own.span<uint64_t>(kBodyContacts)[0] = answer(s, in, scratch, BodyTouchSolver::Bounces::yes, sum);
  s.own.f64(kDeepest)[0] = scratch.deepest;
  book_sum(s.own, sum);
  if (sleep_) compare_loads(s.own, this->bodies(s), in.h, scratch);
}

void BodyContact::find_rest(std::vector<BodyTouch>& touches, const BodyTouchQuery& q, const State& bodies,
                            double h, Scratch& scratch) const {
  const size_t n = q.bodies.count();
  // Points that meet a body no faster than its sleep speed do not disturb it.
  const double calm = sleep_->sleep_speed();
  scratch.calm.assign(n, 1), scratch.timer.assign(n, 0);
  for (const BodyTouch& t : touches) {
    if (!(t.s < 1) && BodyTouchSolver::gap(t, q.points, q.bodies) > 0) continue;
    // Points at rest move only by what forces added in the substep, or not at all after an answer.
    const Vec3 now = t.link.relative(q.points, q.bodies), before = now - h * BodyTouchSolver::pull(t, q, h);
    if (std::min(norm2(now), norm2(before)) > calm * calm) scratch.calm[t.link.body] = 0;
  }
  std::fill(scratch.calm.begin() + static_cast<std::ptrdiff_t>(std::min(n, remembered_)), scratch.calm.end(),
            0);
  for (size_t i = 0; i < n; ++i) scratch.timer[i] = sleep_->sleep_timer(bodies, i);
  for (BodyTouch& t : touches) {
    if (scratch.calm[t.link.body] && sleep_->asleep(bodies, t.link.body))
      t.link.answers = BodyLink::Body::stays;
  }
}

void BodyContact::keep_rest(State& bodies, Scratch& scratch) const {
  for (const SolvedTouch& t : scratch.solved) {
    const uint32_t i = t.touch.link.body;
    if (scratch.calm[i]) sleep_->set_sleep_timer(bodies, i, scratch.timer[i]);
    if (i < scratch.load.size()) scratch.load[i] -= t.touch.n * t.impulse + t.rub;
  }
}

void BodyContact::compare_loads(State& own, State& bodies, double h, const Scratch& scratch) const {
  const ConstBodies all(bodies, body_columns_);
  const size_t n = std::min(all.count(), remembered_);
  double* before = own.f64(kLoads).data();
  for (size_t i = 0; i < n; ++i) {
    const Vec3 load = scratch.load[i] / h;
    if (!sleep_->asleep(bodies, i)) {
      store3(before, i, load);
    } else if (norm(load - load3(before, i)) > kLoadSlack * all.form(i).mass) {
      body_columns_.owner->wake(bodies, i);
    }
  }
}

// Answers bend paths, which may lead to touches not found yet.
size_t BodyContact::answer(const CoupledStates& s, const StepInput& in, Scratch& scratch,
                           BodyTouchSolver::Bounces bounces, Exchange& sum) const {
  Points points(this->points(s), point_columns_);
  Bodies bodies(this->bodies(s), body_columns_, &in.workspace);
  const BodyTouchQuery query = scratch.query(*this, this->points(s), points, bodies);
  BodyTouchSolver solver(def_, points, bodies, in.h);
  size_t acted = 0;
  for (int round = 0; round < kMostBodyRounds; ++round) {
    std::vector<BodyTouch>& touches = scratch.touches;
    {
      const ProfileScope scope(in.profile, "search");
      touches = scratch.search.run(query, in.arena);
    }
    const ProfileScope scope(in.profile, "contacts");
    if (round > 0 && !Scratch::passed(touches, points, bodies)) break;
    if (sleep_) find_rest(touches, query, this->bodies(s), in.h, scratch);
    const size_t more = solver.run(touches, query, bounces, scratch.solved, sum);
    if (sleep_) keep_rest(this->bodies(s), scratch);
    if (more == 0) break;
    acted += more;
    bounces = BodyTouchSolver::Bounces::no;
  }
  scratch.leave(points, bodies);
  return acted;
}

bool BodyContact::guard(const CoupledStates& s, const StepInput& in) const {
  auto& scratch = in.workspace.object<Scratch>("body_contact");
  const ProfileScope scope(in.profile, "guard");
  {
    Points points(this->points(s), point_columns_);
    Bodies bodies(this->bodies(s), body_columns_, &in.workspace);
    if (scratch.as_left(points, bodies)) return false;
    if (!Scratch::passed(scratch.search.run(scratch.query(*this, this->points(s), points, bodies), in.arena),
                         points, bodies)) {
      return false;
    }
  }
  Exchange sum;
  const bool acted = answer(s, in, scratch, BodyTouchSolver::Bounces::no, sum) > 0;
  s.own.f64(kDeepest)[0] = scratch.deepest;
  book_sum(s.own, sum);
  return acted;
}

void BodyContact::observe(const ConstCoupledStates& s, Observables& out) const {
  if (points_are_tied_) {
    observe_impulses(s.own, out);
  } else {
    observe_exchange(s.own, out);
  }
  out.add("contacts", static_cast<double>(s.own.span<uint64_t>(kBodyContacts)[0]), "1");
  out.add("penetration", s.own.f64(kDeepest)[0], "m");
}

std::vector<PlanRow> BodyContact::plan() const {
  using enum PlanRow::Status;
  const size_t hulls = hulls_.start.triangles.size() + hulls_.start.segments.size();
  std::vector<PlanRow> rows{
      {runs, "remember", "contacts need the start of the substep and the systems' uncoupled end"},
      {runs, "search", "points of " + points_id_ + " near bodies of " + bodies_id_}};
  if (hulls > 0) {
    rows.back().reason += ", and corners of bodies near " + std::to_string(hulls) + " triangles and capsules";
    if (meets_edges_) {
      std::vector<PointEdge> lines;
      find_edges(hulls_.start, lines);
      rows.back().reason += ", edges near " + std::to_string(lines.size()) + " lines";
    }
  }
  rows.push_back({runs, "contacts", "impulses on both sides until all contacts are satisfied"});
  rows.push_back({runs, "guard", "keeps points from passing faces, whatever other couplings did"});
  if (def_.friction == 0) rows.push_back({skipped, "friction", "friction is 0"});
  return rows;
}

}  // namespace truestep::contact
