#include "engine/systems/heightfield_wave/heightfield_wave.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/commands/command_checks.h"
#include "engine/systems/heightfield_wave/columns.h"

namespace truestep::heightfield_wave {

using shallow::Basin;
using namespace columns;

namespace {
Basin basin_of(const HeightfieldWaveDef& def, const BuildContext& context) {
  Basin b = make_basin(def);
  const Vec3& g = context.gravity;
  b.gravity = std::sqrt(g.x * g.x + g.y * g.y + g.z * g.z);
  return b;
}
}  // namespace

HeightfieldWave::HeightfieldWave(const HeightfieldWaveDef& def, const BuildContext& context)
    : id_(context.id), def_(def), basin_(basin_of(def, context)), texts_(def) {
  const size_t n = basin_.count();
  show();
  set_remedies({"a shorter dt", "fewer cells", "a larger dry_depth: thin films can be very fast"});
  start_.add({"depth", "m", Scalar::f64, 1, Role::position}, n);
  start_.add({"discharge.x", "m^2/s", Scalar::f64, 1, Role::velocity}, n);
  if (basin_.dimensions == 2) start_.add({"discharge.y", "m^2/s", Scalar::f64, 1, Role::velocity}, n);
  numbers_ = start_.add({"numbers", "1", Scalar::f64, 1, Role::internal}, kNumbers);
  start_.f64(numbers_)[kFriction] = def.friction;

  std::vector<double> bed(n), value(n);
  BasinTexts::sample(texts_.bed, basin_, 0, bed.data());
  bed_.assign(basin_.padded(), 0);
  for (size_t i = 0; i < n; ++i) bed_[basin_.at(i % basin_.cells[0], i / basin_.cells[0])] = bed[i];
  fill_edges(basin_, 2, bed_.data());
  const auto h = start_.f64(kDepth);
  BasinTexts::sample(texts_.surface, basin_, 0, value.data());
  for (size_t i = 0; i < n; ++i) h[i] = std::max(0.0, value[i] - bed[i]);
  basin_.dry = def.dry_depth.value_or(1e-6 * *std::ranges::max_element(h));
  for (size_t a = 0; a < basin_.dimensions; ++a) {
    const auto q = start_.f64(static_cast<State::Column>(kX + a));
    BasinTexts::sample(texts_.velocity[a], basin_, 0, value.data());
    for (size_t i = 0; i < n; ++i) q[i] = h[i] > basin_.dry ? h[i] * value[i] : 0;
  }
  add_stage("water", std::to_string(n) + " cells by finite volumes in two stages a substep",
            [this](State& s, const StepInput& in) { advance(s, in); });
  if (def.friction == 0) skip_stage("friction", "friction is 0");
}

double HeightfieldWave::bed(size_t cell) const {
  return bed_[basin_.at(cell % basin_.cells[0], cell / basin_.cells[0])];
}

void HeightfieldWave::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind == CommandKind::set_parameter) {
    if (c.name != "friction")
      refuse_command("name", "unknown_parameter", "no parameter " + c.name + " to set", "friction");
    if (!(c.value >= 0)) refuse_command("value", "out_of_range", "the friction must be at least 0", ">= 0");
    s.f64(numbers_)[kFriction] = c.value;
  } else if (c.kind == CommandKind::impulse) {
    if (!c.at) refuse_command("at", "missing", "an impulse on water needs the point where it acts");
    const double at[] = {c.at->x, c.at->y}, vector[] = {c.vector.x, c.vector.y};
    size_t cell[2] = {};
    for (size_t a = 0; a < basin_.dimensions; ++a) {
      const double place = (at[a] - basin_.origin[a]) / basin_.spacing[a];
      if (!(place >= 0 && place <= static_cast<double>(basin_.cells[a])))
        refuse_command("at", "out_of_range", "the point lies outside the basin");
      cell[a] = std::min(static_cast<size_t>(place), basin_.cells[a] - 1);
    }
    const size_t row = cell[0] + basin_.cells[0] * cell[1];
    if (s.f64(kDepth)[row] <= basin_.dry) refuse_command("at", "out_of_range", "the ground is dry there");
    for (size_t a = 0; a < basin_.dimensions; ++a)
      s.f64(static_cast<State::Column>(kX + a))[row] += vector[a] / (def_.density * basin_.cell_area());
  } else {
    refuse_command("type", "unsupported_command", "heightfield_wave takes no such command",
                   "impulse, set_parameter");
  }
}

std::unique_ptr<const System> build_heightfield_wave(const void* def, const BuildContext& context) {
  return std::make_unique<HeightfieldWave>(*static_cast<const HeightfieldWaveDef*>(def), context);
}

}  // namespace truestep::heightfield_wave
