#include "engine/couplings/contact/contact.h"

#include "engine/collision/points/collider_set.h"
#include "engine/couplings/contact/body_contact.h"
#include "engine/couplings/sides.h"

namespace truestep::contact {

namespace {

constexpr State::Column kContacts = exchange_columns::end;
/// Rounds in which both directions keep points on their side: each may undo the other.
constexpr int kGuardRounds = 4;

[[noreturn]] void refuse(const std::string& pointer, const std::string& why, const std::string& allowed) {
  throw Error("scene_invalid", why, {pointer, "unsuitable_system", why, "", allowed, "", ""});
}

}  // namespace

std::unique_ptr<const ContactCoupling> ContactCoupling::make(const ContactDef& def,
                                                             const CouplingContext& context) {
  using Roles = PointsOnSolids::Roles;
  const PointPort a = require_points(context.a, "a"), b = require_points(context.b, "b");
  const PublishedSolids of_a = SolidsOf(context.a.system).start, of_b = SolidsOf(context.b.system).start;
  const double radius = a.radius + b.radius;
  std::vector<Roles> ways;
  if (&context.a.system == &context.b.system) {
    if (of_a.balls == PublishedSolids::Balls::none) {
      refuse("/b", '"' + context.a.id + "\" cannot collide with itself: only systems of balls can",
             "another system");
    }
    ways = {Roles::on_itself};
  } else if (of_a.empty() && of_b.empty()) {
    refuse("", "neither system has solids", "a system with triangles, springs or balls");
  } else {
    // Points without radius meet nothing but triangles; balls meet balls in one direction.
    const auto more = [&](const PublishedSolids& s) {
      return !s.triangles.empty() || (!s.segments.empty() && radius > 0);
    };
    if (more(of_b)) ways.push_back(Roles::a_on_b);
    if (more(of_a)) ways.push_back(Roles::b_on_a);
    if (ways.empty()) ways = {of_b.empty() ? Roles::b_on_a : Roles::a_on_b};
  }
  if (radius == 0 && of_a.triangles.empty() && of_b.triangles.empty()) {
    refuse("/b", "points without radius never touch lines or points without radius",
           "a radius (particles) or a thickness (mass_spring) on either side");
  }
  std::unique_ptr<ContactCoupling> out(new ContactCoupling);
  out->friction_ = def.friction;
  for (const Roles roles : ways) out->ways_.emplace_back(roles, def, context, radius + kContactSlop);
  return out;
}

State ContactCoupling::initial_state() const {
  State s = exchange_state();
  s.add({"contacts", "1", Scalar::u64}, 1);
  return s;
}

void ContactCoupling::begin(const CoupledStates& s, const StepInput& in) const {
  for (const PointsOnSolids& way : ways_) way.begin(s, in);
}

void ContactCoupling::midway(const CoupledStates& s, const StepInput& in) const {
  for (const PointsOnSolids& way : ways_) way.midway(s, in);
}

void ContactCoupling::end(const CoupledStates& s, const StepInput& in) const {
  Exchange sum;
  size_t acted = 0;
  for (const PointsOnSolids& way : ways_) acted += way.end(s, in, sum);
  s.own.span<uint64_t>(kContacts)[0] = acted;
  book(s.own, sum);
}

bool ContactCoupling::guard(const CoupledStates& s, const StepInput& in) const {
  Exchange sum;
  bool acted = false;
  size_t quiet = 0;
  for (size_t turn = 0; quiet < ways_.size() && turn < kGuardRounds * ways_.size(); ++turn) {
    const bool now = ways_[turn % ways_.size()].guard(s, in, sum);
    quiet = now ? 1 : quiet + 1, acted |= now;
  }
  book(s.own, sum);
  return acted;
}

void ContactCoupling::observe(const ConstCoupledStates& s, Observables& out) const {
  observe_exchange(s.own, out);
  out.add("contacts", static_cast<double>(s.own.span<uint64_t>(kContacts)[0]), "1");
}

std::vector<PlanRow> ContactCoupling::plan() const {
  using enum PlanRow::Status;
  std::string where;
  bool faces = false;
  for (const PointsOnSolids& way : ways_) {
    where += (where.empty() ? "points of " : ", and points of ") + way.points_id() + " near the solids of " +
             way.solids_id() + ": " + way.solids_text();
    faces |= way.has_faces();
  }
  std::vector<PlanRow> rows{
      {runs, "remember", "contacts need the start of the substep and the systems' uncoupled end"},
      {runs, "search", where},
      {runs, "contacts", "impulses on both sides, in the order of the contacts"}};
  if (faces) {
    rows.push_back({runs, "guard", "keeps points from passing triangles, whatever the impulses did"});
  } else {
    rows.push_back({skipped, "guard", "only triangles need it"});
  }
  if (friction_ == 0) rows.push_back({skipped, "friction", "friction is 0"});
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
