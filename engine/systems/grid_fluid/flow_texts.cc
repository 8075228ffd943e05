#include "engine/systems/grid_fluid/flow_texts.h"

#include <algorithm>

#include "engine/base/errors.h"
#include "engine/kernels/mac/momentum.h"
#include "engine/math/expression/names.h"
#include "engine/math/trig.h"

namespace truestep::grid_fluid {

namespace {

using Node = ExpressionGraph::Node;
enum Variable : int32_t { kT, kX, kY, kZ };
constexpr size_t kAngle = 3;

class Reader {
 public:
  explicit Reader(size_t dimensions) {
    const char* const names[] = {"t", "x", "y", "z"};
    for (int32_t v = 0; v < static_cast<int32_t>(1 + dimensions); ++v)
      names_.add_value(names[v], graph_.variable(v));
  }
  Program read(const std::string& pointer, const std::string& text) {
    try {
      const Node n = names_.require(graph_, text);
      Program p;
      p.rows = ExpressionRows(graph_, {&n, 1});
      p.zero = graph_.constant_value(n) == 0.0;
      p.time = p.rows.uses(kT);
      return p;
    } catch (const ExpressionFault& f) {
      issues_.push_back({pointer, "bad_expression", describe(f, text), text, "", f.did_you_mean, ""});
      return {};
    }
  }
  /// The text and its derivative with respect to t.
  ExpressionRows read_motion(const std::string& pointer, const std::string& text) {
    try {
      const Node n = names_.require(graph_, text);
      std::vector<ExpressionGraph::Partial> by_time;
      graph_.differentiate(n, kT, 1, by_time);
      const Node roots[] = {n, by_time.empty() ? graph_.constant(0) : by_time[0].node};
      ExpressionRows rows(graph_, roots);
      if (rows.uses(kX) || rows.uses(kY) || rows.uses(kZ))
        issues_.push_back(
            {pointer, "bad_expression", "an obstacle's motion may depend only on t", text, "t", "", ""});
      return rows;
    } catch (const ExpressionFault& f) {
      issues_.push_back({pointer, "bad_expression", describe(f, text), text, "", f.did_you_mean, ""});
      return {};
    }
  }
  void throw_faults() const {
    if (!issues_.empty()) throw Error("scene_invalid", issues_[0].message, issues_);
  }

 private:
  ExpressionGraph graph_;
  ExpressionNames names_;
  std::vector<Issue> issues_;
};

}  // namespace

FlowTexts::FlowTexts(const GridFluidDef& def, const mac::MacGrid& grid) {
  Reader r(grid.dimensions);
  const auto vector = [&](std::array<Program, 3>& to, const std::vector<std::string>& texts,
                          const std::string& pointer) {
    for (size_t c = 0; c < grid.dimensions; ++c) {
      to[c] = texts.empty() ? r.read(pointer, "0") : r.read(pointer + "/" + std::to_string(c), texts[c]);
    }
  };
  vector(initial, def.initial, "/initial");
  vector(force, def.force, "/force");
  vector(exact, def.exact, "/exact");
  has_exact = !def.exact.empty();
  for (const Program& p : force) forced = forced || !p.zero;
  const ScalarDef scalar = def.scalar.value_or(ScalarDef{});
  scalar_initial = r.read("/scalar/initial", scalar.initial);
  scalar_source = r.read("/scalar/source", scalar.source);
  if (def.second_fluid) second_where = r.read("/second_fluid/where", def.second_fluid->where);
  for (size_t a = 0; a < grid.dimensions; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      vector(sides[a][end], side_of(def, a, end).velocity, side_pointer(def, a, end) + "/velocity");
      for (const Program& p : sides[a][end]) sides_move = sides_move || p.time;
    }
  }
  motion_.resize(def.obstacles.size());
  for (size_t n = 0; n < def.obstacles.size(); ++n) {
    const auto& texts = def.obstacles[n].displacement;
    obstacles_move = obstacles_move || !texts.empty();
    for (size_t c = 0; c < texts.size() && c < grid.dimensions; ++c) {
      motion_[n][c] =
          r.read_motion("/obstacles/" + std::to_string(n) + "/displacement/" + std::to_string(c), texts[c]);
    }
    const std::string& angle = def.obstacles[n].angle;
    if (angle.empty()) continue;
    motion_[n][kAngle] = r.read_motion("/obstacles/" + std::to_string(n) + "/angle", angle);
    const bool turns = motion_[n][kAngle].uses(kT);
    obstacles_move = obstacles_move || turns, obstacles_turn = obstacles_turn || turns;
  }
  r.throw_faults();
}

