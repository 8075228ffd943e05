// Particles emitted by nozzles and removed by kill regions.
#include <vector>

#include "engine/core/state/living_rows.h"
#include "engine/core/state/real_column.h"
#include "engine/systems/sph/fluid.h"
#include "engine/systems/sph/setting.h"

namespace truestep::sph {

namespace {

/// Minimum distance, in spacings, of a new particle from existing ones.
constexpr double kLeastRoom = 0.7;

/// Adds a particle at the end.
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
  for (size_t k = 0; k < set.inlets.size(); ++k) {
    const Inlet& inlet = set.inlets[k];
    uint64_t& next = s.span<uint64_t>(set.layers)[k];
    inlet.pour(s, columns::position, next, t, kLeastRoom * set.def.spacing, near, [&](const Vec3& p) {
      const bool fits = s.rows(columns::position) < set.capacity;
      ++s.span<uint64_t>(set.counts)[fits ? counts::emitted : counts::refused];
      if (fits) append(set, s, p, inlet);
    });
  }
}

void remove_killed(const Setting& set, State& s, const StepInput& in) {
  auto& dead = in.workspace.object<std::vector<uint8_t>>("sph.dead");
  dead.reserve(set.capacity);
  const uint64_t count = find_killed(set.def, s, columns::position, in.arena, dead);
  if (count == 0) return;
  auto& living = in.workspace.object<LivingRows>("sph.living");
  living.set(dead);
  for (State::Column c = 0; c < columns::per_particle_end; ++c) living.close(s, c);
  if (set.ratio) living.close(s, set.ratio);
  s.span<uint64_t>(set.counts)[counts::killed] += count;
}

}  // namespace truestep::sph
