// A session: a running world. Fixed-dt accumulator, command queue and journal, sinks, and a history of
// snapshots for exact seeking. One thread at a time may use it; only `post` may be called from any thread,
// and readers may read while another thread is in `compute_aside`.
#pragma once
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/base/errors.h"
#include "engine/session/holding.h"
#include "engine/session/series.h"
#include "engine/session/snapshot/history.h"
#include "engine/session/world/frame_builder.h"
#include "engine/session/world/world.h"

namespace truestep {

struct SessionOptions {
  size_t history_bytes = 32 << 20;  ///< bound on all snapshots kept for seeking
  History::Room history_room = {};  ///< asked before a snapshot is taken
  size_t journal_entries = 65536;   ///< beyond this many commands, the reachable past gets shorter
};

/// A command as carried out: before the step from `step` to `step + 1`, in the order of `sequence`.
struct JournalEntry {
  uint64_t step = 0;
  uint64_t sequence = 0;
  Command command;
};

/// Why a session cannot continue.
struct Failure {
  std::string system, quantity, detail;
  long long index = -1;
  uint64_t last_good_step = 0, step = 0;  ///< `step` is the one that failed
  double time = 0;                        ///< s, at the end of the failed step
  std::optional<double> suggested_dt;     ///< s, a step that was tried and stable
  std::vector<std::string> remedies;      ///< what helped when tried, one sentence each
};

/// A result that is not to be trusted though nothing has failed.
struct SessionWarning {
  std::string system;
  Warning warning;          ///< the worst so far of its quantity
  uint64_t first_step = 0;  ///< that it was seen at
};

/// What became of a step.
enum class StepOutcome : uint8_t {
  done,
  failed,      ///< the session has failed and stays at its last good step
  unstable,    ///< the step failed; compute_aside finds out why and what would have worked
  interrupted  ///< its thread's Interrupt was raised; the session stays where it was
};

/// How to get from a kept state to a later step of the same run, without the session.
struct Past {
  std::shared_ptr<const World> world;
  std::shared_ptr<const ThreadArena> arena;
  WorldState start;
  std::vector<JournalEntry> commands;  ///< from the start state on
  uint64_t step = 0;

  WorldState compute() const;
};

class Session {
 public:
  Session(std::shared_ptr<const World> world, std::shared_ptr<const ThreadArena> arena,
          SessionOptions options = {});

  const World& world() const { return *world_; }
  const std::shared_ptr<const World>& shared_world() const { return world_; }
  const WorldState& state() const { return state_; }
  uint64_t step_index() const { return state_.step; }
  double time() const { return static_cast<double>(state_.step) * world_->dt(); }
  uint64_t hash() const;

  /// Carries out waiting commands, then up to n steps, with frames to the sinks that are due. Returns the
  /// number of steps done: fewer only after a failure. Error "instability" when the session has already
  /// failed.
  uint64_t step(uint64_t n);

  // --- steps in parts, for owners that lock the session and have readers that must not wait for a step
  /// Sinks see steps that are aloud; steps that repeat the past on the way to another step are silent.
  enum class Output : uint8_t { aloud, silent };
  /// One step in place, during which nobody may read the session: `done`, `unstable` or `interrupted`.
  StepOutcome step_in_place(Output output);
  /// Carries out waiting commands and prepares a step in a second state (or, after `unstable`, the search for
  /// remedies). From here to commit_aside the session may only be read.
  void begin_aside();
  /// Computes that step. Needs no lock; the present state does not change.
  void compute_aside();
  /// Makes the result the present state: `done`, `failed` or `interrupted`. Any other exception of the step
  /// is rethrown here.
  StepOutcome commit_aside(Output output);
  /// Between begin_aside and commit_aside.
  bool computing_aside() const { return aside_; }
  /// s that the last step took, 0 before the first.
  double step_seconds() const { return step_seconds_; }

  /// Checks the whole state once more, as steps do at intervals; for a run that ends between two checks.
  void examine();

