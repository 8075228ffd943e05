// Particles that come by nozzles and leave by kill regions.
#include <algorithm>
#include <vector>

#include "engine/core/living_rows.h"
#include "engine/core/real_column.h"
#include "engine/systems/sph/fluid.h"
#include "engine/systems/sph/setting.h"

namespace truestep::sph {

namespace {

/// Spacings that a newborn keeps from what is there: water that was in the nozzle is pushed out, not doubled.
constexpr double kLeastRoom = 0.7;

/// One particle more, at the end.
void append(const Setting& set, State& s, const Vec3& x, const Inlet& inlet) {
  const size_t row = s.rows(columns::position);
  for (State::Column c = 0; c < columns::per_particle_end; ++c) s.resize(c, row + 1);
  RealColumn<double>(s, columns::position).set_vector(row, x);
  RealColumn<double>(s, columns::velocity).set_vector(row, inlet.velocity());
  RealColumn<double>(s, columns::density).set(row, 1);
  if (!set.ratio) return;
  s.resize(set.ratio, row + 1);
  RealColumn<double>(s, set.ratio).set(row, inlet.ratio);
}

}  // namespace

void pour(const Setting& set, State& s, double t, Workspace& workspace) {
  auto& near = workspace.object<std::vector<Vec3>>("sph.near_nozzle");
  const double room = kLeastRoom * set.def.spacing;
  for (size_t k = 0; k < set.inlets.size(); ++k) {
    const Inlet& inlet = set.inlets[k];
    uint64_t& next = s.span<uint64_t>(set.layers)[k];
    for (double born; (born = inlet.birth(next)) < t; ++next) {
      const Vec3 at = inlet.back() + inlet.velocity() * (t - born);
      near.clear();
      const RealColumn<const double> x(std::as_const(s), columns::position);
      for (size_t i = 0; i < s.rows(columns::position); ++i) {
        if (std::abs(dot(x.vector(i) - at, inlet.along)) < room) near.push_back(x.vector(i));
      }
      for (const Vec3& place : inlet.places) {
        const Vec3 p = at + place;
        const auto close = [&](const Vec3& other) { return norm2(other - p) < room * room; };
        if (std::any_of(near.begin(), near.end(), close)) continue;
        const bool fits = s.rows(columns::position) < set.capacity;
        ++s.span<uint64_t>(set.counts)[fits ? counts::emitted : counts::refused];
        if (fits) append(set, s, p, inlet);
      }
    }
  }
}

void remove_killed(const Setting& set, State& s, const StepInput& in) {
  const size_t n = s.rows(columns::position);
  auto& dead = in.workspace.object<std::vector<uint8_t>>("sph.dead");
  dead.reserve(set.capacity);
  dead.assign(n, 0);
  const RealColumn<const double> x(std::as_const(s), columns::position);
  in.arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    flag_killed(
        set.def, begin, end, [&](size_t i) { return x.vector(i); }, dead.data());
  });
  const auto count = static_cast<uint64_t>(std::count(dead.begin(), dead.end(), 1));
  if (count == 0) return;
  auto& living = in.workspace.object<LivingRows>("sph.living");
  living.set(dead);
  for (State::Column c = 0; c < columns::per_particle_end; ++c) living.close(s, c);
  if (set.ratio) living.close(s, set.ratio);
  s.span<uint64_t>(set.counts)[counts::killed] += count;
}

}  // namespace truestep::sph
