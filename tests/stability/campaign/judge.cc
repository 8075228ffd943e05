// Runs a trial through a session, as every scene runs, and checks it after every step.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>

#include "engine/base/errors.h"
#include "engine/base/parallel.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/expectation.h"
#include "engine/session/session.h"
#include "tests/stability/campaign/campaign.h"

namespace truestep::campaign {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

/// Energies and total momenta along a run.
class Watch {
 public:
  void add(const Observables& seen) {
    for (const Observation& o : seen.rows()) {
      if (!std::isfinite(o.value) && not_finite_.empty()) not_finite_ = o.name;
    }
    const auto total = seen.find("energy.total"), potential = seen.find("energy.potential");
    if (total && potential) {
      if (!first_) first_ = total, kinetic_ = *total - *potential, lowest_ = *potential;
      if (!first_potential_) first_potential_ = potential;
      lowest_ = std::min(lowest_, *potential);
      most_ = std::max(most_, *total - *first_), least_ = std::min(least_, *total - *first_);
    }
    std::map<std::string, double> sums;
    for (const Observation& o : seen.rows()) {
      if (o.name.find("momentum") == std::string::npos) continue;
      sums[o.name.substr(o.name.find('.') + 1)] += o.value;
    }
    for (const auto& [name, value] : sums) {
      const double start = starts_.try_emplace(name, value).first->second;
      double& change = changes_[name];
      change = std::max(change, std::abs(value - start));
    }
  }

  void judge(const Rules& r, std::vector<Finding>& out) const {
    if (!not_finite_.empty()) out.push_back({"not_finite", not_finite_});
    if (first_) {
      // The potential may include the stored energy, which then shows at the start.
      const double unseen = *first_potential_ > 0.5 * r.stored ? 0 : r.stored;
      const double work = kinetic_ + (*first_potential_ - lowest_) + unseen + r.drives;
      const std::string of_work = " J beside " + number(work) + " J at work";
      const double allowed = unseen + r.drives;
      // Poses are rounded; a body at rest has no energy at work to compare that with.
      const double rounding = 1e-12 + 1e-9 * std::abs(*first_potential_);
      if (r.gain && most_ > allowed + *r.gain * work + rounding)
        out.push_back({"energy", "gains " + number(most_ - allowed) + of_work});
      if (r.loss && -least_ > *r.loss * work + rounding)
        out.push_back({"loss", "loses " + number(-least_) + of_work});
    }
    for (const auto& [name, change] : changes_) {
      const bool turning = name.find("angular") != std::string::npos;
      const auto& bound = turning ? r.angular_momentum : r.momentum;
      if (bound && !(change <= *bound))
        out.push_back({"momentum", name + " changes by " + number(change) + ", allowed " + number(*bound)});
    }
  }

