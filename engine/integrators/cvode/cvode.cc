// CVODE behind the common interface of methods. Its history (order, step sizes, the Nordsieck array)
// continues over calls: steps are taken as CVODE wants them, also past the end of a call, and solutions come
// from its polynomial. The library neither exports nor imports that history, so the state keeps the point
// where it began and how many steps ago; CVODE's memory itself stays in the workspace. If that is gone, or is
// not the one that the state refers to, the steps are repeated from the beginning, which gives the same bits.
// To bound this, a history starts anew after kMostRepeated steps, and whenever y or anything else that f
// depends on has changed (commands, contacts, events).
// Costs: a restored run repeats up to kMostRepeated steps once; about forty short steps in kMostRepeated.
// A call without memory is a run of its own that stops at its end. CVODE calls the C library's pow: its bits
// are those of one machine.
#include "engine/integrators/cvode/cvode.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/integrators/control/step_control.h"
#include "engine/integrators/cvode/cvode_run.h"
#include "engine/integrators/implicit/implicit_methods.h"

namespace truestep {

namespace {

constexpr double kMostRepeated = 2000;

// What the state keeps; see cvode_memory.
class Journal {
 public:
  Journal(std::span<double> memory, size_t n)
      : m_(memory.size() == cvode_memory(n) ? memory.data() : nullptr), n_(n) {}

  /// Whether the recorded history ends in y under these surroundings.
  bool ends_in(const double* y, uint64_t surroundings) const {
    return m_ && m_[kSteps] >= 0 && m_[kSteps] < kMostRepeated && m_[kLow] == low(surroundings) &&
           m_[kHigh] == high(surroundings) && std::equal(y, y + n_, m_ + kHead + n_);
  }
  double t() const { return m_[kTime]; }
  double first_aim() const { return m_[kAim]; }
  uint64_t steps() const { return static_cast<uint64_t>(m_[kSteps]); }
  std::span<const double> y() const { return {m_ + kHead, n_}; }

  void write(const CvodeRun& run, const double* y, uint64_t surroundings) {
    if (!m_) return;
    m_[kSteps] = static_cast<double>(run.steps());
    m_[kTime] = run.start().t, m_[kAim] = run.start().first_aim;
    m_[kLow] = low(surroundings), m_[kHigh] = high(surroundings);
    std::ranges::copy(run.start().y, m_ + kHead);
    std::copy_n(y, n_, m_ + kHead + n_);
  }

  enum : size_t { kSteps, kTime, kAim, kLow, kHigh, kHead };

 private:
  static double low(uint64_t s) { return static_cast<double>(s & 0xffffffffu); }
  static double high(uint64_t s) { return static_cast<double>(s >> 32); }

  double* m_;
  size_t n_;
};

// Makes `kept` the run that the journal refers to, or a new one from y on.
CvodeRun& resume(std::unique_ptr<CvodeRun>& kept, const Advance& a, CvodeMethod method,
                 const Journal& journal) {
  const size_t n = a.f.size();
  const bool goes_on = journal.ends_in(a.y, a.surroundings);
  CvodeRun::Start start{
      .method = method,
      .t = goes_on ? journal.t() : a.t,
      .first_aim = goes_on ? journal.first_aim() : a.t_end,
      .y = goes_on ? std::vector<double>(journal.y().begin(), journal.y().end())
                   : std::vector<double>(a.y, a.y + n),
      .relative = a.tolerance.relative,
      .absolute = a.tolerance.absolute,
      .absolute_each = {a.tolerance.absolute_each.begin(), a.tolerance.absolute_each.end()}};
  const uint64_t steps = goes_on ? journal.steps() : 0;
  if (kept && kept->start() == start && kept->surroundings() == a.surroundings && kept->steps() <= steps) {
    kept->bind(a.f);
  } else {
    kept = std::make_unique<CvodeRun>(std::move(start), a.f, a.surroundings);
  }
  while (kept->steps() < steps) kept->step();
  return *kept;
}

// The part of a step between two times.
class Piece final : public Interpolant {
 public:
  Piece(const CvodeRun& run, double t0, double t1) : run_(run), t0_(t0), t1_(t1) {}
  void at(double theta, double* y) const override { run_.at(std::lerp(t0_, t1_, theta), y); }

 private:
  const CvodeRun& run_;
  double t0_, t1_;
};

void advance(Advance& a, CvodeMethod method) {
  if (a.f.size() == 0) {
    a.reached = a.t_end;
    return;
  }
  Journal journal(a.memory, a.f.size());
  auto& kept = a.workspace.object<std::unique_ptr<CvodeRun>>("integrator.cvode");
  CvodeRun& run = resume(kept, a, method, journal);
  if (a.memory.empty()) run.stop_at(a.t_end);
  const Statistics before = run.work();
  const auto report = [&] {
    if (a.statistics) *a.statistics += run.work() - before;
  };
  // CVODE cannot resume what it has begun.
  const auto give_up = [&] {
    report();
    kept.reset();
  };
  double t = a.t;
  for (uint64_t taken = 0;;) {
    if (run.t1() <= t) {
      const double h = run.last_step();
      if (taken++ >= a.max_steps) {
        give_up();
        step_control::too_many_steps(a, t, h);
      }
      try {
        run.step();
      } catch (...) {
        give_up();
        throw;
      }
    }
    const double begin = std::max(t, run.t0());
    double end = std::min(run.t1(), a.t_end);
    run.at(end, a.y);
    auto verdict = StepWatcher::Verdict::go_on;
    if (a.watcher) verdict = a.watcher->accepted(begin, end, a.y, Piece(run, begin, end));
    t = end;
    if (t >= a.t_end || verdict == StepWatcher::Verdict::stop) break;
  }
  if (a.project) a.project(a.f, a.y);
  a.reached = t;
  a.carry.step = run.last_step();
  journal.write(run, a.y, a.surroundings);
  report();
}

}  // namespace

// Layout: steps, time and aim of the beginning, surroundings, y at the beginning, y that was left.
size_t cvode_memory(size_t n) {
  return Journal::kHead + 2 * n;
}

void prepare_cvode(const ForceField& field, State& state) {
  prepare_adaptive(field, state);
  add_memory(state,
             cvode_memory(state.f64(state.at("position")).size() + state.f64(state.at("velocity")).size()));
}

void advance_cvode_bdf(Advance& a) {
  advance(a, CvodeMethod::bdf);
}
void advance_cvode_adams(Advance& a) {
  advance(a, CvodeMethod::adams);
}

std::vector<double> reference_solution(const RightHandSide& f, double t, double t_end,
                                       std::span<const double> y, const Tolerance& tolerance) {
  std::vector<double> result(y.begin(), y.end());
  Workspace workspace;
  Carry carry;
  Advance a{.f = f,
            .t = t,
            .t_end = t_end,
            .y = result.data(),
            .workspace = workspace,
            .carry = carry,
            .tolerance = tolerance};
  advance_cvode_bdf(a);
  return result;
}

}  // namespace truestep