  // --- the clock
  /// Simulated seconds per second of wall time; Error "bad_request" outside [kLeastSpeed, kMostSpeed].
  static constexpr double kLeastSpeed = 1e-18, kMostSpeed = 1e15;  ///< for atoms and galaxies
  void play(double speed);
  void pause();
  bool playing() const { return playing_; }
  double speed() const { return speed_; }
  /// Adds elapsed wall time to the accumulator and does the steps that are due, at most the scene's catch-up
  /// bound.
  uint64_t advance(double wall_seconds);
  /// The same without doing them; returns how many are due.
  uint64_t accrue(double wall_seconds);
  /// Drops `steps` of those that accrue() said were due and nobody has done.
  void skip(uint64_t steps);
  /// Position between the last two steps, in [0, 1).
  double alpha() const { return accumulator_ / world_->dt(); }
  /// Steps skipped because the session could not keep up.
  uint64_t skipped_steps() const { return skipped_; }
  /// Simulated seconds per second that playing has recently achieved: `speed` less the skipped time. Empty
  /// while paused and in the first half second of playing.
  std::optional<double> achieved_speed() const { return playing_ ? achieved_speed_ : std::nullopt; }

  // --- commands
  /// Queues a command for the next step boundary; thread-safe. Returns its sequence number.
  uint64_t post(Command command);
  /// Carries out a command at this boundary, after those waiting; Error when it is invalid.
  uint64_t command(const Command& command);
  /// The state that a command at this boundary meets: after those waiting and those journalled for this step.
  const WorldState& state_for_commands();
  const std::vector<JournalEntry>& journal() const { return journal_; }
  /// The entries that have been carried out by the present step.
  std::span<const JournalEntry> journal_done() const { return {journal_.data(), journal_cursor_}; }
  /// The entries that have not: commands of a future that a seek went back from.
  std::span<const JournalEntry> journal_ahead() const { return std::span(journal_).subspan(journal_cursor_); }
  /// Sequence number of the newest command.
  uint64_t last_sequence() const { return next_sequence_ - 1; }
  /// Where the journal begins: a restored state, or the state at which it was cut to its bound; empty: the
  /// world's initial state.
  const std::optional<WorldState>& origin() const { return origin_; }
  /// The earliest step that can be reached by going back.
  uint64_t first_step() const { return origin_ ? origin_->step : 0; }

  // --- the past
  void reset();
  /// Goes to a step, back to the nearest snapshot or forward, repeating the journal: exact.
  void seek(uint64_t step);
  /// A seek in parts: begin_seek goes back to the nearest state at or before `step` (or nowhere when it lies
  /// ahead), silent steps lead from there, and end_seek tells the sinks that it is over.
  void begin_seek(uint64_t step);
  void end_seek();
  /// Continues from a state of this world (Error "bad_snapshot" when its shape differs).
  void restore(WorldState state);
  /// Resumes an interrupted session: its past begins at `origin` (empty: at the start), and the commands of
  /// `journal`, all from there on, are carried out as the following steps are repeated.
  void resume(std::optional<WorldState> origin, std::vector<JournalEntry> journal);
  /// Carries out the journalled commands of the present step; the next step would do so anyway.
  void carry_out_due_commands() { replay_commands(); }
  /// Steps at which a snapshot is kept.
  std::vector<uint64_t> snapshot_steps() const { return history_.steps(); }
  /// The kept snapshots, each taken before the commands of its step.
  std::vector<const WorldState*> snapshots() const { return history_.snapshots(); }

