#include "engine/systems/mass_spring/rising_step.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/integrators/implicit/implicit.h"
#include "engine/integrators/implicit/row_contacts.h"

namespace truestep::mass_spring {
namespace {

using Columns = MassSpringColumns;

/// What a step changes, as it was at the step's start.
struct Before {
  std::vector<double> x, v, drag;
  std::vector<uint32_t> kind;
  bool reserved = false;

  static void copy(std::span<const double> from, std::vector<double>& to) {
    to.assign(from.begin(), from.end());
  }
  void keep(State& s) {
    copy(s.f64(Columns::position), x), copy(s.f64(Columns::velocity), v);
    if (!s.find("contact.kind")) return;
    const RowContacts on = RowContacts::all(s);
    copy(on.drag, drag), kind.assign(on.kind.begin(), on.kind.end());
  }
  void put_back(State& s) const {
    std::copy(x.begin(), x.end(), s.f64(Columns::position).begin());
    std::copy(v.begin(), v.end(), s.f64(Columns::velocity).begin());
    if (kind.empty()) return;
    const RowContacts on = RowContacts::all(s);
    std::copy(drag.begin(), drag.end(), on.drag.begin());
    std::copy(kind.begin(), kind.end(), on.kind.begin());
  }
};

}  // namespace

RisingStep::RisingStep(const MassSpringField& field, const IntegratorOptions& options)
    : field_(field), options_(options), shortest_(HUGE_VAL) {
  for (const double rest : field.schedule().rest) {
    if (rest > 0) shortest_ = std::min(shortest_, rest);
  }
}

bool RisingStep::rises(const State& s, const StepInput& in, std::span<const double> x0,
                       std::span<const double> v0) const {
  const auto v = s.f64(Columns::velocity);
  const double turns = kTurns * shortest_ / (2 * in.h);
  const auto fast = [&](double component) { return std::abs(component) > turns; };
  if (std::ranges::none_of(v, fast) && std::ranges::none_of(v0, fast)) return false;
  Evaluation e{in.workspace, in.arena};
  const Phase begin{in.t, x0, v0, s}, end{in.t + in.h, s.f64(Columns::position), v, s};
  const double kinetic[] = {field_.kinetic(begin, e), field_.kinetic(end, e)};
  const double before = kinetic[0] + field_.potential(begin, e).value_or(0);
  const double after = kinetic[1] + field_.potential(end, e).value_or(0);
  return after - before > kRise * std::max(kinetic[0], kinetic[1]);
}

void RisingStep::reserve(State& s, const StepInput& in) const {
  Motion m(field_, s, in);
  reserve_implicit_euler_sparse(m, options_);
  Evaluation e{in.workspace, in.arena};
  const Phase now{in.t, m.x, m.v, s};
  field_.kinetic(now, e), field_.potential(now, e);
}

void RisingStep::step(State& s, const StepInput& in, const Step& usual, const Step& full) const {
  Before& before = in.workspace.object<Before>("mass_spring.before");
  before.keep(s);
  if (!before.reserved) reserve(s, in), before.reserved = true;
  usual(s, in);
  for (int parts = 1; parts <= kMostParts && rises(s, in, before.x, before.v); parts *= 2) {
    before.put_back(s);
    try {
      for (int k = 0; k < parts; ++k) {
        full(s, {in.t + in.h * k / parts, in.h / parts, in.step, in.workspace, in.arena, in.profile});
      }
    } catch (const Instability&) {
      before.put_back(s);
      return usual(s, in);
    }
  }
}

}  // namespace truestep::mass_spring
