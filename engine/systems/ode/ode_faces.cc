// Parts, fields, observables, drawing and commands of an ode system.
#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/nearest_name.h"
#include "engine/integrators/control/step_work.h"
#include "engine/systems/ode/ode.h"

namespace truestep::ode {

using C = OdeColumns;

namespace {

/// Longer arrays are available only as fields.
constexpr size_t kObservedElements = 16;

[[noreturn]] void refuse(const char* pointer, const char* code, const std::string& why,
                         const std::string& allowed, const std::string& did_you_mean = "") {
  throw Error("bad_command", why, {pointer, code, why, "", allowed, did_you_mean, ""});
}

}  // namespace

void Ode::observe(const State& s, double t, Observables& out) const {
  const auto y = s.f64(C::kStates);
  for (const OdeModel::Named& n : model_.states) {
    if (n.places.size() > kObservedElements) continue;
    for (size_t k = 0; k < n.places.size(); ++k) {
      const bool one = n.form == NamedNumbers::Form::number;
      out.add(one ? n.name : n.name + "." + std::to_string(k), y[n.places[k]], "1");
    }
  }
  if (const size_t count = model_.invariants.outputs(); count > 0) {
    OdeEvaluation evaluate(model_.invariants);
    evaluate.set_parameters(s.f64(C::kParameters));
    std::vector<double> now(count);
    evaluate(t, y.data(), y.size(), model_.parameter_values.size(), now.data());
    for (size_t k = 0; k < count; ++k) {
      const double start = s.f64(C::kInvariantsAtStart)[k];
      out.add(model_.invariant_names[k], now[k], "1");
      // Relative, but absolute where the invariant starts at 0.
      out.add(model_.invariant_names[k] + ".drift",
              std::abs(now[k] - start) / (start != 0 ? std::abs(start) : 1), "1");
    }
  }
  for (size_t k = 0; k < model_.events.size(); ++k) {
    out.add("events." + model_.events[k].name, static_cast<double>(s.span<uint64_t>(C::kEventCounts)[k]),
            "1");
  }
  size_t guard = 0;
  for (const OdeModel::Event& e : model_.events) {
    if (model_.contacts.empty() || e.def.when.empty()) continue;
    const size_t k = guard++;
    if (model_.contacts[k].places.empty()) continue;
    out.add("events." + e.name + ".resting", s.span<int32_t>(C::kResting)[k] != 0 ? 1 : 0, "1");
  }
  if (!model_.events.empty()) {
    const bool stopped = s.f64(C::kStopped)[0] != 0;
    out.add("stopped", stopped ? 1 : 0, "1");
    out.add("stopped.time", stopped ? s.f64(C::kStopped)[1] : t, "s");
  }
  if (def_.tracers) {
    // One pass in the order of the points.
    const auto x = s.f64(C::kTracers);
    constexpr const char* kAxes[] = {"x", "y", "z"};
    const size_t tracers = x.size() / 3;
    out.add("tracers.count", static_cast<double>(tracers), "1");
    for (size_t axis = 0; axis < 3; ++axis) {
      double least = HUGE_VAL, greatest = -HUGE_VAL, sum = 0;
      for (size_t i = axis; i < x.size(); i += 3) {
        least = std::min(least, x[i]), greatest = std::max(greatest, x[i]);
        sum += x[i];
      }
      const std::string name = std::string("tracers.") + kAxes[axis];
      out.add(name + ".min", least, "m");
      out.add(name + ".max", greatest, "m");
      out.add(name + ".mean", sum / static_cast<double>(tracers), "m");
    }
  }
  if (method_) {
    constexpr const char* kNames[] = {"integrator.steps", "integrator.rejected", "integrator.rates",
                                      "integrator.jacobians"};
    for (size_t k = 0; k < kOdeWorkCounters; ++k) {
      out.add(kNames[k], static_cast<double>(s.span<uint64_t>(C::kWork)[k]), "1");
    }
  }
}

void Ode::name_parts() {
  std::vector<PartInfo> parts;
  if (rows_ > 0) {
    PartInfo& points = parts.emplace_back();
    points.fields.push_back({"position", "m", Scalar::f64, 3, Meaning::position});
    if (!tags_.empty()) points.fields.push_back({"tag", "1"});
    points.max_rows = rows_;
    points.trail = trail_;
  }
  for (size_t k = 0; k < model_.states.size(); ++k) {
    const size_t rows = model_.states[k].places.size();
    const auto alike = [&](const std::vector<size_t>& g) {
      return model_.states[g[0]].places.size() == rows;
    };
    auto at = std::find_if(groups_.begin(), groups_.end(), alike);
    if (at == groups_.end()) at = groups_.insert(at, std::vector<size_t>{});
    at->push_back(k);
  }
  for (const std::vector<size_t>& group : groups_) {
    PartInfo& part = parts.emplace_back();
    part.kind = PartInfo::Kind::values;
    part.max_rows = model_.states[group[0]].places.size();
    if (parts.size() > 1) part.name = part.max_rows == 1 ? "states" : model_.states[group[0]].name;
    for (const size_t k : group) part.fields.push_back({model_.states[k].name, "1"});
  }
  set_parts(std::move(parts));
  set_remedies(
      {"a look at the equations: no method continues past a time where the solution blows up or jumps (an "
       "event can stop before it, or set states)"});
}

FieldView Ode::field(const State& s, size_t part, size_t field, std::vector<double>& scratch) const {
  if (rows_ > 0 && part-- == 0) {
    if (field == 1) return {tags_.data(), Scalar::f64, tags_.size(), 1};
    return {s.f64(def_.tracers ? C::kTracers : C::kTrail).data(), Scalar::f64, rows_, 3};
  }
  const OdeModel::Named& n = model_.states[groups_[part][field]];
  scratch.resize(n.places.size());
  for (size_t k = 0; k < n.places.size(); ++k) scratch[k] = s.f64(C::kStates)[n.places[k]];
  return {scratch.data(), Scalar::f64, scratch.size(), 1};
}

std::optional<double> Ode::limit(Limit which, const State& s, double h) const {
  if (which != Limit::step_seconds || !method_) return std::nullopt;
  OdeEquations f(model_);
  f.set_parameters(s.f64(C::kParameters));
  const auto rate = static_cast<double>(model_.rate.instructions());
  const auto work = implicit_step_work(*method_, f, rate, h, s.f64(C::kStates).data(), tolerance_);
  return work ? std::optional(work->seconds()) : std::nullopt;
}

void Ode::apply(State& s, const Command& c) const {
  if (c.kind != CommandKind::set_parameter) {
    refuse("/type", "unsupported_command", "an ode system takes no such command", "set_parameter");
  }
  const auto target = model_.find(c.name);
  if (!target) {
    std::vector<std::string> known;
    for (const auto* list : {&model_.parameters, &model_.states}) {
      for (const OdeModel::Named& n : *list) {
        known.push_back(n.form == NamedNumbers::Form::number ? n.name : n.name + "[0]");
      }
    }
    std::string allowed;
    for (const std::string& k : known) {
      if (allowed.size() < 200) allowed += (allowed.empty() ? "" : ", ") + k;
    }
    refuse("/name", "unknown_parameter", "no parameter and no state has this name", allowed,
           nearest_name(c.name, known));
  }
  if (!std::isfinite(c.value)) refuse("/value", "not_finite", "the value must be finite", "a finite number");
  using Kind = OdeModel::Event::Target::Kind;
  s.f64(target->kind == Kind::state ? C::kStates : C::kParameters)[target->place] = c.value;
  // Guards count from where they are next seen, and a stopped system continues.
  forget(s);
  std::ranges::fill(s.span<int32_t>(C::kEventSigns), 0);
  if (!model_.contacts.empty()) {
    // Resting states are put on the side to which their contact pushed: they fall back or rise.
    const auto resting = s.span<int32_t>(C::kResting);
    std::ranges::copy(resting, s.span<int32_t>(C::kEventSigns).begin());
    std::ranges::fill(resting, 0);
  }
  std::ranges::fill(s.f64(C::kStopped), 0.0);
}

bool Ode::lies_in_plane() const {
  if (!def_.tracers) return model_.axes.size() == 2;
  return std::ranges::none_of(def_.tracers->velocity, [](const NamedText& v) { return v.name == "z"; });
}

void Ode::draw(const State& s, double, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::constant)) {
    out.parts.resize(parts().size());
    PartDrawing& d = out.parts[0];
    if (def_.color) d.color = {def_.color->x, def_.color->y, def_.color->z};
    // The path of every body as a line; its head is one of the obstacles.
    if (trail_ == 0) d.point_radius = def_.draw_radius;
    if (!def_.tracers) d.plot = model_.axes, d.curves = model_.curves;
    if (lies_in_plane()) d.space = PartDrawing::Space::plane;
    const auto length = static_cast<uint32_t>(trail_ + 1);
    for (uint32_t b = 0; trail_ > 0 && b < model_.bodies; ++b) {
      for (uint32_t k = 0; k + 1 < length; ++k) d.lines.push_back({b * length + k, b * length + k + 1});
    }
    d.line_kinds.assign(d.lines.size(), LineKind::structural);
  }
  if (!wants(wishes, Wish::obstacles) || trail_ == 0 || def_.draw_radius == 0) return;
  for (size_t b = 0; b < model_.bodies; ++b) {
    DrawnShape& head = out.obstacles.emplace_back();
    head.kind = DrawnShape::Kind::sphere;
    head.position = load3(s.f64(C::kTrail).data(), b * (trail_ + 1));
    head.size = {def_.draw_radius, 0, 0};
    head.id = "head" + std::to_string(b);
  }
}

}  // namespace truestep::ode