 private:
  std::string not_finite_;
  std::optional<double> first_, first_potential_;
  double kinetic_ = 0, lowest_ = 0, most_ = 0, least_ = 0;
  std::map<std::string, double> starts_, changes_;
};

/// Values of a field of a system; empty if it has no such field.
std::vector<double> values(const Session& s, size_t system, const char* name) {
  const System& of = s.world().system(system);
  const auto at = of.find_field(name);
  if (!at) return {};
  std::vector<double> scratch;
  const FieldView v = of.field(s.state().systems[system], at->part, at->field, scratch);
  std::vector<double> out(v.rows * v.width);
  for (size_t i = 0; i < out.size(); ++i) out[i] = element(v, i);
  return out;
}

/// How far sleeping bodies deviate within 0.4 s from what they do once they are woken: what rests stays in
/// place, and what something else hits in the meantime is carried along, asleep or not. The time is shorter
/// than the default time after which they may sleep again.
double moved_when_woken(const Session& now, const std::shared_ptr<const ThreadArena>& arena) {
  const auto world = std::shared_ptr<const World>(&now.world(), [](const World*) {});
  Session woken(world, arena, {.history_bytes = 0}), left(world, arena, {.history_bytes = 0});
  woken.restore(now.state()), left.restore(now.state());
  const std::vector<double> asleep = values(now, 0, "asleep");
  for (size_t i = 0; i < asleep.size(); ++i) {
    if (asleep[i] == 0) continue;
    Command c;
    c.kind = CommandKind::impulse, c.system = now.world().id(0), c.index = static_cast<int64_t>(i);
    try {
      woken.command(c);
    } catch (const Error&) {  // a body that does not respond to forces
    }
  }
  double most = 0;
  const auto steps = static_cast<int>(std::max(1.0, std::floor(0.4 / now.world().dt())));
  std::vector<uint8_t> sleeps(asleep.size());
  for (size_t i = 0; i < asleep.size(); ++i) sleeps[i] = asleep[i] != 0;
  for (int k = 0; k < steps; ++k) {
    woken.step(1), left.step(1);
    const std::vector<double> still = values(left, 0, "asleep");
    const std::vector<double> x = values(woken, 0, "position"), y = values(left, 0, "position");
    for (size_t i = 0; i < asleep.size(); ++i) {
      sleeps[i] = sleeps[i] && still[i] != 0;
      if (sleeps[i]) most = std::max(most, norm(load3(x.data(), i) - load3(y.data(), i)));
    }
  }
  return most;
}

/// Checks sleeping bodies a few times per run, whenever more of them sleep than before.
class SleepWatch {
 public:
  void add(const Session& s, const std::shared_ptr<const ThreadArena>& arena) {
    size_t asleep = 0;
    for (const double a : values(s, 0, "asleep")) asleep += a != 0;
    if (asleep > before_ && looks_ < 4) {
      ++looks_;
      const double moved = moved_when_woken(s, arena);
      if (moved > most_) most_ = moved, at_ = s.time();
    }
    before_ = asleep;
  }
  void judge(double still, std::vector<Finding>& out) const {
    if (most_ > still)
      out.push_back({"asleep", "what slept at " + number(at_) + " s moves by " + number(most_) +
                                   " m in 0.4 s once woken"});
  }

 private:
  size_t before_ = 0, looks_ = 0;
  double most_ = 0, at_ = 0;
};

void run(const Trial& t, Outcome& out) {
  const auto arena = std::make_shared<const ThreadArena>(1);
  // As text, the way every scene comes in.
  Scene scene = parse_scene(write_json(t.scene));
  const double dt = scene.header.time.dt;
  const auto steps = static_cast<uint64_t>(std::llround(scene.header.time.duration / dt));
  Expectations expectations(scene);
  Session session(std::make_shared<const World>(std::move(scene)), arena, {.history_bytes = 0});
  Watch watch;
  SleepWatch sleepers;
  const auto look = [&] {
    const Observables seen = session.observe();
    watch.add(seen), expectations.add(seen);
    if (t.rules.still) sleepers.add(session, arena);
  };
  look();
  for (uint64_t k = 0; k < steps && session.step(1); ++k) look();
  if (const auto& failure = session.failure()) {
    // The event is the expected answer: what came before it is not judged further.
    const std::string what = failure->detail + " at " + number(session.time()) + " s";
    if (t.rules.event == Rules::Event::allowed) {
      out.event = what;
    } else {
      out.findings.push_back({"event", what});
    }
    return;
  }
  watch.judge(t.rules, out.findings);
  if (t.rules.still) sleepers.judge(*t.rules.still, out.findings);
  for (const Verdict& v : expectations.verdicts()) {
    if (v.met) continue;
    out.findings.push_back({"expect", v.expected.quantity + " is " +
                                          (v.measured ? number(*v.measured) : "nothing") + ": " +
                                          v.expected.source});
  }
}

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

Outcome judge(const Trial& trial) {
  Outcome out;
  const double start = cpu_seconds();
  try {
    run(trial, out);
  } catch (const Error& e) {
    std::string what = e.what();
    for (const Issue& i : e.issues()) what += "; " + i.pointer + ": " + i.message;
    out.findings.push_back({"invalid", what});
  }
  out.cpu_seconds = cpu_seconds() - start;
  return out;
}

std::string report(const Trial& trial, const Outcome& outcome) {
  std::string text;
  for (const Finding& f : outcome.findings)
    text += trial.family + ", seed " + std::to_string(trial.seed) + ": " + f.kind + ": " + f.detail + '\n';
  return text;
}

}  // namespace truestep::campaign
