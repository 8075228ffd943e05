// What a step does besides the forces: contacts, the end of lives, and births.
#include <algorithm>

#include "engine/systems/particles/emission.h"
#include "engine/systems/particles/particles.h"

namespace truestep::particles {

namespace {

constexpr const char* kOldPositions = "particles.old_positions";
constexpr const char* kOldVelocities = "particles.old_velocities";

/// The colliders' surfaces as stored in the state.
std::span<const Surface> surfaces(const State& s, Workspace& workspace) {
  auto& out = workspace.object<std::vector<Surface>>("particles.surfaces");
  const auto rows = s.f64(columns::surfaces);
  out.clear();
  for (size_t k = 0; k < rows.size(); k += 3) out.push_back({rows[k], rows[k + 1], rows[k + 2]});
  return out;
}

}  // namespace

void Particles::remember(State& s, const StepInput& in) const {
  const auto x = s.f64(columns::position), v = s.f64(columns::velocity);
  // Sized for the largest simultaneous number of particles, so that births do not allocate later.
  double* old_x = in.workspace.doubles(kOldPositions, 3 * particles_.capacity()).data();
  double* old_v = in.workspace.doubles(kOldVelocities, 3 * particles_.capacity()).data();
  in.arena.for_blocks(x.size(), 3 * kBlockRows, [&](size_t begin, size_t end) {
    std::copy(x.begin() + begin, x.begin() + end, old_x + begin);
    std::copy(v.begin() + begin, v.begin() + end, old_v + begin);
  });
}

void Particles::collide(State& s, const StepInput& in) const {
  const auto x = s.f64(columns::position), v = s.f64(columns::velocity);
  const size_t capacity = 3 * particles_.capacity();
  const auto old_x = in.workspace.doubles(kOldPositions, capacity).first(x.size());
  const auto old_v = in.workspace.doubles(kOldVelocities, capacity).first(v.size());
  ContactSweep sweep{in.t, in.h, old_x, old_v, x, v};
  sweep.radius = particles_.def().radius;
  sweep.surfaces = surfaces(s, in.workspace);
  particles_.colliders().resolve(sweep, in.workspace, in.arena);
}

void Particles::end_lives(State& s, const StepInput& in) const {
  const ParticlesDef& d = particles_.def();
  const auto death = s.f64(columns::death);
  const double* x = s.f64(columns::position).data();
  const size_t n = death.size();
  const double now = in.t + in.h;
  auto& dead = in.workspace.object<std::vector<uint8_t>>("particles.dead");
  if (dead.size() < n) dead.resize(particles_.capacity());

  const double count = in.arena.sum_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    uint8_t* flag = dead.data();
    for (size_t i = begin; i < end; ++i) flag[i] = death[i] <= now;
    flag_killed(
        d, begin, end, [x](size_t i) { return load3(x, i); }, flag);
    size_t sum = 0;
    for (size_t i = begin; i < end; ++i) sum += flag[i];
    return static_cast<double>(sum);
  });
  if (count == 0) return;
  counter(s, Counter::killed) += static_cast<uint64_t>(count);
  remove_rows(s, {dead.data(), n}, in.workspace);
}

void Particles::emit(State& s, const StepInput& in) const {
  const ParticlesDef& d = particles_.def();
  for (size_t k = 0; k < d.emitters.size(); ++k) {
    uint64_t n = s.span<uint64_t>(columns::next_particle)[k];
    for (double born; (born = birth_time(d.emitters[k], n)) < in.t + in.h; ++n) {
      add_newborn(s, in, d.emitters[k], k, n, born);
    }
    s.span<uint64_t>(columns::next_particle)[k] = n;
  }
}

void Particles::add_newborn(State& s, const StepInput& in, const EmitterDef& e, size_t emitter, uint64_t n,
                            double born) const {
  if (s.rows(columns::position) >= particles_.capacity()) {
    ++counter(s, Counter::refused);
    return;
  }
  const ParticlesDef& d = particles_.def();
  const Birth b = birth(e, seed_, emitter, n);
  const double mass = e.mass.value_or(d.mass), left = in.t + in.h - born;
  if (b.lifetime <= left) {
    ++counter(s, Counter::emitted), ++counter(s, Counter::killed);
    return;
  }
  // The rest of the step, to second order with the forces at birth.
  const Vec3 a = particles_.single_acceleration(s, born, b.x, b.v, mass);
  Vec3 x = b.x + b.v * left + a * (0.5 * left * left), v = b.v + a * left;
  if (!particles_.colliders().empty() && left > 0) {
    const double x0[3] = {b.x.x, b.x.y, b.x.z}, v0[3] = {b.v.x, b.v.y, b.v.z};
    double x1[3] = {x.x, x.y, x.z}, v1[3] = {v.x, v.y, v.z};
    ContactSweep sweep{born, left, x0, v0, x1, v1};
    sweep.radius = d.radius;
    sweep.surfaces = surfaces(s, in.workspace);
    particles_.colliders().resolve(sweep, in.workspace, in.arena);
    x = load3(x1, 0), v = load3(v1, 0);
  }
  append_particle(s, {x, v, mass, born, born + b.lifetime, d.charge});
  ++counter(s, Counter::emitted);
}

}  // namespace truestep::particles
