#include "engine/systems/heightfield_wave/heightfield_wave.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/core/commands/command_checks.h"

namespace truestep::heightfield_wave {

using shallow::Basin;
using shallow::Water;

namespace {
enum Column : State::Column { kDepth, kX, kY };
enum Number : size_t { kFriction, kSubsteps, kCfl, kNumbers };

PartInfo cells_part(const Basin& b, const Vec3& corner) {
  PartInfo part;
  part.kind = PartInfo::Kind::grid;
  part.fields = {
      {"surface", "m"}, {"depth", "m"}, {"velocity", "m/s", Scalar::f64, 3}, {"speed", "m/s"}, {"bed", "m"}};
  part.max_rows = b.count();
  for (size_t a = 0; a < b.dimensions; ++a) part.lattice.counts[a] = static_cast<uint32_t>(b.cells[a]);
  part.lattice.origin = {b.centre(0, 0), b.dimensions == 2 ? b.centre(1, 0) : corner.y, corner.z};
  part.lattice.spacing = {b.spacing[0], b.spacing[1], 1};
  part.lattice.centring = Lattice::Centring::cells;
  return part;
}

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
  set_parts({cells_part(basin_, def.origin.value_or(Vec3{}))});
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

Water HeightfieldWave::water(State& s) const {
  return {s.f64(kDepth).data(), s.f64(kX).data(), basin_.dimensions == 2 ? s.f64(kY).data() : nullptr};
}

Water HeightfieldWave::rows(std::vector<double>& of) const {
  const size_t n = basin_.count();
  return {of.data(), of.data() + n, basin_.dimensions == 2 ? of.data() + 2 * n : nullptr};
}

double HeightfieldWave::bed(size_t cell) const {
  return bed_[basin_.at(cell % basin_.cells[0], cell / basin_.cells[0])];
}

void HeightfieldWave::bind(Work& w) const {
  const size_t n = basin_.count() * (1 + basin_.dimensions), padded = basin_.padded();
  w.p.z = bed_;
  w.p.h.resize(padded), w.p.eta.resize(padded), w.p.u.resize(padded);
  // Nothing flows across a line.
  if (basin_.dimensions == 2) {
    w.p.v.resize(padded);
  } else {
    w.p.v.assign(padded, 0);
  }
  w.rates.resize(n), w.before.resize(n), w.row_speeds.resize(2 * basin_.cells[1]);
}

void HeightfieldWave::add(const Water& water, const Work& work, double h, const ThreadArena& arena) const {
  const size_t n = basin_.count();
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    const double* rate = work.rates.data();
    for (size_t i = begin; i < end; ++i) water.h[i] = std::max(0.0, water.h[i] + h * rate[i]);
    for (size_t i = begin; i < end; ++i) water.qx[i] += h * rate[n + i];
    if (!water.qy) return;
    for (size_t i = begin; i < end; ++i) water.qy[i] += h * rate[2 * n + i];
  });
}

void HeightfieldWave::finish(const Water& water, const Work& work, double friction, double h,
                             const ThreadArena& arena) const {
  const size_t n = basin_.count();
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    const double* before = work.before.data();
    for (size_t i = begin; i < end; ++i) {
      const double depth = 0.5 * (before[i] + water.h[i]), qx = 0.5 * (before[n + i] + water.qx[i]);
      const double qy = water.qy ? 0.5 * (before[2 * n + i] + water.qy[i]) : 0;
      const bool wet = depth > basin_.dry;
      // Backward Euler for q' = -friction |q| q / depth^2, with |q| lagged.
      const double slowed = 1 + h * friction * std::sqrt(qx * qx + qy * qy) / (depth * depth);
      const double kept = wet ? 1 / slowed : 0;
      water.h[i] = depth, water.qx[i] = kept * qx;
      if (water.qy) water.qy[i] = kept * qy;
    }
  });
}

void HeightfieldWave::advance(State& s, const StepInput& in) const {
  auto& work = in.workspace.object<Work>("heightfield_wave");
  bind(work);
  const Water now = water(s), rate = rows(work.rates), before = rows(work.before);
  const auto numbers = s.f64(numbers_);
  const size_t n = basin_.count();
  const auto copy = [&](const Water& from, const Water& to) {
    std::copy_n(from.h, n, to.h), std::copy_n(from.qx, n, to.qx);
    if (from.qy) std::copy_n(from.qy, n, to.qy);
  };
  const auto crossing = [&] {
    primitives(basin_, now, work.p, in.arena);
    return shallow::rates(basin_, work.p, rate, work.row_speeds.data(), in.arena);
  };
  double left = in.h, highest = 0;
  int taken = 0;
  while (left > 0) {
    copy(now, before);
    double speed = crossing();
    // A first stage may raise faster waves than the substep was chosen for: then it is repeated.
    for (double h = 0;;) {
      const double wanted = std::ceil(left * speed / def_.cfl - 1e-9);
      if (!(wanted + taken <= kMostSubsteps)) {
        Instability e(id_, "depth", -1,
                      "the fastest wave crosses " + short_number(left * speed) +
                          " cells in a step: more than " + std::to_string(kMostSubsteps) +
                          " substeps would be needed");
        if (std::isfinite(wanted)) e.suggested_dt = 0.5 * in.h * kMostSubsteps / (wanted + taken);
        throw e;
      }
      h = left / std::max(1.0, wanted);
      add(now, work, h, in.arena);
      const double raised = crossing();
      if (h * raised <= 0.5 || raised <= speed) {
        add(now, work, h, in.arena);
        finish(now, work, numbers[kFriction], h, in.arena);
        left = wanted <= 1 ? 0 : left - h;
        highest = std::max(highest, h * std::max(speed, raised));
        ++taken;
        break;
      }
      copy(before, now);
      crossing();
      speed = raised;
    }
  }
  numbers[kSubsteps] = taken, numbers[kCfl] = highest;
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
