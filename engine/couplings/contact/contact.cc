#include "engine/couplings/contact/contact.h"

#include "engine/collision/points/collider_set.h"
#include "engine/couplings/contact/body_contact.h"
#include "engine/couplings/contact/contact_guard.h"
#include "engine/couplings/contact/contact_solver.h"
#include "engine/couplings/sides.h"

namespace truestep::contact {

namespace {

constexpr State::Column kContacts = exchange_columns::end;
/// Most searches per substep; touches after the last are found in the next substep, or by the guard.
constexpr uint32_t kMostTouchRounds = 4;

/// Both sides at the substep's start, and scratch memory of search and solver.
struct ContactScratch {
  PointMemory points, other;
  RowTraces point_traces, other_traces;
  ContactSearch search;
  ContactSolverScratch solver;
  PassGuard guard;
  std::vector<double> point_singles, other_singles;  ///< copies of f32 columns

  void copy_singles(auto& points, auto& other) {
    points.copy_singles(point_singles), other.copy_singles(other_singles);
  }
};

bool more_than_balls(const PublishedSolids& s) {
  return !s.triangles.empty() || !s.segments.empty();
}

[[noreturn]] void refuse(const std::string& pointer, const std::string& why, const std::string& allowed) {
  throw Error("scene_invalid", why, {pointer, "unsuitable_system", why, "", allowed, "", ""});
}

}  // namespace

std::unique_ptr<const ContactCoupling> ContactCoupling::make(const ContactDef& def,
                                                             const CouplingContext& context) {
  const PointPort a = require_points(context.a, "a"), b = require_points(context.b, "b");
  const SolidsOf solids_a(context.a.system), solids_b(context.b.system);
  const PublishedSolids &of_a = solids_a.start, &of_b = solids_b.start;
  std::unique_ptr<ContactCoupling> out(new ContactCoupling(def));
  if (&context.a.system == &context.b.system) {
    if (of_a.balls == PublishedSolids::Balls::none) {
      refuse("/b", '"' + context.a.id + "\" cannot collide with itself: only systems of balls can",
             "another system");
    }
    out->roles_ = Roles::on_itself;
  } else if (of_a.empty() && of_b.empty()) {
    refuse("", "neither system has solids", "a system with triangles, springs or balls");
  } else if (of_b.empty() || (!more_than_balls(of_b) && more_than_balls(of_a))) {
    out->roles_ = Roles::b_on_a;
  }
  const bool swapped = out->roles_ == Roles::b_on_a;
  out->points_ = swapped ? b : a;
  out->other_ = swapped ? a : b;
  out->points_id_ = swapped ? context.b.id : context.a.id;
  out->solids_id_ = swapped ? context.a.id : context.b.id;
  out->published_ = swapped ? solids_a : solids_b;
  out->reach_ = a.radius + b.radius + kContactSlop;
  if (a.radius + b.radius == 0 && out->published_.start.triangles.empty()) {
    refuse("/b", "points without radius never touch lines or points without radius",
           "a radius (particles) or a thickness (mass_spring) on either side");
  }
  return out;
}

State ContactCoupling::initial_state() const {
  State s = exchange_state();
  s.add({"contacts", "1", Scalar::u64}, 1);
  return s;
}

SolidList ContactCoupling::solids(const State& state, const Points& of) const {
  return {published_.in(state), published_.start.balls == PublishedSolids::Balls::every_point ? of.count : 0};
}

void ContactCoupling::begin(const CoupledStates& s, const StepInput& in) const {
  auto& scratch = in.workspace.object<ContactScratch>("contact");
  const ProfileScope scope(in.profile, "remember");
  const bool swapped = roles_ == Roles::b_on_a;
  ConstPoints points(swapped ? s.b : s.a, points_), other(swapped ? s.a : s.b, other_);
  scratch.copy_singles(points, other);
  scratch.points.store(points);
  if (roles_ != Roles::on_itself) scratch.other.store(other);
}

void ContactCoupling::midway(const CoupledStates& s, const StepInput& in) const {
  auto& scratch = in.workspace.object<ContactScratch>("contact");
  const ProfileScope scope(in.profile, "remember");
  const bool swapped = roles_ == Roles::b_on_a;
  ConstPoints points(swapped ? s.b : s.a, points_), other(swapped ? s.a : s.b, other_);
  scratch.copy_singles(points, other);
  scratch.points.follow(points, in.h);
  if (roles_ != Roles::on_itself) scratch.other.follow(other, in.h);
}

void ContactCoupling::end(const CoupledStates& s, const StepInput& in) const {
  auto& scratch = in.workspace.object<ContactScratch>("contact");
  const bool swapped = roles_ == Roles::b_on_a, itself = roles_ == Roles::on_itself;
  Points points(swapped ? s.b : s.a, points_), other(swapped ? s.a : s.b, other_);
  scratch.copy_singles(points, other);
  // A coupling of a system with itself has two names for the same points.
  if (itself) other.x = points.x, other.v = points.v;
  const PointMemory& other_memory = itself ? scratch.points : scratch.other;
  RowTraces& other_traces = itself ? scratch.point_traces : scratch.other_traces;
  scratch.point_traces.prepare(points.count);
  other_traces.prepare(other.count);
  const ContactQuery query{{points.x, points.v, scratch.points, scratch.point_traces},
                           points.count,
                           {other.x, other.v, other_memory, other_traces},
                           other.count,
                           solids(swapped ? s.a : s.b, other),
                           itself ? OwnSolids::yes : OwnSolids::no,
                           reach_,
                           in.h};
  const auto search = [&](uint32_t round) -> const std::vector<Touch>& {
    const ProfileScope scope(in.profile, "search");
    return scratch.search.run(query, round, in.arena);
  };
  const std::vector<Touch>* touches = &search(0);
  PointContactSolver solver(def_, query, points, other, scratch.solver);
  size_t acted = 0;
  for (uint32_t round = 0; round < kMostTouchRounds && !touches->empty(); ++round) {
    // Answers bend paths, which may lead to touches not found yet.
    if (round > 0) touches = &search(round);
    const ProfileScope scope(in.profile, "contacts");
    const size_t more = solver.answer_all(*touches, round);
    if (more == 0) break;
    acted += more;
  }
  {
    const ProfileScope scope(in.profile, "contacts");
    solver.finish();
  }
  points.write_back();
  if (!itself) other.write_back();
  s.own.span<uint64_t>(kContacts)[0] = acted;
  Exchange sum = solver.exchange();
  if (swapped) sum.impulse = -sum.impulse;
  book(s.own, sum);
}

bool ContactCoupling::guard(const CoupledStates& s, const StepInput& in) const {
  if (published_.start.triangles.empty()) return false;
  auto& scratch = in.workspace.object<ContactScratch>("contact");
  const ProfileScope scope(in.profile, "guard");
  const bool swapped = roles_ == Roles::b_on_a;
  Points points(swapped ? s.b : s.a, points_), other(swapped ? s.a : s.b, other_);
  scratch.copy_singles(points, other);
  const SolidList list = solids(swapped ? s.a : s.b, other);
  const GuardedPoints guarded{scratch.points.x(), scratch.other.x(), points, other, list, reach_, in.h};
  Exchange sum;
  const bool acted = scratch.guard.run(guarded, def_, scratch.search.near(), sum, in.arena);
  if (acted) points.write_back(), other.write_back();
  if (swapped) sum.impulse = -sum.impulse;
  book(s.own, sum);
  return acted;
}

void ContactCoupling::observe(const ConstCoupledStates& s, Observables& out) const {
  observe_exchange(s.own, out);
  out.add("contacts", static_cast<double>(s.own.span<uint64_t>(kContacts)[0]), "1");
}

std::vector<PlanRow> ContactCoupling::plan() const {
  using enum PlanRow::Status;
  std::string what;
  const auto add = [&](size_t n, const char* noun) {
    if (n > 0) what += (what.empty() ? "" : ", ") + std::to_string(n) + noun;
  };
  add(published_.start.triangles.size(), " triangles");
  add(published_.start.segments.size(), " capsules");
  if (published_.start.balls == PublishedSolids::Balls::every_point) {
    what += std::string(what.empty() ? "" : ", ") + "a ball around every point";
  }
  std::vector<PlanRow> rows{
      {runs, "remember", "contacts need the start of the substep and the systems' uncoupled end"},
      {runs, "search", "points of " + points_id_ + " near the solids of " + solids_id_ + ": " + what},
      {runs, "contacts", "impulses on both sides, in the order of the contacts"}};
  if (published_.start.triangles.empty()) {
    rows.push_back({skipped, "guard", "only triangles need it"});
  } else {
    rows.push_back({runs, "guard", "keeps points from passing triangles, whatever the impulses did"});
  }
  if (def_.friction == 0) rows.push_back({skipped, "friction", "friction is 0"});
  return rows;
}

std::unique_ptr<const Coupling> build_contact(const void* def, const CouplingContext& context) {
  const bool a = context.a.system.ports().bodies.has_value(), b = context.b.system.ports().bodies.has_value();
  if (a && b) {
    refuse("/b",
           "\"" + context.b.id + "\" is a system of bodies as \"" + context.a.id +
               "\" is, and bodies of two systems cannot collide",
           "a system of points (mass_spring, particles) with a system of bodies; bodies that collide belong "
           "in one system");
  }
  if (a || b) return BodyContact::make(*static_cast<const ContactDef*>(def), context);
  return ContactCoupling::make(*static_cast<const ContactDef*>(def), context);
}

}  // namespace truestep::contact
