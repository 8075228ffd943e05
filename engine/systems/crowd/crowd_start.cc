// Initial positions and individual properties: functions of the seed and the person's number.
#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/systems/crowd/crowd.h"

namespace truestep::crowd {
namespace {

constexpr double kTurn = 6.283185307179586;
/// Streams of random numbers below those of individual people.
enum Stream : uint64_t { kBodies, kPlaces };

/// A draw of the standard normal distribution truncated at two deviations (Box, Muller 1958).
double normal(const std::array<double, 4>& u) {
  const double size = std::sqrt(-2 * trig::log(1 - u[0]));
  return std::clamp(size * trig::cos(kTurn * u[1]), -2.0, 2.0);
}

}  // namespace

State Crowd::initial_state() const {
  State s;
  s.add({"position", "m", Scalar::f64, 3, Role::position}, people_);
  s.add({"velocity", "m/s", Scalar::f64, 3, Role::velocity}, people_);
  s.add({"goal", "m", Scalar::f64, 3}, people_);
  s.add({"radius", "m"}, people_);
  s.add({"mass", "kg"}, people_);
  s.add({"wanted_speed", "m/s"}, people_);
  s.add({"person", "1", Scalar::u32}, people_);
  s.add({"group", "1", Scalar::u32}, people_);
  s.add({"doors", "1", Scalar::f64, 4}, def_.doors.size());
  s.add({"tally", "1"}, 2);
  for (size_t k = 0; k < def_.doors.size(); ++k)
    s.f64(Columns::doors)[4 * k + 2] = s.f64(Columns::doors)[4 * k + 3] = -1;
  s.f64(Columns::tally)[1] = 1;
  size_t first = 0;
  for (size_t g = 0; g < def_.groups.size(); ++g) {
    const GroupDef& group = def_.groups[g];
    for (size_t i = first; i < first + people_of(group); ++i) {
      const auto u = uniform4(seed_, kBodies, i);
      s.span<uint32_t>(Columns::person)[i] = static_cast<uint32_t>(i);
      s.span<uint32_t>(Columns::group)[i] = static_cast<uint32_t>(g);
      s.f64(Columns::radius)[i] = group.radius + group.radius_deviation * (2 * u[2] - 1);
      s.f64(Columns::mass)[i] = group.mass;
      s.f64(Columns::wanted_speed)[i] = std::max(0.0, group.speed + group.speed_deviation * normal(u));
      store3(s.f64(Columns::velocity).data(), i, Vec3{group.velocity.x, group.velocity.y, 0});
    }
    place(s, g, first);
    first += people_of(group);
  }
  return s;
}

void Crowd::place(State& s, size_t g, size_t first) const {
  const GroupDef& group = def_.groups[g];
  double *x = s.f64(Columns::position).data(), *goal = s.f64(Columns::goal).data();
  const double* r = s.f64(Columns::radius).data();
  const size_t n = people_of(group);
  if (!group.positions.empty()) {
    for (size_t i = 0; i < n; ++i) {
      const Vec3 p = group.positions[i], to = group.goals.empty() ? Vec3{} : group.goals[i];
      store3(x, first + i, Vec3{p.x, p.y, 0}), store3(goal, first + i, Vec3{to.x, to.y, 0});
    }
    return;
  }
  // People placed so far, in cells of two largest radii, so that lookups are cheap.
  const double edge = std::max(2 * largest_radius_, 1e-3);
  const Bounds b = bounds_of(def_);
  constexpr double kMostCells = 1e6;
  const double wide = b.high.x - b.low.x + edge, deep = b.high.y - b.low.y + edge;
  const double cell = std::max(edge, std::sqrt(wide * deep / kMostCells));
  const long nx = static_cast<long>(wide / cell) + 1, ny = static_cast<long>(deep / cell) + 1;
  std::vector<std::vector<uint32_t>> there(static_cast<size_t>(nx * ny));
  const auto column = [&](double at, double low, long most) {
    return std::clamp(static_cast<long>((at - low) / cell), 0L, most - 1);
  };
  const auto stand = [&](size_t i) {
    const Vec3 p = load3(x, i);
    there[static_cast<size_t>(column(p.y, b.low.y, ny) * nx + column(p.x, b.low.x, nx))].push_back(
        static_cast<uint32_t>(i));
  };
  for (size_t i = 0; i < first; ++i) stand(i);
  const auto gap = [&](const Vec3& p, double radius) {
    double least = 2 * edge;
    if (!walls_.pieces().empty()) least = std::min(least, walls_.distance(p) - radius);
    images(p, 2 * edge, [&](const Vec3& shift) {
      const Vec3 q = p + shift;
      const long cx = column(q.x, b.low.x, nx), cy = column(q.y, b.low.y, ny);
      for (long j = std::max(0L, cy - 1); j <= std::min(ny - 1, cy + 1); ++j) {
        for (long i = std::max(0L, cx - 1); i <= std::min(nx - 1, cx + 1); ++i) {
          for (const uint32_t k : there[static_cast<size_t>(j * nx + i)]) {
            least = std::min(least, norm(q - load3(x, k)) - radius - r[k]);
          }
        }
      }
    });
    return least;
  };
  // The first of many candidate places that overlaps nobody; if the crowd has none, the one with the least
  // overlap.
  constexpr uint64_t kTries = 2000;
  for (size_t i = first; i < first + n; ++i) {
    Vec3 best;
    double widest = -HUGE_VAL;
    for (uint64_t k = 0; k < kTries && widest < 0; ++k) {
      const auto u = uniform4(seed_, kPlaces, i * kTries + k);
      const Vec3 p{group.center.x + group.half_extents.x * (2 * u[0] - 1),
                   group.center.y + group.half_extents.y * (2 * u[1] - 1), 0};
      const double free = gap(p, r[i]);
      if (free > widest) widest = free, best = p;
    }
    store3(x, i, best), stand(i);
  }
}

}  // namespace truestep::crowd