  // --- output
  void add_sink(std::shared_ptr<Sink> sink);
  void remove_sink(const Sink* sink);
  void remove_sinks() { sinks_.clear(); }
  /// Builds a frame of the present state.
  FramePtr frame(const FrameRequest& request) const;
  /// The state at an earlier step, computed from the nearest snapshot; the session does not change.
  WorldState state_at(uint64_t step) const;
  /// How to compute that state elsewhere.
  Past past(uint64_t step) const;
  /// A frame of a state of this world.
  FramePtr frame_of(const WorldState& state, const FrameRequest& request) const {
    return frames_.build(state, 0, request);
  }
  /// A frame of an earlier step. Error "not_found" when the step is not in this session's past.
  FramePtr frame_at(uint64_t step, const FrameRequest& request) const;
  /// Frames built so far; a frame that nobody asked for is not built.
  uint64_t frames_built() const { return frames_.built(); }
  Observables observe(const WantedObservables& wanted = {}) const { return world_->observe(state_, wanted); }
  /// Tells the sinks of something that happened around the session.
  void announce(std::string_view kind, const std::string& detail) { notify(kind, detail); }
  /// Tells the sinks that the session ends.
  void say_bye(std::string_view code, const std::string& reason) {
    for (const auto& sink : sinks_) sink->bye(code, reason);
  }
  /// Energies and probes since the start, and whatever else the scene names: sampled at every step, or every
  /// so many, if the scene names any; otherwise as far apart as it takes to cost a fiftieth of the time.
  const Series& series() const { return series_; }
  /// Largest memory that the series may take.
  static double most_series_bytes(const World& world);
  const std::optional<Failure>& failure() const { return failure_; }
  /// One for every quantity of a system that has made results up to the present step doubtful, seen at the
  /// steps of World::watched and by `examine`; sinks are told of each once.
  const std::vector<SessionWarning>& warnings() const { return warnings_; }
  /// Where the time of steps goes, from now on; the clock is looked at in every pass.
  void start_profiling() {
    if (profiles_.empty()) profiles_.resize(world_->profiled());
  }
  void stop_profiling() { profiles_.clear(); }
  /// Empty unless profiling has been started.
  std::span<const Profile> profiles() const { return profiles_; }
  /// Memory besides the world and the state itself: history, series, journal.
  size_t overhead_bytes() const;
  /// The history's part of that, as passed to SessionOptions::history_room.
  size_t history_bytes() const { return history_.memory_bytes(); }
  /// Frees scratch memory; the next step allocates it again.
  void drop_workspace() { workspace_.clear(); }

 private:
  bool one_step();
  void after_step(Output output);
  WorldState replayed(uint64_t step) const;
  Failure diagnose(const Instability& e) const;
  void changed() { hash_.reset(); }
  void drain_queue();
  void replay_commands();
  void mark_journal();
  void shorten_journal();
  void load(WorldState state);
  void abandon_aside();
  void fail(Failure failure);
  void notify(std::string_view kind, const std::string& detail);
  void record_series();
  void collect_warnings(Output output);
  WorldState snapshot_at_or_before(uint64_t step) const;

  std::shared_ptr<const World> world_;
  std::shared_ptr<const ThreadArena> arena_;
  SessionOptions options_;
  WorldState state_;
  std::optional<WorldState> origin_;  ///< see origin()
  Workspace workspace_;
  std::vector<Profile> profiles_;
  mutable std::optional<uint64_t> hash_;  ///< of the present state, if requested
  double step_seconds_ = 0;

  // The step computed beside the present state.
  bool aside_ = false;
  WorldState next_;
  std::vector<Profile> next_profiles_;
  double next_seconds_ = 0;
  std::optional<Instability> unstable_;
  std::optional<Failure> diagnosis_;
  std::exception_ptr thrown_;

  FrameBuilder frames_;
  History history_;
  FallWatch falls_;
  Series series_;
  std::chrono::steady_clock::time_point observed_{};  ///< time of the series' newest point

  bool playing_ = false;
  double speed_ = 1;
  double accumulator_ = 0;  ///< s of simulated time not yet stepped
  uint64_t skipped_ = 0;
  /// Since achieved_speed_ was last computed: s of wall time, simulated s wanted and skipped; `pending` are
  /// simulated s that were due at that time and had not been done.
  struct Pace {
    double wall = 0, wanted = 0, skipped = 0, pending = 0;
  } pace_;
  std::optional<double> achieved_speed_;

  std::mutex queue_mutex_;
  std::vector<std::pair<uint64_t, Command>> queue_;
  std::atomic<uint64_t> next_sequence_{1};
  std::atomic<bool> queue_waiting_{false};
  std::vector<JournalEntry> journal_;
  size_t journal_cursor_ = 0;  ///< first entry not yet carried out at this step

  std::vector<std::shared_ptr<Sink>> sinks_;
  std::vector<Sink*> due_;  ///< sinks that the present step's frame goes to; kept for its memory
  std::optional<Failure> failure_;
  std::vector<SessionWarning> warnings_;
};

}  // namespace truestep
