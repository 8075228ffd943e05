#include "engine/studies/check/trial.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

#include "engine/base/hash.h"
#include "engine/base/interrupt.h"
#include "engine/scene/admission.h"
#include "engine/session/commands.h"
#include "engine/session/describe.h"
#include "engine/session/snapshot/snapshot.h"
#include "engine/studies/check/refusals.h"
#include "engine/studies/check/sleepers.h"
#include "engine/studies/precision/accuracy.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr double kAccuracySeconds = 2;  // CPU time for choosing a method

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Indices of commands in the order of their times.
std::vector<size_t> in_order(const std::vector<TestCommand>& commands) {
  std::vector<size_t> out(commands.size());
  std::iota(out.begin(), out.end(), size_t{0});
  std::stable_sort(out.begin(), out.end(),
                   [&](size_t a, size_t b) { return commands[a].at_time < commands[b].at_time; });
  return out;
}

class Run {
 public:
  Run(const Trial& trial, Scene scene, TrialResult& out)
      : trial_(trial),
        out_(out),
        arena_(std::make_shared<const ThreadArena>(trial.threads)),
        expectations_(scene),
        commands_(in_order(trial.commands)),
        steps_(static_cast<uint64_t>(std::llround(scene.header.time.duration / scene.header.time.dt))),
        scene_(std::move(scene)),
        session_(start()) {}

  void go() {
    const bool every = expectations_.needs_every_step();
    look_at_plan();
    look();
    for (uint64_t n = 0; n < steps_; ++n) {
      interruption_point();
      if (trial_.resumed && n == (steps_ + 1) / 2) resume();
      for (; next_ < commands_.size() && step_of(commands_[next_]) <= n; ++next_) carry_out(commands_[next_]);
      if (trial_.drops_scratch) session_->drop_workspace();
      if (session_->step(1) == 0) break;
      if (trial_.compared) states_.integer(session_->hash());
      if (every || n + 1 == steps_) look();
      if (trial_.sleepers) sleepers_.add(*session_, arena_);
    }
    if (!session_->failure()) {
      for (; next_ < commands_.size(); ++next_)
        out_.commands.push_back("command " + std::to_string(commands_[next_]) + " comes after the end");
    }
    session_->examine();
    if (session_->failure())
      out_.failure = session_->failure()->detail + " at " + std::to_string(session_->time()) + " s";
    const Observables last = session_->observe();
    for (const Observation& o : last.rows()) {
      if (!std::isfinite(o.value) && out_.not_finite.empty()) out_.not_finite = o.name;
    }
    out_.verdicts = expectations_.verdicts();
    out_.hash = trial_.compared ? states_.value() : session_->hash();
    out_.steps = session_->step_index();
    out_.moved = sleepers_.moved(), out_.moved_at = sleepers_.at();
  }

 private:
  std::unique_ptr<Session> start() const {
    return std::make_unique<Session>(std::make_shared<const World>(scene_), arena_,
                                     SessionOptions{.history_bytes = 0});
  }

  /// Continues in a new session of a world built anew, from the bytes of a snapshot.
  void resume() {
    const auto bytes = write_snapshot(session_->world(), session_->state());
    auto next = start();
    next->restore(read_snapshot(next->world(), bytes));
    session_ = std::move(next);
  }

  /// The step before which a command is carried out.
  uint64_t step_of(size_t command) const {
    const double t = std::max(0.0, trial_.commands[command].at_time);
    return static_cast<uint64_t>(std::llround(t / scene_.header.time.dt));
  }

  void carry_out(size_t index) {
    const TestCommand& c = trial_.commands[index];
    const std::string name = "command " + std::to_string(index) + ' ';
    try {
      session_->command(read_command_for(session_->world(), session_->state(), c.command));
    } catch (const Error& e) {
      if (!c.refused) throw;
      const std::vector<Issue> faults = faults_of(e);
      const auto other = other_fault(faults, *c.refused);
      if (other) out_.commands.push_back(name + "is refused for " + described(*other));
      return;
    }
    if (c.refused) out_.commands.push_back(name + "is carried out");
  }

  void look_at_plan() {
    for (const NamedText& wanted : trial_.plan) {
      std::string found = "no such stage runs";
      for (const World::PlanEntry& e : session_->world().plan()) {
        if (e.row.status != PlanRow::Status::runs) continue;
        if (e.row.name != wanted.name && e.system + '.' + e.row.name != wanted.name) continue;
        found = e.row.reason;
        if (found.find(wanted.text) != std::string::npos) break;
      }
      if (found.find(wanted.text) == std::string::npos)
        out_.plan.push_back(wanted.name + ": " + found + ", wanted " + wanted.text);
    }
  }

  void look() {
    const Observables seen =
        session_->observe([this](std::string_view name) { return expectations_.wants(name); });
    for (const Observation& o : seen.rows()) {
      if (!std::isfinite(o.value) && out_.not_finite.empty()) out_.not_finite = o.name;
    }
    expectations_.add(seen, session_->time());
  }

  const Trial& trial_;
  TrialResult& out_;
  std::shared_ptr<const ThreadArena> arena_;
  Expectations expectations_;
  std::vector<size_t> commands_;
  uint64_t steps_;
  Scene scene_;
  std::unique_ptr<Session> session_;
  size_t next_ = 0;
  Sleepers sleepers_;
  Hasher states_;
};

}  // namespace

TrialResult run_trial(const Trial& trial) {
  TrialResult out;
  const double begun = cpu_seconds();
  try {
    require_admission(estimate(require_scene(examine_scene(trial.document, kOwnMachine))), kOwnMachine);
    const ThreadArena alone(1);
    Scene scene = settle_accuracy(trial.document, kAccuracySeconds, alone).scene;
    Run(trial, std::move(scene), out).go();
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& e) {
    out.refusal = e.what();
    out.refused = faults_of(e);
  }
  out.cpu_seconds = cpu_seconds() - begun;
  return out;
}

double estimated_seconds(const Trial& trial) {
  const SceneReport report = read_scene(trial.document);
  if (!report.scene) return 0;
  const TimeParams& time = report.scene->header.time;
  return estimate(*report.scene).seconds_per_step * time.duration / time.dt;
}

}  // namespace truestep
