// Particles emitted by nozzles and removed by kill regions.
#include "engine/systems/mpm/solver.h"

namespace truestep::mpm {

namespace {

/// In spacings: least distance of a new particle from existing ones.
constexpr double kLeastRoom = 0.7;

template <class Visit>
void for_columns(const Visit& visit) {
  for (State::Column c = 0; c < columns::per_particle_end; ++c) visit(c);
  visit(columns::piece), visit(columns::id);
}

/// Appends one undeformed particle.
void append(const Setting& set, State& s, const Vec3& x, size_t inlet) {
  const size_t row = s.rows(columns::position), d = static_cast<size_t>(set.def.dimension);
  for_columns([&](State::Column c) { s.resize(c, row + 1); });
  const size_t piece = set.def.bodies.size() + inlet;
  RealColumn<double> affine(s, columns::affine), f(s, columns::deformation);
  for (size_t k = 0; k < d * d; ++k) affine.set(d * d * row + k, 0), f.set(d * d * row + k, k % (d + 1) == 0);
  RealColumn<double>(s, columns::position).set_vector(row, x);
  RealColumn<double>(s, columns::velocity).set_vector(row, set.inlets[inlet].velocity());
  RealColumn<double>(s, columns::plastic).set(row, set.pieces[piece].material.law == Law::snow ? 1 : 0);
  RealColumn<double>(s, columns::jacobian).set(row, 1);
  s.span<uint32_t>(columns::piece)[row] = static_cast<uint32_t>(piece);
  s.span<uint64_t>(columns::id)[row] = s.span<uint64_t>(columns::counts)[counts::born]++;
}

}  // namespace

void pour(const Setting& set, State& s, double t, Workspace& workspace) {
  auto& near = workspace.object<std::vector<Vec3>>("mpm.near_nozzle");
  near.reserve(set.capacity);
  for (size_t k = 0; k < set.inlets.size(); ++k) {
    uint64_t& next = s.span<uint64_t>(columns::layers)[k];
    const double room = kLeastRoom * set.def.spacing();
    set.inlets[k].pour(s, columns::position, next, t, room, near, [&](const Vec3& p) {
      const bool fits = s.rows(columns::position) < set.capacity;
      ++s.span<uint64_t>(columns::counts)[fits ? counts::emitted : counts::refused];
      if (fits) append(set, s, p, k);
    });
  }
}

void remove_killed(const Setting& set, State& s, const StepInput& in) {
  auto& dead = in.workspace.object<std::vector<uint8_t>>("mpm.dead");
  dead.reserve(set.capacity);
  const uint64_t count = find_killed(set.def, s, columns::position, in.arena, dead);
  if (count == 0) return;
  auto& living = in.workspace.object<LivingRows>("mpm.living");
  living.set(dead);
  for_columns([&](State::Column c) { living.close(s, c); });
  s.span<uint64_t>(columns::counts)[counts::killed] += count;
}

}  // namespace truestep::mpm