void FlowTexts::place_obstacles(const std::vector<ObstacleDef>& start, double t, ObstaclePlaces& out) const {
  if (out.obstacles.size() != start.size())
    out.obstacles = start, out.velocity.assign(start.size(), {}), out.spin.assign(start.size(), {});
  for (size_t n = 0; n < start.size(); ++n) {
    double moved[4] = {}, speed[4] = {};
    for (size_t c = 0; c < 4; ++c) {
      if (motion_[n][c].outputs() == 0) continue;
      const ExpressionRows::Column in[] = {{&t, 0}, {}, {}, {}};
      const ExpressionRows::Output to[] = {{&moved[c], 1}, {&speed[c], 1}};
      motion_[n][c].run(in, to, 0, 1);
    }
    out.obstacles[n].center = start[n].center + Vec3{moved[0], moved[1], moved[2]};
    out.velocity[n] = {speed[0], speed[1], speed[2]};
    if (motion_[n][kAngle].outputs() == 0) continue;
    const Vec3 axis = normalized(start[n].axis);
    const trig::SinCos half = trig::sincos(0.5 * moved[kAngle]);
    out.obstacles[n].turned = {half.cos, half.sin * axis.x, half.sin * axis.y, half.sin * axis.z};
    out.spin[n] = speed[kAngle] * axis;
  }
}

void FlowTexts::sample(const Program& p, const mac::MacGrid& g, size_t place, double t, double* u,
                       const ThreadArena& arena) const {
  thread_local std::vector<double> x;
  x.resize(g.count(place, 0));
  for (size_t i = 0; i < x.size(); ++i) x[i] = g.coordinate(place, 0, static_cast<double>(i));
  // The calling thread's values, whichever thread reads them.
  const double* along = x.data();
  mac::for_rows(g, place, arena, [&](size_t at, size_t j, size_t k, size_t n) {
    const double y = g.coordinate(place, 1, static_cast<double>(j)),
                 z = g.coordinate(place, 2, static_cast<double>(k));
    const ExpressionRows::Column in[] = {{&t, 0}, {along, 1}, {&y, 0}, {&z, 0}};
    const ExpressionRows::Output to[] = {{u + at, 1}};
    p.rows.run(in, to, 0, n);
  });
}

void FlowTexts::sample_side(const mac::MacGrid& g, size_t axis, size_t end, size_t c, double t,
                            std::vector<double>& out) const {
  const size_t first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  const size_t n = g.padded(first), planes = g.padded(second);
  const auto along = [&](size_t a, size_t padded) {
    return g.coordinate(
        c, a, a < g.dimensions ? static_cast<double>(padded) - static_cast<double>(mac::kGhosts) : 0.0);
  };
  thread_local std::vector<double> u;
  u.resize(n);
  for (size_t p = 0; p < n; ++p) u[p] = along(first, p);
  out.resize(n * planes);
  for (size_t q = 0; q < planes; ++q) {
    const double w = along(second, q), s = g.origin[axis] + (end == 0 ? 0 : g.extent(axis));
    ExpressionRows::Column in[] = {{&t, 0}, {}, {}, {}};
    in[1 + axis] = {&s, 0}, in[1 + first] = {u.data(), 1}, in[1 + second] = {&w, 0};
    const ExpressionRows::Output to[] = {{out.data() + n * q, 1}};
    sides[axis][end][c].rows.run(in, to, 0, n);
  }
}

}  // namespace truestep::grid_fluid
