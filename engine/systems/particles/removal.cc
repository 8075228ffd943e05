// Removes dead rows from every per-particle column, and springs that lost an end.
#include "engine/core/state/living_rows.h"
#include "engine/systems/particles/particles_state.h"

namespace truestep::particles {

namespace {

/// Renumbers the springs' ends and drops springs that lost one.
void remap_springs(State& s, const LivingRows& living) {
  uint32_t* rows = s.span<uint32_t>(columns::spring_rows).data();
  double* values = s.f64(columns::spring_values).data();
  size_t kept = 0;
  for (size_t i = 0; i < s.rows(columns::spring_rows); ++i) {
    const auto a = living.place(rows[2 * i]), b = living.place(rows[2 * i + 1]);
    if (!a || !b) continue;
    rows[2 * kept] = static_cast<uint32_t>(*a);
    rows[2 * kept + 1] = static_cast<uint32_t>(*b);
    store3(values, kept++, load3(values, i));
  }
  s.resize(columns::spring_rows, kept);
  s.resize(columns::spring_values, kept);
}

}  // namespace

void remove_rows(State& s, std::span<const uint8_t> dead, Workspace& workspace) {
  const size_t n = s.rows(columns::position);
  auto& living = workspace.object<LivingRows>("particles.living");
  living.set(dead);
  for (State::Column c = 0; c < s.columns(); ++c) {
    // The integrator's per-row columns are as wide as positions; its other columns do not depend on the
    // number of particles.
    const ColumnInfo& info = s.info(c);
    const bool carried = info.name.starts_with("integrator.") && s.rows(c) == n &&
                         info.width == s.info(columns::position).width;
    const bool charge = c == columns::charge && has_charges(s);
    if (c < columns::per_particle_end || carried || charge) living.close(s, c);
  }
  if (s.rows(columns::spring_rows) > 0) remap_springs(s, living);
}

}  // namespace truestep::particles
