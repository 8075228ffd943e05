#include "engine/session/world/world.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/core/energy_swing.h"
#include "engine/core/equations/configuration.h"
#include "engine/core/lattice.h"
#include "engine/integrators/table/integrators.h"
#include "engine/session/commands.h"

namespace truestep {

CoupledStates World::sides(WorldState& state, size_t k) const {
  const SceneCoupling& c = scene_.couplings[k];
  return {state.couplings[k], state.systems[c.a], state.systems[c.b]};
}

ConstCoupledStates World::sides(const WorldState& state, size_t k) const {
  const SceneCoupling& c = scene_.couplings[k];
  return {state.couplings[k], state.systems[c.a], state.systems[c.b]};
}

size_t World::index_of(std::string_view wanted) const {
  std::string ids;
  for (size_t i = 0; i < size(); ++i) {
    if (id(i) == wanted) return i;
    ids += (i ? ", " : "") + id(i);
  }
  throw Error("unknown_system", "no system has the id \"" + std::string(wanted.substr(0, 64)) + '"',
              {"/system", "unknown_system", "no system has this id",
               '"' + std::string(wanted.substr(0, 64)) + '"', ids, "", ""});
}

WorldState World::initial_state() const {
  WorldState state;
  for (const auto& s : systems_) state.systems.push_back(s->initial_state());
  for (const auto& c : couplings_) state.couplings.push_back(c->initial_state());
  // Overflow between a scene's numbers and its initial state is a fault of the scene.
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  std::vector<Issue> issues;
  for (size_t i = 0; i < size(); ++i) {
    const State& s = state.systems[i];
    const auto bad = s.first_bad(kNoLimit, State::Look::everything);
    if (!bad) continue;
    const std::string what = s.info(bad->column).name + " of row " + std::to_string(bad->row);
    issues.push_back({"/systems/" + std::to_string(scene_.systems[i].place), "out_of_range",
                      "the start is not finite: " + what, "", "values that give finite results", "", ""});
  }
  if (!issues.empty()) throw Error("scene_invalid", "the scene's start is not finite", std::move(issues));
  if (finer_) state.finer.push_back(finer_->initial_state());
  return state;
}

void World::reject(size_t i, const State& state, const State::BadValue& bad) const {
  const ColumnInfo& column = state.info(bad.column);
  bool finite = true;
  for (size_t k = 0; k < column.width; ++k) {
    const size_t at = bad.row * column.width + k;
    finite = finite && std::isfinite(column.type == Scalar::f32 ? double{state.span<float>(bad.column)[at]}
                                                                : state.f64(bad.column)[at]);
  }
  throw Instability(
      id(i), column.name, static_cast<long long>(bad.row),
      finite ? column.name + " exploded: it is beyond a thousand times what the scene's energy allows"
             : column.name + " became non-finite");
}

namespace {

/// What systems joined by couplings may gain together, as a share of the energy at work in them: none of
/// their methods adds more to what it is given, and what impulses from one side to the other make of nothing
/// soon is many times what there was.
constexpr double kJointGain = 0.01;
/// Share of the potential at the start that may be at work: its zero is arbitrary, and what rests does
/// nothing.
constexpr double kStored = 0.01;
/// Steps in which what overlaps at the start is pushed apart.
constexpr uint64_t kParted = 16;

}  // namespace

bool World::watched(uint64_t step) {
  constexpr uint64_t kEvery = 16;
  return step % kEvery == 0 || (step < kEvery && std::has_single_bit(step));
}

void World::watch_energy(WorldState& state, size_t i, double t, Workspace& workspace,
                         const ThreadArena& arena) const {
  const auto now = systems_[i]->energy(state.systems[i], t, workspace.object<Workspace>(id(i)), arena);
  if (!now) return;
  const auto unstable = [&](const std::string& what) { return Instability(id(i), "energy", -1, what); };
  const auto joules = [](double v) { return short_number(v) + " J"; };
  if (!std::isfinite(now->kinetic) || !std::isfinite(now->potential))
    throw unstable(std::string(std::isfinite(now->kinetic) ? "potential" : "kinetic") +
                   " energy became non-finite");
  if (joined_to_[i] != i) return;
  auto all = couplings_.empty() ? now : energy_together(state, i, t, workspace, arena);
  if (!all) return;
  EnergyWatch& watch = state.watch[i];
  // After one step of explicit Euler from rest there is speed although no potential has given anything yet.
  if (watch.phase != EnergyWatch::Phase::fresh && state.step == 0) return;
  const double reference = watch.reference;
  // The limit takes as long as several steps: it is asked for only where the answer depends on it. What a
  // coupling ties to a system moves its limit.
  const bool joint = std::ranges::count(joined_to_, i) > 1;
  if (joint) {
    all->swing = kJointGain, all->residual = 0;
    if (state.step < kParted && watch.phase == EnergyWatch::Phase::watching) {
      // What is pushed apart rises from the first steps on: later it rises no more than it has by then.
      const auto group = std::ranges::find(tied_, i, &Tied::first);
      const bool begun = state.step > 1 && group != tied_.end();
      const double most = begun ? std::clamp(reference - group->start, 0.0, all->slack) : all->slack;
      watch.reference += std::clamp(all->kinetic + all->potential - reference, 0.0, most);
    }
    all->slack = 0;
  } else if (all->swing > Energy::kSwing && couplings_.empty()) {
    Energy narrow = *all;
    narrow.swing = Energy::kSwing;
    EnergyWatch tried = watch;
    if (!tried.holds(narrow)) {
      const auto limit = systems_[i]->limit(Limit::stable_dt, state.systems[i], scene_.substep());
      if (limit && *limit > 0) all->swing = swing_at(scene_.substep() / *limit);
    }
  }
  const EnergyWatch before = watch;
  const bool holds = watch.holds(*all);
  if (joint && before.phase != EnergyWatch::Phase::watching)
    watch.available = std::max(before.available, all->kinetic + kStored * std::abs(all->potential));
  if (!holds) {
    throw unstable("energy rose from " + joules(reference) + " to " + joules(all->kinetic + all->potential) +
                   " without a source (" + joules(watch.available) + " were available)");
  }
}

void World::look(WorldState& state, uint64_t step, Workspace& workspace, const ThreadArena& arena) const {
  for (size_t i = 0; i < systems_.size(); ++i) {
    try {
      if (const auto bad = state.systems[i].first_bad(speed_limits_[i], State::Look::everything))
        reject(i, state.systems[i], *bad);
      watch_energy(state, i, static_cast<double>(step) * dt(), workspace, arena);
    } catch (Instability& e) {
      e.step = static_cast<long long>(step > 0 ? step - 1 : 0);
      throw;
    }
  }
}

void World::examine(WorldState& state, Workspace& workspace, const ThreadArena& arena) const {
  if (state.step == 0 || state.watch.size() != systems_.size()) return;
  const auto watch = state.watch;
  look(state, state.step, workspace, arena);
  state.watch = watch;
}

std::optional<Energy> World::energy(const WorldState& state, size_t i) const {
  static const ThreadArena kSerial(1);
  Workspace workspace;
  return energy_together(state, i, static_cast<double>(state.step) * dt(), workspace, kSerial);
}

std::optional<Energy> World::energy_together(const WorldState& state, size_t i, double t,
                                             Workspace& workspace, const ThreadArena& arena) const {
  Energy sum;
  sum.exchange = Energy::Exchange::closed, sum.swing = 0;
  for (size_t k = 0; k < size(); ++k) {
    if (joined_to_[k] != joined_to_[i]) continue;
    const auto e = systems_[k]->energy(state.systems[k], t, workspace.object<Workspace>(id(k)), arena);
    if (!e) return std::nullopt;
    sum.kinetic += e->kinetic, sum.potential += e->potential, sum.slack += e->slack;
    sum.swing = std::max(sum.swing, e->swing), sum.residual += e->residual;
    if (e->exchange == Energy::Exchange::open) sum.exchange = Energy::Exchange::open;
  }
  for (size_t k = 0; k < couplings_.size(); ++k) {
    if (joined_to_[scene_.couplings[k].a] == joined_to_[i])
      sum.potential += couplings_[k]->stored_energy(sides(state, k));
  }
  return sum;
}

void World::apply(WorldState& state, const Command& command) const {
  const size_t i = index_of(command.system);
  const size_t first = joined_to_[i];
  const bool judged = first < state.watch.size() && state.watch[first].phase == EnergyWatch::Phase::watching;
  const auto before = judged ? energy(state, i) : std::nullopt;
  try {
    systems_[i]->apply(state.systems[i], command);
  } catch (const Instability&) {
    throw;
  } catch (const Error& refused) {
    throw as_written(refused, command.kind);
  }
  if (before) {
    if (const auto after = energy(state, i)) state.watch[first].command(*before, *after);
  }
  if (finer_) finer_->apply(state.finer.at(0), command);
}

Observables World::observe(const WorldState& state, const WantedObservables& wanted) const {
  Observables total =
      observe_parts(built(), state.systems, state.couplings, static_cast<double>(state.step) * dt(), wanted);
  for (const ProbeParams& p : scene_.header.probes) observe_probe(p, state, total);
  if (finer_) total.add("error.estimate", error_estimate(state), "1");
  return total;
}

std::vector<Observation> World::known_observables() const {
  return truestep::known_observables(built());
}

namespace {

// A field of doubles, or the configuration for "state" and for "position" when no part has one; empty when
// there is no such field.
std::vector<double> quantity_values(const System& system, const State& state, const std::string& name) {
  if (name == "state") return configuration(state);
  if (const auto at = system.find_field(name)) {
    std::vector<double> scratch;
    const FieldView view = system.field(state, at->part, at->field, scratch);
    const auto* values = static_cast<const double*>(view.data);
    if (view.type == Scalar::f64) return {values, values + view.rows * view.width};
  }
  if (name == "position") return configuration(state);
  return {};
}

}  // namespace

// |x - x_finer| / |x_finer| times the factor by which Richardson extrapolation scales a difference at half
// the step: 2^p / (2^p - 1) for order p; 10/9 at a tenth of the tolerance.
double World::error_estimate(const WorldState& state) const {
  const AccuracyParams& wanted = *scene_.header.accuracy;
  const size_t i = scene_.integrated_system(wanted.system).value();
  const State &coarse = state.systems[i], &finer = state.finer.at(0).systems[i];
  const std::vector<double> x = quantity_values(*systems_[i], coarse, wanted.quantity);
  const std::vector<double> y = quantity_values(*finer_->systems_[i], finer, wanted.quantity);
  if (x.size() != y.size()) return std::numeric_limits<double>::infinity();
  if (x.empty()) return std::numeric_limits<double>::quiet_NaN();
  double difference = 0, scale = 0;
  for (size_t k = 0; k < x.size(); ++k) {
    difference += (x[k] - y[k]) * (x[k] - y[k]);
    scale += y[k] * y[k];
  }
  double factor = 10.0 / 9;
  if (const Integrator* method = systems_[i]->integration().method;
      method && method->stepping == Integrator::Stepping::fixed) {
    factor = 1 / (1 - std::ldexp(1.0, -method->order));
  }
  return factor * std::sqrt(difference / std::max(scale, 1e-300));
}

namespace {

void probe_lattice(const ProbeParams& probe, const PartInfo& part, size_t field, const FieldView& view,
                   Observables& out) {
  const auto place = locate(part.lattice, *probe.at);
  if (!place) return;
  const FieldInfo& info = part.fields[field];
  const auto names = component_names(probe.id + "." + info.name, view.width);
  for (uint32_t c = 0; c < view.width; ++c) {
    double sum = 0;
    for (size_t k = 0; k < 8; ++k) sum += place->weights[k] * element(view, place->rows[k] * view.width + c);
    out.add(names[c], sum, info.unit);
  }
}

}  // namespace

namespace {

// A component of one row, or of all rows from it on.
double probed(ProbeParams::Rows rows, const FieldView& view, size_t first, size_t component) {
  const auto value = [&](size_t row) { return element(view, row * view.width + component); };
  double out = value(first);
  if (rows == ProbeParams::Rows::one) return out;
  for (size_t row = first + 1; row < view.rows; ++row) {
    const double v = value(row);
    if (rows == ProbeParams::Rows::mean) {
      out += v;
    } else if ((rows == ProbeParams::Rows::greatest ? v > out : v < out) || std::isnan(v)) {
      out = v;
    }
  }
  return rows == ProbeParams::Rows::mean ? out / static_cast<double>(view.rows - first) : out;
}

}  // namespace

void World::observe_probe(const ProbeParams& probe, const WorldState& state, Observables& out) const {
  std::vector<double> scratch;
  for (const std::string& name : probed_fields(parts_, probe)) {
    const FieldPlace at = *parts_.find(probe.system, name);
    const FieldView view = field(state, at, scratch);
    if (probe.at) {
      probe_lattice(probe, parts_[at.part].info(), at.field, view, out);
      continue;
    }
    const int64_t row = probe.index < 0 ? static_cast<int64_t>(view.rows) + probe.index : probe.index;
    if (row < 0 || row >= static_cast<int64_t>(view.rows)) continue;
    const std::string& unit = parts_[at.part].info().fields[at.field].unit;
    const auto names = component_names(probe.id + "." + name, view.width);
    for (uint32_t c = 0; c < view.width; ++c)
      out.add(names[c], probed(probe.rows, view, static_cast<size_t>(row), c), unit);
  }
}

void World::draw(const WorldState& state, Wish wishes, Drawing& out) const {
  const double t = static_cast<double>(state.step) * dt();
  const auto append = [](auto& to, auto& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  const auto shift = [](DrawnString& string, uint32_t a, uint32_t b) {
    for (StringEnd* end : {&string.a, &string.b}) {
      if (end->part != StringEnd::kWorld) end->part = end->part == 0 ? a : b;
    }
  };
  std::vector<uint32_t> first_parts;
  uint32_t parts_before = 0;  // whether or not constant drawings are wanted
  for (size_t i = 0; i < size(); ++i) {
    Drawing one;
    systems_[i]->draw(state.systems[i], t, wishes, one);
    if (wants(wishes, Wish::constant)) one.parts.resize(systems_[i]->parts().size());
    const auto first = static_cast<uint32_t>(out.parts.size());
    first_parts.push_back(first);
    for (DrawnString& string : one.strings) shift(string, first, first);
    for (JointMark& joint : one.joints) joint.part += parts_before;
    parts_before += static_cast<uint32_t>(systems_[i]->parts().size());
    append(out.parts, one.parts);
    append(out.strings, one.strings);
    append(out.obstacles, one.obstacles);
    append(out.contacts, one.contacts);
    append(out.joints, one.joints);
  }
  for (size_t k = 0; k < couplings_.size() && wants(wishes, Wish::constant); ++k) {
    const size_t before = out.strings.size();
    couplings_[k]->draw(sides(state, k), out.strings);
    const SceneCoupling& c = scene_.couplings[k];
    for (size_t i = before; i < out.strings.size(); ++i)
      shift(out.strings[i], first_parts[c.a], first_parts[c.b]);
  }
}

uint32_t World::drawing_version(const WorldState& state) const {
  uint32_t version = 0;
  Drawing unasked;
  for (size_t i = 0; i < size(); ++i) {
    unasked.version = 1;
    systems_[i]->draw(state.systems[i], static_cast<double>(state.step) * dt(), Wish::none, unasked);
    version = version * 1'000'003 + unasked.version;
  }
  return version;
}

std::vector<World::SystemWarning> World::warnings(const WorldState& state) const {
  std::vector<SystemWarning> out;
  std::vector<Warning> of_system;
  for (size_t i = 0; i < systems_.size(); ++i) {
    of_system.clear();
    systems_[i]->warn(state.systems[i], scene_.substep(), of_system);
    for (Warning& w : of_system) {
      w.suggested_dt *= static_cast<double>(scene_.substeps());
      out.push_back({i, std::move(w)});
    }
  }
  return out;
}

std::optional<double> World::stable_dt(const WorldState& state) const {
  std::optional<double> dt;
  const auto bound = [&](std::optional<double> h) {
    if (!h) return;
    const double whole = *h * static_cast<double>(scene_.substeps());
    dt = dt ? std::min(*dt, whole) : whole;
  };
  for (size_t i = 0; i < systems_.size(); ++i)
    bound(systems_[i]->limit(Limit::stable_dt, state.systems[i], scene_.substep()));
  for (size_t k = 0; k < couplings_.size(); ++k) bound(couplings_[k]->stable_h(sides(state, k)));
  return dt;
}

}  // namespace truestep
