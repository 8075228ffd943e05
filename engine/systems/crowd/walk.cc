// The steps of the two models. Everyone gathers from the neighbours in the order of the sorted cells, which
// is a function of the positions alone.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "engine/base/text/short_number.h"
#include "engine/kernels/crowd/orca.h"
#include "engine/systems/crowd/crowd_rows.h"

namespace truestep::crowd {
namespace {

constexpr size_t kBlock = 64;
/// Lower streams of random numbers belong to the initial state.
constexpr uint64_t kFirstPerson = 2;

/// The nearest neighbours so far, in order; ties go to the first.
struct Nearest {
  static constexpr size_t kMost = 36;
  struct One {
    double gap;  ///< m, between the rims
    uint32_t slot;
    Vec3 d;  ///< m, from the neighbour to here
  };
  std::array<One, kMost> ones;
  size_t count = 0;

  void offer(const One& one) {
    if (count == kMost && !(one.gap < ones[count - 1].gap)) return;
    size_t at = count < kMost ? count++ : count - 1;
    for (; at > 0 && one.gap < ones[at - 1].gap; --at) ones[at] = ones[at - 1];
    ones[at] = one;
  }
};

}  // namespace

Vec3 Crowd::wish(const State& s, size_t i) const {
  const GroupDef& g = def_.groups[s.span<uint32_t>(Columns::group)[i]];
  double speed = s.f64(Columns::wanted_speed)[i] * s.f64(Columns::tally)[1];
  if (g.heading) return normalized(Vec3{g.heading->x, g.heading->y, 0}, Vec3{}) * speed;
  const Vec3 x = load3(s.f64(Columns::position).data(), i);
  const Navigation* way = way_of(s.span<uint32_t>(Columns::group)[i]);
  const Vec3 goal = way ? way->goal().nearest(x) : load3(s.f64(Columns::goal).data(), i);
  const Vec3 e = way ? way->direction(x) : normalized(goal - x, Vec3{});
  // Those who stay at the goal slow down towards it.
  if (!g.leave) speed = std::min(speed, norm(goal - x) / def_.relaxation_time);
  return e * speed;
}

void Crowd::set_out(State& s, const StepInput& in) const {
  const size_t n = s.rows(Columns::position);
  auto wishes = in.workspace.doubles("crowd.wishes", 3 * people_);
  auto before = in.workspace.doubles("crowd.before", 3 * people_);
  std::copy_n(s.f64(Columns::position).data(), 3 * n, before.data());
  const auto person = s.span<uint32_t>(Columns::person);
  in.arena.for_blocks(n, kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Vec3 w = wish(s, i);
      if (def_.noise > 0) {
        const double u = uniform4(seed_, kFirstPerson + person[i], in.step)[0];
        const trig::SinCos a = trig::sincos(def_.noise * (u - 0.5));
        w = {w.x * a.cos - w.y * a.sin, w.x * a.sin + w.y * a.cos, 0};
      }
      store3(wishes.data(), i, w);
    }
  });
}

Crowd::Load Crowd::load(const Sorted& sorted, const State& s, size_t slot) const {
  Load l;
  l.row = sorted.grid.point(slot);
  l.mass = s.f64(Columns::mass)[l.row];
  const Vec3 x = sorted.grid.position(slot), v = load3(sorted.v.data(), slot);
  const double r = sorted.r[slot];
  l.speed = norm(v);
  const Vec3 heading = def_.attention < 1 ? normalized(v, Vec3{}) : Vec3{};
  const auto weight = [&](const Vec3& n) {
    return def_.attention < 1 && l.speed > 0 ? attention(def_.attention, heading, n) : 1;
  };
  images(x, r + largest_radius_ + def_.reach, [&](const Vec3& shift) {
    const Vec3 p = x + shift;
    sorted.grid.near(p, [&](size_t from, size_t to) {
      for (size_t q = from; q < to; ++q) {
        if (q == slot) continue;
        const Vec3 d = p - sorted.grid.position(q);
        const double reach = r + sorted.r[q], d2 = norm2(d), range = reach + def_.reach;
        if (d2 > range * range) continue;
        const double distance = std::sqrt(d2);
        const Vec3 n = apart(d, distance, {sorted.person[slot] < sorted.person[q] ? -1.0 : 1.0, 0, 0});
        l.add(law_, social_force(law_, n, distance, reach, load3(sorted.v.data(), q) - v), weight(n),
              distance, reach);
        l.gap = std::min(l.gap, distance - reach);
      }
    });
  });
  walls_.faces(x, [&](const Vec3& n, double distance) {
    if (distance > r + def_.reach) return;
    l.add(law_, social_force(law_, n, distance, r, -v), weight(n), distance, r);
  });
  return l;
}

