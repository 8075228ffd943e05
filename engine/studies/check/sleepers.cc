#include "engine/studies/check/sleepers.h"

#include <algorithm>
#include <cmath>

namespace truestep {

namespace {

constexpr double kWatched = 0.4;  // s, less than the default time after which rows may sleep again
constexpr size_t kMostLooks = 4;

/// Values of a field of the first system; empty if it has no such field.
std::vector<double> values(const Session& s, const char* name) {
  const System& of = s.world().system(0);
  const auto at = of.find_field(name);
  if (!at) return {};
  std::vector<double> scratch;
  const FieldView v = of.field(s.state().systems[0], at->part, at->field, scratch);
  std::vector<double> out(v.rows * v.width);
  for (size_t i = 0; i < out.size(); ++i) out[i] = element(v, i);
  return out;
}

/// How far sleeping rows deviate from what they do once they are woken: what rests stays in place, and what
/// something else hits in the meantime is carried along, asleep or not.
double moved_when_woken(const Session& now, const std::shared_ptr<const ThreadArena>& arena) {
  Session woken(now.shared_world(), arena, {.history_bytes = 0}),
      left(now.shared_world(), arena, {.history_bytes = 0});
  woken.restore(now.state()), left.restore(now.state());
  const std::vector<double> asleep = values(now, "asleep");
  for (size_t i = 0; i < asleep.size(); ++i) {
    if (asleep[i] == 0) continue;
    Command c;
    c.kind = CommandKind::impulse, c.system = now.world().id(0), c.index = static_cast<int64_t>(i);
    try {
      woken.command(c);
    } catch (const Error&) {  // a row that does not respond to forces
    }
  }
  double most = 0;
  const auto steps = static_cast<int>(std::max(1.0, std::floor(kWatched / now.world().dt())));
  std::vector<uint8_t> sleeps(asleep.size());
  for (size_t i = 0; i < asleep.size(); ++i) sleeps[i] = asleep[i] != 0;
  for (int k = 0; k < steps; ++k) {
    woken.step(1), left.step(1);
    const std::vector<double> still = values(left, "asleep");
    const std::vector<double> x = values(woken, "position"), y = values(left, "position");
    for (size_t i = 0; i < asleep.size(); ++i) {
      sleeps[i] = sleeps[i] && still[i] != 0;
      if (sleeps[i]) most = std::max(most, norm(load3(x.data(), i) - load3(y.data(), i)));
    }
  }
  return most;
}

}  // namespace

void Sleepers::add(const Session& session, const std::shared_ptr<const ThreadArena>& arena) {
  size_t asleep = 0;
  for (const double a : values(session, "asleep")) asleep += a != 0;
  if (asleep > before_ && looks_ < kMostLooks) {
    ++looks_;
    const double moved = moved_when_woken(session, arena);
    if (moved > most_) most_ = moved, at_ = session.time();
  }
  before_ = asleep;
}

}  // namespace truestep
