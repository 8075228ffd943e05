#include "engine/couplings/contact/points_on_solids.h"

#include "engine/couplings/contact/contact_guard.h"
#include "engine/couplings/contact/contact_solver.h"

namespace truestep::contact {

namespace {

/// Most searches per substep; touches after the last are found in the next substep, or by the guard.
constexpr uint32_t kMostTouchRounds = 4;

/// Both sides at the substep's start, and scratch memory of search and solver.
struct Scratch {
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

}  // namespace

PointsOnSolids::PointsOnSolids(Roles roles, const ContactDef& def, const CouplingContext& context,
                               double reach)
    : roles_(roles), def_(def), memory_(swapped() ? "contact of b on a" : "contact"), reach_(reach) {
  const CouplingSide &points = swapped() ? context.b : context.a, &solids = swapped() ? context.a : context.b;
  points_id_ = points.id, solids_id_ = solids.id;
  points_ = *points.system.ports().points, other_ = *solids.system.ports().points;
  published_ = SolidsOf(solids.system);
}

SolidList PointsOnSolids::solids(const State& state, const Points& of) const {
  return {published_.in(state), published_.start.balls == PublishedSolids::Balls::every_point ? of.count : 0};
}

void PointsOnSolids::add(Exchange& sum, const Exchange& given) const {
  sum.impulse += swapped() ? -given.impulse : given.impulse;
  sum.magnitudes += given.magnitudes, sum.energy_lost += given.energy_lost;
}

void PointsOnSolids::begin(const CoupledStates& s, const StepInput& in) const {
  auto& scratch = in.workspace.object<Scratch>(memory_);
  const ProfileScope scope(in.profile, "remember");
  ConstPoints points(swapped() ? s.b : s.a, points_), other(swapped() ? s.a : s.b, other_);
  scratch.copy_singles(points, other);
  scratch.points.store(points);
  if (roles_ != Roles::on_itself) scratch.other.store(other);
}

void PointsOnSolids::midway(const CoupledStates& s, const StepInput& in) const {
  auto& scratch = in.workspace.object<Scratch>(memory_);
  const ProfileScope scope(in.profile, "remember");
  ConstPoints points(swapped() ? s.b : s.a, points_), other(swapped() ? s.a : s.b, other_);
  scratch.copy_singles(points, other);
  scratch.points.follow(points, in.h);
  if (roles_ != Roles::on_itself) scratch.other.follow(other, in.h);
}

size_t PointsOnSolids::end(const CoupledStates& s, const StepInput& in, Exchange& sum) const {
  auto& scratch = in.workspace.object<Scratch>(memory_);
  const bool itself = roles_ == Roles::on_itself;
  Points points(swapped() ? s.b : s.a, points_), other(swapped() ? s.a : s.b, other_);
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
                           solids(swapped() ? s.a : s.b, other),
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
  add(sum, solver.exchange());
  return acted;
}

bool PointsOnSolids::guard(const CoupledStates& s, const StepInput& in, Exchange& sum) const {
  if (!has_faces()) return false;
  auto& scratch = in.workspace.object<Scratch>(memory_);
  const ProfileScope scope(in.profile, "guard");
  Points points(swapped() ? s.b : s.a, points_), other(swapped() ? s.a : s.b, other_);
  scratch.copy_singles(points, other);
  const SolidList list = solids(swapped() ? s.a : s.b, other);
  const GuardedPoints guarded{scratch.points.x(), scratch.other.x(), points, other, list, reach_, in.h};
  Exchange given;
  const bool acted = scratch.guard.run(guarded, def_, scratch.search.near(), given, in.arena);
  if (acted) points.write_back(), other.write_back();
  add(sum, given);
  return acted;
}

std::string PointsOnSolids::solids_text() const {
  std::string what;
  const auto add = [&](size_t n, const char* noun) {
    if (n > 0) what += (what.empty() ? "" : ", ") + std::to_string(n) + noun;
  };
  add(published_.start.triangles.size(), " triangles");
  add(published_.start.segments.size(), " capsules");
  if (published_.start.balls == PublishedSolids::Balls::every_point) {
    what += std::string(what.empty() ? "" : ", ") + "a ball around every point";
  }
  return what;
}

}  // namespace truestep::contact
