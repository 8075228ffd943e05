// One course: random deeds on a session, compared after each with what the same steps gave before.
#include <algorithm>
#include <map>

#include "engine/base/errors.h"
#include "engine/base/hash.h"
#include "engine/base/interrupt.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/commands.h"
#include "engine/session/snapshot/bundle.h"
#include "engine/session/snapshot/snapshot.h"
#include "tests/determinism/campaign/course.h"
#include "tests/stability/campaign/dice.h"

namespace truestep {

namespace {

using campaign::Dice;

constexpr uint64_t kStream = 16;
constexpr uint64_t kAhead = 6;  // steps that a seek may lead forward
constexpr int kLeastDeeds = 8, kMostDeeds = 28;

Command random_command(Dice& dice, const CourseScene& scene) {
  const auto& taker =
      scene.takers[static_cast<size_t>(dice.whole(0, static_cast<int>(scene.takers.size()) - 1))];
  Command c;
  c.kind = static_cast<CommandKind>(dice.whole(0, static_cast<int>(CommandKind::remove)));
  c.system = taker.system;
  // Rows that are there, mostly the first ones, and a few that are not.
  const int rows = static_cast<int>(std::min<size_t>(taker.rows, 1000));
  c.index = dice.chance(0.7) ? dice.whole(0, std::min(rows, 6)) : dice.whole(0, rows + 1);
  if (c.kind == CommandKind::release && dice.chance(0.3)) c.index = -1;
  c.vector = dice.spread(1e-3, 10) * dice.direction();
  if (c.kind == CommandKind::spawn) c.velocity = dice.in_cube(1);
  if (c.kind == CommandKind::push && dice.chance(0.6)) c.duration = dice.spread(1e-3, 1);
  if (c.kind == CommandKind::drag && dice.chance(0.5)) c.value = dice.spread(0.1, 100);
  if (c.kind <= CommandKind::drag && dice.chance(0.4)) c.at = dice.in_cube(0.5);
  if (c.kind == CommandKind::set_parameter) {
    c.name = taker.parameters.empty() ? "?"
                                      : taker.parameters[static_cast<size_t>(
                                            dice.whole(0, static_cast<int>(taker.parameters.size()) - 1))];
    c.value = dice.spread(1e-2, 10) * (dice.chance(0.2) ? -1 : 1);
  }
  return c;
}

class Walk {
 public:
  Walk(const CourseScene& scene, uint64_t seed, const CourseThreads& threads, Course& course)
      : scene_(scene), threads_(threads), dice_(seed, kStream), course_(course) {
    options_.history_bytes =
        dice_.of({size_t{0}, 4 * scene.world->initial_state().memory_bytes(), size_t{32} << 20});
    options_.journal_entries = dice_.of({size_t{6}, size_t{65536}});
    session_ = std::make_unique<Session>(scene.world, threads.one, options_);
    stand();
  }

  void run() {
    const int deeds = dice_.whole(kLeastDeeds, kMostDeeds);
    for (int n = 0; n < deeds; ++n) {
      const double dice = dice_.unit();
      if (dice < 0.30) {
        steps();
      } else if (dice < 0.62) {
        command();
      } else if (dice < 0.80) {
        seek();
      } else if (dice < 0.84) {
        snapshot();
      } else if (dice < 0.89) {
        restore();
      } else if (dice < 0.93) {
        branch();
      } else if (dice < 0.95) {
        stop_a_step();
      } else if (dice < 0.97) {
        look_back();
      } else if (dice < 0.98) {
        reset();
      } else {
        repeat();
      }
      if (!course_.fault.empty()) return;
    }
    repeat();
  }

 private:
  void deed(const std::string& what) { course_.deeds.push_back(what); }
  void differ(const std::string& why) {
    if (course_.fault.empty()) course_.fault = why;
  }
  void expect(const char* what, uint64_t step, uint64_t expected, uint64_t found) {
    if (expected != found)
      differ(std::string(what) + " at step " + std::to_string(step) + ": " + hex64(found) + ", not " +
             hex64(expected));
  }

  // The session is at a step for the first time, or again: before the step's commands.
  void stand() {
    const uint64_t step = session_->step_index(), hash = session_->hash();
    const auto [it, fresh] = arrived_.try_emplace(step, hash);
    if (!fresh) return expect("a step that is repeated", step, it->second, hash);
    // Commands that a seek went back from are carried out with the next step: the state that they leave is
    // known from when they were given.
    const auto due = session_->journal_ahead();
    if (due.empty() || due.front().step > step) left_[step] = hash;
  }
  void forget(uint64_t from) {
    arrived_.erase(arrived_.lower_bound(from), arrived_.end());
    left_.erase(left_.lower_bound(from), left_.end());
  }

  void step_to(uint64_t step) {
    while (session_->step_index() < step && !session_->failure()) {
      if (dice_.chance(0.2)) {
        session_->begin_aside();
        session_->compute_aside();
        if (session_->commit_aside(Session::Output::aloud) != StepOutcome::done) return;
      } else if (session_->step(1) == 0) {
        return;
      }
      stand();
    }
  }
  void steps() {
    const uint64_t n = static_cast<uint64_t>(dice_.of({1, 2, 5, 11, 17}));
    deed("step " + std::to_string(n));
    if (dice_.chance(0.1)) session_->drop_workspace();
    step_to(session_->step_index() + n);
  }

