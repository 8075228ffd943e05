// The price of the abstractions: one symplectic Euler step of a cloth of some 10,000 springs by the system
// mass_spring beside the loop that one would write by hand for it, and beside the same loop turned around
// (every point gathers from its own list of springs, the form that threads without atomics).
// Error: largest distance between the two after 1000 steps, in m.
#include <cmath>
#include <vector>

#include "engine/systems/mass_spring/mass_spring.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;
using namespace truestep::mass_spring;

MassSpringDef cloth() {
  MassSpringDef d;
  d.cloth_grid = ClothGridShape{.nx = 42, .ny = 42};
  d.bending_stiffness = 100;
  d.pinned = {"edge_v0"};
  d.integrator = "symplectic_euler";
  return d;
}

// What both hand-written loops share: plain arrays of points and springs.
struct Plain {
  explicit Plain(const MassSpringField& field, const State& s) {
    const auto px = s.f64(MassSpringColumns::position);
    x.assign(px.begin(), px.end());
    v.assign(x.size(), 0);
    f.assign(x.size(), 0);
    const auto pw = s.f64(MassSpringColumns::inverse_mass);
    w.assign(pw.begin(), pw.end());
    const SpringSchedule& schedule = field.schedule();
    const double k[] = {1000, 500, 100};
    for (size_t i = 0; i < schedule.a.size(); ++i) {
      springs.push_back(
          {schedule.a[i], schedule.b[i], k[static_cast<size_t>(schedule.family[i])], schedule.rest[i]});
    }
    lists.resize(w.size());
    for (const Spring& spring : springs) {
      lists[spring.a].push_back(spring);
      lists[spring.b].push_back({spring.b, spring.a, spring.k, spring.rest});
    }
  }

  struct Spring {
    uint32_t a, b;
    double k, rest;
  };
  static Vec3 force(const std::vector<double>& x, const Spring& s) {
    const Vec3 d = load3(x.data(), s.b) - load3(x.data(), s.a);
    const double l = norm(d);
    return (s.k * (l - s.rest) / l) * d;
  }
  void advance(double h) {
    for (size_t i = 0; i < w.size(); ++i) {
      const Vec3 g = w[i] > 0 ? Vec3{0, -9.81, 0} : Vec3{};
      const Vec3 velocity = load3(v.data(), i) + h * (g + w[i] * load3(f.data(), i));
      store3(v.data(), i, velocity);
      store3(x.data(), i, load3(x.data(), i) + h * velocity);
    }
  }
  void step_by_springs(double h) {
    std::fill(f.begin(), f.end(), 0.0);
    for (const Spring& s : springs) {
      const Vec3 on_a = force(x, s);
      store3(f.data(), s.a, load3(f.data(), s.a) + on_a);
      store3(f.data(), s.b, load3(f.data(), s.b) - on_a);
    }
    advance(h);
  }
  void step_by_points(double h) {
    for (size_t i = 0; i < w.size(); ++i) {
      Vec3 sum;
      for (const Spring& s : lists[i]) sum += force(x, s);
      store3(f.data(), i, sum);
    }
    advance(h);
  }

  std::vector<double> x, v, f, w;
  std::vector<Spring> springs;
  std::vector<std::vector<Spring>> lists;
};

}  // namespace

int main() {
  constexpr double h = 1e-4;
  constexpr int kSteps = 100, kRounds = 21;
  const auto system = MassSpring::make(cloth(), {.id = "cloth"});
  State state = system->initial_state();
  Plain springs(system->springs(), state), points = springs;
  Workspace workspace;
  const ThreadArena arena(1);
  uint64_t step = 0;
  const auto ours = [&] {
    for (int k = 0; k < kSteps; ++k, ++step) {
      system->step(
          state,
          {.t = h * static_cast<double>(step), .h = h, .step = step, .workspace = workspace, .arena = arena});
    }
  };
  const auto by_springs = [&] {
    for (int k = 0; k < kSteps; ++k) springs.step_by_springs(h);
  };
  const auto by_points = [&] {
    for (int k = 0; k < kSteps; ++k) points.step_by_points(h);
  };
  const auto distance = [&](const Plain& plain) {
    double largest = 0;
    for (size_t i = 0; i < plain.w.size(); ++i) {
      largest = std::max(largest, norm(load3(plain.x.data(), i) -
                                       load3<double>(state.f64(MassSpringColumns::position).data(), i)));
    }
    return largest;
  };

  const auto first = bench::interleaved(kRounds, ours, by_springs);
  bench::report({.bench = "cloth_explicit",
                 .metric = "seconds per symplectic Euler step, 42 x 42 points, 10,166 springs",
                 .ours = first.ours / kSteps,
                 .peer = first.peer / kSteps,
                 .peer_name = "hand-written loop over springs",
                 .error_ours = distance(springs),
                 .error_peer = 0});
  const auto second = bench::interleaved(kRounds, ours, by_points);
  bench::report({.bench = "cloth_explicit",
                 .metric = "seconds per symplectic Euler step, 42 x 42 points, 10,166 springs",
                 .ours = second.ours / kSteps,
                 .peer = second.peer / kSteps,
                 .peer_name = "hand-written loop over points, each spring twice"});
}
