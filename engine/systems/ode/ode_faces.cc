// Drawing, limits and commands of an ode system.
#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/nearest_name.h"
#include "engine/integrators/control/step_work.h"
#include "engine/systems/ode/ode.h"

namespace truestep::ode {

using C = OdeColumns;

namespace {

[[noreturn]] void refuse(const char* pointer, const char* code, const std::string& why,
                         const std::string& allowed, const std::string& did_you_mean = "") {
  throw Error("bad_command", why, {pointer, code, why, "", allowed, did_you_mean, ""});
}

}  // namespace

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
