#include "engine/systems/crowd/crowd.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/commands/command_checks.h"
#include "engine/core/energy.h"

namespace truestep::crowd {
namespace {

/// m, distance beyond the rims within which walls are searched.
double wall_reach(const CrowdDef& d) {
  const double beyond = d.model == Model::orca ? 2 * d.max_speed * d.wall_horizon : d.reach;
  return std::max(largest_radius(d) + beyond, d.clearance + 1);
}

bool same(const Goal& a, const Goal& b) {
  return a.line.a == b.line.a && a.line.b == b.line.b && a.half_extents == b.half_extents;
}

}  // namespace

Crowd::Crowd(const CrowdDef& def, const BuildContext& context)
    : def_(def),
      id_(context.id),
      seed_(context.seed),
      people_(people_of(def)),
      largest_radius_(largest_radius(def)),
      reach_(2 * largest_radius_ + (def.model == Model::orca ? def.neighbour_distance : def.reach)),
      law_{def.repulsion, def.repulsion_range, def.body_stiffness, def.sliding_friction},
      walls_(def, wall_reach(def)) {
  if (way_spacing(def) > 0) grid_.emplace(def, walls_);
  for (const GroupDef& g : def_.groups) {
    std::shared_ptr<const Navigation> way;
    if (g.goal) {
      const Goal goal = goal_of(g);
      for (const auto& w : ways_) {
        if (w && same(w->goal(), goal)) way = w;
      }
      if (!way) way = std::make_shared<Navigation>(goal, grid_ ? &*grid_ : nullptr, walls_, def_.clearance);
    }
    ways_.push_back(std::move(way));
  }
  check_ways();
  add_stage("set_out", "desired directions of " + std::to_string(people_) + " people",
            [this](State& s, const StepInput& in) { set_out(s, in); });
  if (def.model == Model::social_force) {
    add_stage("push_and_press", "social forces, in as many substeps as contacts need",
              [this](State& s, const StepInput& in) { push_and_press(s, in); });
  } else {
    add_stage(
        "choose",
        "velocities within the half-planes of up to " + std::to_string(def.max_neighbours) + " neighbours",
        [this](State& s, const StepInput& in) { choose(s, in); });
  }
  const bool leave =
      std::any_of(def.groups.begin(), def.groups.end(), [](const GroupDef& g) { return g.leave; });
  if (leave || !def.doors.empty()) {
    add_stage("arrive", "doors are watched and people leave at their goals",
              [this](State& s, const StepInput& in) { arrive(s, in); });
  } else {
    skip_stage("arrive", "nobody leaves and there are no doors");
  }
  if (def.walls.empty()) skip_stage("walls", "there are none");
  show();
  set_remedies({"a shorter step", "more max_substeps", "softer bodies (body_stiffness, sliding_friction)"});
}

void Crowd::check_ways() const {
  const auto refuse = [](const std::string& at, const std::string& why) {
    throw Error("scene_invalid", why, {at, "unreachable", why, "", "", "", ""});
  };
  if (!grid_) return;
  for (size_t k = 0; k < ways_.size(); ++k) {
    if (!ways_[k]) continue;
    const GroupDef& g = def_.groups[k];
    const std::string at = "/groups/" + std::to_string(k);
    const Goal& goal = ways_[k]->goal();
    const bool in_wall = !(norm(goal.half_extents) > 0) && walls_.distance(goal.line.a) < 1e-6 &&
                         walls_.distance(goal.line.b) < 1e-6;
    if (in_wall) refuse(at + "/goal", "the goal lies in a wall");
    for (size_t i = 0; i < g.positions.size(); ++i) {
      Vec3 x = g.positions[i];
      x.z = 0;
      if (std::isinf(ways_[k]->time(x))) {
        refuse(at + "/positions/" + std::to_string(i), "the walls leave no path from here to the goal");
      }
    }
    if (!g.positions.empty()) continue;
    const Vec3 low = g.center - g.half_extents, high = g.center + g.half_extents;
    for (size_t node = 0; node < grid_->room.size(); ++node) {
      const Vec3 x = grid_->place(node);
      if (x.x < low.x || x.x > high.x || x.y < low.y || x.y > high.y || grid_->solid(node)) continue;
      if (std::isinf(ways_[k]->time(x))) {
        refuse(at + "/center", "the walls leave no path to the goal from some of the starting area");
      }
    }
  }
}

void Crowd::move(State& s, size_t i, const Vec3& v, double h) const {
  double *x = s.f64(Columns::position).data(), *all_v = s.f64(Columns::velocity).data();
  const Vec3 from = load3(x, i);
  Vec3 u = v;
  // Nobody crosses a wall: the velocity component that would is removed, twice in a corner, then everything.
  for (int attempt = 0; attempt < 3; ++attempt) {
    const Segment* hit = walls_.crossed(from, from + u * h);
    if (!hit) break;
    const Vec3 along = normalized(hit->b - hit->a);
    u = attempt < 2 ? along * dot(u, along) : Vec3{};
  }
  Vec3 to = from + u * h;
  if (def_.period > 0) {
    to.x -= def_.period * std::floor(to.x / def_.period + 0.5);
    if (!(to.x < 0.5 * def_.period)) to.x = -0.5 * def_.period;
  }
  store3(x, i, to), store3(all_v, i, u);
}

bool Crowd::at_goal(const State& s, size_t i) const {
  const uint32_t g = s.span<uint32_t>(Columns::group)[i];
  const Vec3 x = load3(s.f64(Columns::position).data(), i);
  if (def_.groups[g].heading) return false;
  const Vec3 goal = ways_[g] ? ways_[g]->goal().nearest(x) : load3(s.f64(Columns::goal).data(), i);
  return norm2(goal - x) <= def_.arrival_distance * def_.arrival_distance;
}

void Crowd::arrive(State& s, const StepInput& in) const {
  const size_t n = s.rows(Columns::position);
  const double* x = s.f64(Columns::position).data();
  const std::span<double> before = in.workspace.doubles("crowd.before", 3 * n);
  const std::span<double> doors = s.f64(Columns::doors);
  for (size_t k = 0; k < def_.doors.size(); ++k) {
    const Segment door{{def_.doors[k].from.x, def_.doors[k].from.y, 0},
                       {def_.doors[k].to.x, def_.doors[k].to.y, 0}};
    double* row = &doors[4 * k];
    for (size_t i = 0; i < n; ++i) {
      Vec3 from = load3<double>(before.data(), i), to = load3(x, i);
      if (def_.period > 0) from.x += def_.period * std::floor((to.x - from.x) / def_.period + 0.5);
      const int side = crossing({from, to}, door);
      if (side < 0) row[1] += 1;
      if (side <= 0) continue;
      row[0] += 1, row[3] = in.t + in.h;
      if (row[2] < 0) row[2] = row[3];
    }
  }
  // Those who have arrived are removed, and the others keep their order.
  const std::span<uint32_t> group = s.span<uint32_t>(Columns::group);
  size_t kept = 0;
  for (size_t i = 0; i < n; ++i) {
    if (def_.groups[group[i]].leave && at_goal(s, i)) continue;
    if (kept != i) {
      for (State::Column c = 0; c <= Columns::group; ++c) s.copy_row(c, i, kept);
    }
    ++kept;
  }
  if (kept == n) return;
  for (State::Column c = 0; c <= Columns::group; ++c) s.resize(c, kept);
  s.f64(Columns::tally)[0] += static_cast<double>(n - kept);
}

void Crowd::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind == CommandKind::impulse && def_.model == Model::social_force) {
    refuse_place(c, "person");
    const size_t i = checked_command_row(c, s.rows(Columns::position), "person");
    double* v = s.f64(Columns::velocity).data();
    const Vec3 push{c.vector.x, c.vector.y, 0};
    return store3(v, i, load3(v, i) + push / s.f64(Columns::mass)[i]);
  }
  if (c.kind != CommandKind::set_parameter) {
    refuse_command("type", "not_possible",
                   def_.model == Model::orca
                       ? "people of model orca choose their velocity and cannot be pushed"
                       : "people take only impulse and set_parameter",
                   def_.model == Model::orca ? "set_parameter" : "impulse, set_parameter");
  }
  if (c.name != "speed_factor") {
    refuse_command("name", "unknown_parameter", "there is no parameter \"" + c.name + "\" to set",
                   "speed_factor");
  }
  if (c.value < 0) refuse_command("value", "out_of_range", "the value must be at least 0");
  s.f64(Columns::tally)[1] = c.value;
}

std::optional<double> Crowd::limit(Limit which, const State&, double) const {
  if (which != Limit::speed) return std::nullopt;
  double fastest = def_.max_speed;
  for (const GroupDef& g : def_.groups)
    fastest = std::max({fastest, g.speed + 2 * g.speed_deviation, norm(g.velocity)});
  return unexplained_speed(fastest);
}

void Crowd::check(StateCheck& check, double) const {
  check.together(Columns::position, Columns::group + 1, people_).below(Columns::group, def_.groups.size());
  const auto group = check.state().span<uint32_t>(Columns::group);
  check.require(std::is_sorted(group.begin(), group.end()), "rows in the order of groups");
}

std::unique_ptr<const System> build_crowd(const void* def, const BuildContext& context) {
  return std::make_unique<const Crowd>(*static_cast<const CrowdDef*>(def), context);
}

}  // namespace truestep::crowd