  void command() {
    // As a client can say it.
    const Command c = read_command(write_command(random_command(dice_, scene_)));
    const uint64_t step = session_->step_index();
    // What waits at this step is carried out first, and counts whatever becomes of the command.
    session_->carry_out_due_commands();
    const uint64_t before = session_->hash();
    deed("at " + std::to_string(step) + " " + write_json(write_command(c)));
    try {
      session_->command(c);
      ++course_.commands;
      forget(step + 1);
      left_[step] = session_->hash();
    } catch (const Error& e) {
      ++course_.refused;
      course_.deeds.back() += " (refused: " + std::string(e.what()) + ")";
      expect("a refused command changed the state", step, before, session_->state().hash());
    }
  }

  void seek() {
    ++course_.seeks;
    const uint64_t first = session_->first_step();
    const uint64_t last =
        std::max(session_->step_index(), left_.empty() ? 0 : left_.rbegin()->first) + kAhead;
    const uint64_t to = first + static_cast<uint64_t>(dice_.unit() * static_cast<double>(last - first));
    deed("seek " + std::to_string(to));
    session_->seek(to);
    if (session_->failure()) return;
    const uint64_t hash = session_->hash();
    const auto [it, fresh] = left_.try_emplace(to, hash);
    expect("a seek", to, it->second, hash);
    // Steps between are unknown where the seek led further than ever before.
  }

  void snapshot() {
    deed("snapshot at " + std::to_string(session_->step_index()));
    kept_.push_back(
        {write_snapshot(session_->world(), session_->state()), session_->step_index(), session_->hash()});
  }

  void restore() {
    if (kept_.empty()) return snapshot();
    ++course_.restores;
    const Kept& k = kept_[static_cast<size_t>(dice_.whole(0, static_cast<int>(kept_.size()) - 1))];
    deed("restore step " + std::to_string(k.step));
    session_->restore(read_snapshot(session_->world(), k.bytes));
    expect("a restored snapshot", k.step, k.hash, session_->hash());
    begin_anew();
  }

  // A session that goes on from this one's state, on other threads, for some steps and commands.
  void branch() {
    ++course_.branches;
    deed("branch at " + std::to_string(session_->step_index()));
    Session other(scene_.world, threads_.many, options_);
    session_->carry_out_due_commands();
    other.restore(session_->state());
    // It knows nothing of commands that this session's future holds.
    const bool same_future = session_->journal_ahead().empty();
    const uint64_t last = session_->step_index() + kAhead;
    while (other.step_index() < last && !other.failure()) {
      if (other.step(1) == 0) break;
      const auto known = arrived_.find(other.step_index());
      if (same_future && known != arrived_.end())
        expect("a branch", other.step_index(), known->second, other.hash());
    }
    step_to(session_->failure() ? 0 : last);
    if (same_future && !session_->failure() && session_->step_index() == other.step_index())
      expect("a branch", last, session_->hash(), other.hash());
  }

  void stop_a_step() {
    if (session_->failure()) return;
    deed("a step at " + std::to_string(session_->step_index()) + " is interrupted");
    session_->carry_out_due_commands();
    const uint64_t before = session_->hash();
    Interrupt interrupt;
    interrupt.raise();
    const InterruptScope scope(interrupt);
    const StepOutcome outcome = session_->step_in_place(Session::Output::aloud);
    if (outcome == StepOutcome::interrupted)
      expect("an interrupted step", session_->step_index(), before, session_->hash());
    if (outcome == StepOutcome::unstable) {
      session_->compute_aside();
      session_->commit_aside(Session::Output::aloud);
    } else if (outcome == StepOutcome::done) {
      stand();
    }
  }

  void look_back() {
    const uint64_t first = session_->first_step(), now = session_->step_index();
    if (now == first) return;
    const uint64_t step = first + static_cast<uint64_t>(dice_.unit() * static_cast<double>(now - first));
    deed("look back at " + std::to_string(step));
    const uint64_t hash = session_->state_at(step).hash();
    const auto it = left_.find(step);
    if (it != left_.end()) expect("an earlier state", step, it->second, hash);
  }

  void reset() {
    deed("reset");
    session_->reset();
    begin_anew();
  }
  void begin_anew() {
    forget(0);
    stand();
  }

  // The bundle, on other threads.
  void repeat() {
    if (session_->failure()) return;
    deed("bundle at " + std::to_string(session_->step_index()));
    course_.bundle = write_bundle(bundle_of(*session_));
    const Bundle bundle = read_bundle(course_.bundle);
    const ReplayResult r = replay(bundle, threads_.many);
    if (r.difference) expect("the bundle", r.difference->step, r.difference->expected, r.difference->found);
  }

  struct Kept {
    Bytes bytes;
    uint64_t step, hash;
  };
  const CourseScene& scene_;
  const CourseThreads& threads_;
  Dice dice_;
  Course& course_;
  SessionOptions options_;
  std::unique_ptr<Session> session_;
  std::map<uint64_t, uint64_t> arrived_, left_;  ///< hashes by step: before its commands, and after them
  std::vector<Kept> kept_;
};

}  // namespace

Course run_course(const CourseScene& scene, uint64_t seed, const CourseThreads& threads) {
  Course course{.scene = scene.name, .seed = seed};
  try {
    Walk(scene, seed, threads, course).run();
  } catch (const std::exception& e) {
    course.fault = std::string("error: ") + e.what();
  }
  return course;
}

}  // namespace truestep
