#include "engine/integrators/control/rising_step.h"

#include <algorithm>
#include <exception>
#include <vector>

#include "engine/base/errors.h"
#include "engine/integrators/implicit/newton/row_contacts.h"

namespace truestep {
namespace {

void in_parts(int parts, State& s, const StepInput& in, const RisingStep::Step& step) {
  for (int k = 0; k < parts; ++k) {
    step(s, {in.t + in.h * k / parts, in.h / parts, in.step, in.workspace, in.arena, in.profile});
  }
}

}  // namespace

/// What a step changes, as it was at the step's start.
struct RisingStep::Before {
  std::vector<double> x, v, drag;
  std::vector<uint32_t> kind;
  bool reserved = false;

  static void copy(std::span<const double> from, std::vector<double>& to) {
    to.assign(from.begin(), from.end());
  }
  void keep(State& s) {
    copy(s.f64(s.at("position")), x), copy(s.f64(s.at("velocity")), v);
    if (!s.find("contact.kind")) return;
    const RowContacts on = RowContacts::all(s);
    copy(on.drag, drag), kind.assign(on.kind.begin(), on.kind.end());
  }
  void put_back(State& s) const {
    std::ranges::copy(x, s.f64(s.at("position")).begin());
    std::ranges::copy(v, s.f64(s.at("velocity")).begin());
    if (kind.empty()) return;
    const RowContacts on = RowContacts::all(s);
    std::ranges::copy(drag, on.drag.begin());
    std::ranges::copy(kind, on.kind.begin());
  }
};

RisingStep::Before& RisingStep::start(State& s, const StepInput& in, const Step& reserve) const {
  Before& before = in.workspace.object<Before>("integrator.before");
  before.keep(s);
  if (before.reserved) return before;
  before.reserved = true;
  reserve(s, in);
  Evaluation e{in.workspace, in.arena};
  const Phase now{in.t, before.x, before.v, s};
  field_.kinetic(now, e), field_.potential(now, e);
  return before;
}

bool RisingStep::rises(const State& s, const StepInput& in, std::span<const double> x0,
                       std::span<const double> v0, const Fast& fast) const {
  const auto v = s.f64(s.at("velocity"));
  if (!fast(v0, v, in.h)) return false;
  Evaluation e{in.workspace, in.arena};
  const Phase begin{in.t, x0, v0, s}, end{in.t + in.h, s.f64(s.at("position")), v, s};
  const double kinetic[] = {field_.kinetic(begin, e), field_.kinetic(end, e)};
  const double before = kinetic[0] + field_.potential(begin, e).value_or(0);
  const double after = kinetic[1] + field_.potential(end, e).value_or(0);
  return after - before > bounds_.rise * std::max(kinetic[0], kinetic[1]);
}

void RisingStep::step(State& s, const StepInput& in, const Fast& fast, const Step& usual, const Step& full,
                      const Step& reserve) const {
  Before& before = start(s, in, reserve);
  usual(s, in);
  for (int parts = 1; parts <= bounds_.most_parts && rises(s, in, before.x, before.v, fast); parts *= 2) {
    before.put_back(s);
    try {
      in_parts(parts, s, in, full);
    } catch (const Instability&) {
      before.put_back(s);
      return usual(s, in);
    }
  }
}

void RisingStep::step_in_parts(State& s, const StepInput& in, Supply supply, const Fast& fast,
                               const Step& one) const {
  Before& before = start(s, in, [](State&, const StepInput&) {});
  std::exception_ptr failure;
  int solved = 0;  // the most parts that had a solution
  for (int parts = 1; parts <= bounds_.most_parts; parts *= 2) {
    if (parts > 1) before.put_back(s);
    try {
      in_parts(parts, s, in, one);
    } catch (const Instability&) {
      if (!failure) failure = std::current_exception();
      continue;
    }
    solved = parts;
    if (supply == Supply::some || !rises(s, in, before.x, before.v, fast)) return;
  }
  if (solved == bounds_.most_parts) return;
  if (solved == 0) std::rethrow_exception(failure);
  before.put_back(s);
  in_parts(solved, s, in, one);
}

}  // namespace truestep