void Crowd::push_and_press(State& s, const StepInput& in) const {
  const size_t n = s.rows(Columns::position);
  const auto wishes = in.workspace.doubles("crowd.wishes", 3 * people_);
  auto forces = in.workspace.doubles("crowd.forces", 3 * people_);
  auto steps = in.workspace.doubles("crowd.steps", people_);
  auto& sorted = in.workspace.object<Sorted>("crowd.sorted");
  double left = in.h;
  for (int64_t k = 0; left > 0 && n > 0; ++k) {
    sorted.build(s, reach_, in.arena);
    in.arena.for_blocks(n, kBlock, [&](size_t begin, size_t end) {
      for (size_t slot = begin; slot < end; ++slot) {
        const Load l = load(sorted, s, slot);
        store3(forces.data(), l.row, l.force),
            steps[l.row] = stable_substep(l.stiffness, l.sliding, l.mass, l.speed, def_.repulsion_range);
      }
    });
    const double allowed = *std::min_element(steps.begin(), steps.begin() + static_cast<long>(n));
    // Equal parts of the remainder, so that no tiny one is left.
    const double parts = std::ceil(left / allowed);
    if (static_cast<double>(k) + parts > static_cast<double>(def_.max_substeps)) {
      Instability failure(id_, "velocity", -1,
                          "bodies in contact allow substeps of " + short_number(allowed, 3) +
                              " s, more than max_substeps (" + std::to_string(def_.max_substeps) +
                              ") a step");
      failure.suggested_dt = allowed * static_cast<double>(def_.max_substeps);
      throw failure;
    }
    const double h = parts > 1 ? left / parts : left, tau = def_.relaxation_time;
    left = parts > 1 ? left - h : 0;
    const double decay = trig::exp(-h / tau);
    in.arena.for_blocks(n, kBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3 w = load3<double>(wishes.data(), i) +
                       load3<double>(forces.data(), i) * (tau / s.f64(Columns::mass)[i]);
        const Vec3 v = load3(s.f64(Columns::velocity).data(), i);
        move(s, i, w + (v - w) * decay, h);
      }
    });
  }
}

void Crowd::choose(State& s, const StepInput& in) const {
  // An overlap is resolved within this time (s), not within a step: people do not jump.
  constexpr double kPart = 0.1;
  const size_t n = s.rows(Columns::position), most = static_cast<size_t>(def_.max_neighbours);
  const double out = std::max(in.h, kPart);
  const auto wishes = in.workspace.doubles("crowd.wishes", 3 * people_);
  auto chosen = in.workspace.doubles("crowd.forces", 3 * people_);
  auto& sorted = in.workspace.object<Sorted>("crowd.sorted");
  sorted.build(s, reach_, in.arena);
  in.arena.for_blocks(n, kBlock, [&](size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; ++slot) {
      const size_t i = sorted.grid.point(slot);
      const Vec3 x = sorted.grid.position(slot), v = load3(sorted.v.data(), slot);
      const double r = sorted.r[slot];
      Nearest nearest;
      images(x, r + largest_radius_ + def_.neighbour_distance, [&](const Vec3& shift) {
        const Vec3 p = x + shift;
        sorted.grid.near(p, [&](size_t from, size_t to) {
          for (size_t q = from; q < to; ++q) {
            const Vec3 d = sorted.grid.position(q) - p;
            const double sum = r + sorted.r[q], d2 = norm2(d), range = sum + def_.neighbour_distance;
            if (q == slot || d2 > range * range) continue;
            nearest.offer({std::sqrt(d2) - sum, static_cast<uint32_t>(q), d});
          }
        });
      });
      // Neighbours beyond the search range cannot be reached within a step either.
      const Vec3 w = load3<double>(wishes.data(), i);
      const double seen = nearest.count < Nearest::kMost ? def_.neighbour_distance : nearest.ones.back().gap;
      const double speed = std::min(std::max(def_.max_speed, norm(w)), std::max(0.0, 0.5 * seen / in.h));
      std::array<HalfPlane, kMostHalfPlanes> planes;
      size_t count = 0;
      walls_.faces(x, [&](const Vec3& normal, double distance) {
        if (count + 2 * Nearest::kMost == kMostHalfPlanes) return;
        planes[count++] = wall_plane(normal, distance, r, std::max(def_.wall_horizon, in.h), out);
      });
      const auto aside = [&](uint32_t q) {
        return Vec3{sorted.person[slot] < sorted.person[q] ? 1.0 : -1.0, 0, 0};
      };
      // Whatever the rest does, nobody takes more than half of a gap.
      for (size_t k = 0; k < nearest.count && nearest.ones[k].gap < 2 * in.h * speed; ++k) {
        const auto& [gap, q, d] = nearest.ones[k];
        planes[count++] = wall_plane(apart(-d, norm(d), aside(q)), 0.5 * gap, 0, in.h, out);
      }
      const size_t hard = count;
      for (size_t k = 0; k < std::min(nearest.count, most); ++k) {
        const auto& [gap, q, d] = nearest.ones[k];
        const double sum = r + sorted.r[q] + def_.margin;
        planes[count++] = orca_plane(d, v, load3(sorted.v.data(), q), sum, def_.horizon, out, 0.5, aside(q));
      }
      store3(chosen.data(), i, choose_velocity({planes.data(), count}, hard, speed, w).velocity);
    }
  });
  in.arena.for_blocks(n, kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) move(s, i, load3<double>(chosen.data(), i), in.h);
  });
}

}  // namespace truestep::crowd
