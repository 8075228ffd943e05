#include "engine/studies/check/trial.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "engine/base/interrupt.h"
#include "engine/scene/admission.h"
#include "engine/session/commands.h"
#include "engine/session/describe.h"
#include "engine/session/snapshot/snapshot.h"
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

/// A command and the step before which it is carried out.
struct Due {
  uint64_t step;
  Command command;
};
std::vector<Due> read_commands(const std::vector<json::object>& documents, double dt) {
  std::vector<Due> out;
  for (json::object o : documents) {
    const double t = o.at("at_time").to_number<double>();
    o.erase("at_time");
    out.push_back({static_cast<uint64_t>(std::llround(std::max(0.0, t) / dt)), read_command(o)});
  }
  std::stable_sort(out.begin(), out.end(), [](const Due& a, const Due& b) { return a.step < b.step; });
  return out;
}

class Run {
 public:
  Run(const Trial& trial, Scene scene, TrialResult& out)
      : trial_(trial),
        out_(out),
        arena_(std::make_shared<const ThreadArena>(trial.threads)),
        expectations_(scene),
        commands_(read_commands(trial.commands, scene.header.time.dt)),
        steps_(static_cast<uint64_t>(std::llround(scene.header.time.duration / scene.header.time.dt))),
        scene_(std::move(scene)),
        session_(start()) {}

  void go() {
    const bool every = expectations_.needs_every_step();
    look();
    for (uint64_t n = 0; n < steps_; ++n) {
      interruption_point();
      if (trial_.resumed && n == (steps_ + 1) / 2) resume();
      for (; next_ < commands_.size() && commands_[next_].step <= n; ++next_)
        session_->command(commands_[next_].command);
      if (session_->step(1) == 0) break;
      if (every || n + 1 == steps_) look();
      if (trial_.sleepers) sleepers_.add(*session_, arena_);
    }
    session_->examine();
    if (session_->failure())
      out_.failure = session_->failure()->detail + " at " + std::to_string(session_->time()) + " s";
    const Observables last = session_->observe();
    for (const Observation& o : last.rows()) {
      if (!std::isfinite(o.value) && out_.not_finite.empty()) out_.not_finite = o.name;
    }
    out_.verdicts = expectations_.verdicts();
    out_.hash = session_->hash();
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
  std::vector<Due> commands_;
  uint64_t steps_;
  Scene scene_;
  std::unique_ptr<Session> session_;
  size_t next_ = 0;
  Sleepers sleepers_;
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
    out.refused = e.issues();
    if (out.refused.empty()) out.refused.push_back({"", e.code(), e.what(), "", "", "", ""});
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
