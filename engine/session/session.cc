#include "engine/session/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"

namespace truestep {

namespace {

// Energies and probes are always kept. Observables named by the scene are kept at every step.
Series series_of(const Scene& scene) {
  constexpr size_t kUnasked = 2048;
  const SceneHeader& header = scene.header;
  std::vector<std::string> wanted = header.observables;
  wanted.emplace_back("energy");
  for (const ProbeParams& p : header.probes) wanted.push_back(p.id);
  if (!header.observables.empty()) return Series(std::move(wanted));
  if (scene.systems.size() > 1) {  // to be compared
    for (const SceneSystem& one : scene.systems) {
      for (const char* kind : {".energy.kinetic", ".energy.total"}) wanted.push_back(one.id + kind);
    }
  }
  return Series(std::move(wanted), Series::Rate::sparing, kUnasked);
}

}  // namespace

Session::Session(std::shared_ptr<const World> world, std::shared_ptr<const ThreadArena> arena,
                 SessionOptions options)
    : world_(std::move(world)),
      arena_(std::move(arena)),
      options_(options),
      state_(world_->initial_state()),
      frames_(world_),
      history_(options.history_bytes, options.history_room),
      falls_(*world_, state_),
      series_(series_of(world_->scene())) {
  world_->require_finite_energy(state_);
  record_series();
}

uint64_t Session::step(uint64_t n) {
  if (failure_) throw Error("instability", failure_->detail);
  uint64_t done = 0;
  while (done < n && one_step()) ++done;
  return done;
}

void Session::examine() {
  if (failure_) return;
  collect_warnings(Output::aloud);
  try {
    world_->examine(state_, workspace_, *arena_);
  } catch (const Instability& e) {
    Failure failure = diagnose(e);
    const InterruptScope undisturbed(nullptr);
    state_ = replayed(failure.last_good_step);
    changed();
    fail(std::move(failure));
  }
}

// For an owner without readers that wait.
bool Session::one_step() {
  StepOutcome outcome = step_in_place(Output::aloud);
  if (outcome == StepOutcome::unstable) {
    compute_aside();
    outcome = commit_aside(Output::aloud);
  }
  if (outcome == StepOutcome::interrupted) throw Interrupted();
  return outcome == StepOutcome::done;
}

// --- the clock

void Session::play(double speed) {
  if (!(speed >= kLeastSpeed && speed <= kMostSpeed)) {
    throw Error(
        "bad_request", "speed must be a number from 1e-18 to 1e15",
        {"/speed", "out_of_range", "the value is outside the allowed range", "", "1e-18 to 1e15", "", "1"});
  }
  if (failure_) throw Error("instability", failure_->detail);
  if (!playing_ || speed != speed_) pace_ = {}, achieved_speed_.reset();
  if (!playing_) accumulator_ = 0;
  playing_ = true;
  speed_ = speed;
  notify("playback", "");
}

void Session::pause() {
  playing_ = false;
  notify("playback", "");
}

uint64_t Session::accrue(double wall_seconds) {
  if (!playing_ || failure_) return 0;
  accumulator_ += std::max(wall_seconds, 0.0) * speed_;
  const double dt = world_->dt();
  const auto owed = static_cast<uint64_t>(std::min(accumulator_ / dt, 1e15));
  // The steps of a sixtieth of a second never count as "late", however small dt is.
  const double display = std::ceil(speed_ / (60 * dt));
  const double most = std::max(static_cast<double>(world_->scene().header.time.max_catchup_steps), display);
  const auto bound = static_cast<uint64_t>(std::min(most, 1e15));
  const uint64_t due = std::min(owed, bound);
  // Time beyond the bound is dropped, not saved: a late session must not fall further behind.
  skip(owed - due);
  pace_.wall += std::max(wall_seconds, 0.0);
  pace_.wanted += std::max(wall_seconds, 0.0) * speed_;
  if (constexpr double kLook = 0.5; pace_.wall >= kLook) {
    // Steps that are due now are still to be done: they count next time.
    const double pending = static_cast<double>(due) * dt;
    achieved_speed_ = std::max(0.0, pace_.pending + pace_.wanted - pace_.skipped - pending) / pace_.wall;
    pace_ = {.pending = pending};
  }
  accumulator_ = std::max(0.0, accumulator_ - static_cast<double>(owed) * dt);
  return due;
}

void Session::skip(uint64_t steps) {
  skipped_ += steps;
  pace_.skipped += static_cast<double>(steps) * world_->dt();
}

uint64_t Session::advance(double wall_seconds) {
  const uint64_t due = accrue(wall_seconds);
  uint64_t done = 0;
  while (done < due && one_step()) ++done;
  return done;
}

// --- output

void Session::add_sink(std::shared_ptr<Sink> sink) {
  sinks_.push_back(std::move(sink));
}

void Session::remove_sink(const Sink* sink) {
  std::erase_if(sinks_, [&](const auto& s) { return s.get() == sink; });
}

void Session::collect_warnings(Output output) {
  auto all = world_->warnings(state_);
  falls_.warn(*world_, state_, all);
  for (World::SystemWarning& found : all) {
    const std::string& id = world_->id(found.system);
    const auto known = std::ranges::find_if(warnings_, [&](const SessionWarning& w) {
      return w.system == id && w.warning.quantity == found.warning.quantity;
    });
    if (known == warnings_.end()) {
      warnings_.push_back({id, std::move(found.warning), state_.step});
      if (output == Output::aloud)
        notify("warning", "system \"" + id + "\": " + warnings_.back().warning.detail);
    } else if (std::abs(found.warning.value) > std::abs(known->warning.value)) {
      known->warning = std::move(found.warning);
    }
  }
}

void Session::notify(std::string_view kind, const std::string& detail) {
  for (const auto& sink : sinks_) sink->notify(kind, state_.step, detail);
}

FramePtr Session::frame(const FrameRequest& request) const {
  return frames_.build(state_, alpha(), request);
}

uint64_t Session::hash() const {
  if (!hash_) hash_ = state_.hash();
  return *hash_;
}

void Session::record_series() {
  if (!series_.due(state_.step)) return;
  const auto begun = std::chrono::steady_clock::now();
  series_.add(state_.step, observe([this](std::string_view name) { return series_.wants(name); }));
  const auto ended = std::chrono::steady_clock::now();
  const auto seconds = [](std::chrono::steady_clock::duration d) {
    return std::chrono::duration<double>(d).count();
  };
  series_.spent(seconds(ended - begun), seconds(begun - observed_));
  observed_ = ended;
}

double Session::most_series_bytes(const World& world) {
  return static_cast<double>(series_of(world.scene()).most_bytes(world.known_observables()));
}

size_t Session::overhead_bytes() const {
  return sizeof(*this) + history_.memory_bytes() + series_.memory_bytes() +
         (aside_ || next_.systems.empty() ? 0 : next_.memory_bytes()) +
         journal_.capacity() * sizeof(JournalEntry) + (origin_ ? origin_->memory_bytes() : 0);
}

}  // namespace truestep
