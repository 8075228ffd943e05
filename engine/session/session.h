// A session: a world that runs. Fixed-dt accumulator, command queue and journal, sinks, and a history of
// snapshots for exact seeking. One thread at a time may use it; only `post` may be called from any thread.
#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/session/frame.h"
#include "engine/session/history.h"
#include "engine/session/series.h"
#include "engine/session/world.h"

namespace truestep {

struct SessionOptions {
  size_t history_bytes = 32 << 20;  ///< bound of all snapshots kept for seeking
  size_t journal_entries = 65536;   ///< more commands shorten the past that can be gone back to
  enum class Profiling : uint8_t { off, on } profiling = Profiling::off;
};

/// A command as it was carried out: before the step from `step` to `step + 1`, in the order of `sequence`.
struct JournalEntry {
  uint64_t step = 0;
  uint64_t sequence = 0;
  Command command;
};

/// Why a session cannot go on.
struct Failure {
  std::string system, quantity, detail;
  long long index = -1;
  uint64_t last_good_step = 0, step = 0;  ///< `step` failed
  double time = 0;                        ///< s, at its end
  std::optional<double> suggested_dt;     ///< s, a step that held when it was tried
  std::vector<std::string> remedies;      ///< what helped when it was tried, one sentence each
};

class Session {
 public:
  Session(std::shared_ptr<const World> world, std::shared_ptr<const ThreadArena> arena,
          SessionOptions options = {});

  const World& world() const { return *world_; }
  const WorldState& state() const { return state_; }
  uint64_t step_index() const { return state_.step; }
  double time() const { return static_cast<double>(state_.step) * world_->dt(); }
  uint64_t hash() const { return state_.hash(); }

  /// Carries out waiting commands, then up to n steps with frames to the sinks that are due. Returns how many
  /// were done: fewer only after a failure. Error "instability" when the session has failed already.
  uint64_t step(uint64_t n);

  /// Looks at the whole state once more, as steps do every so often: a run that ends between two looks.
  void examine();

  // --- the clock
  /// Simulated seconds a second of wall time; Error "bad_request" unless 0 < speed <= 1000.
  void play(double speed);
  void pause();
  bool playing() const { return playing_; }
  double speed() const { return speed_; }
  /// Hands the accumulator elapsed wall time; does the steps it buys, at most the scene's catch-up bound.
  uint64_t advance(double wall_seconds);
  /// Position between the last two steps, in [0, 1).
  double alpha() const { return accumulator_ / world_->dt(); }
  /// Steps left out because the session could not keep up.
  uint64_t skipped_steps() const { return skipped_; }

  // --- commands
  /// Queues a command for the next step boundary; thread-safe. Returns its sequence number.
  uint64_t post(Command command);
  /// Carries out a command at this boundary, after those waiting; Error when it makes no sense.
  uint64_t command(const Command& command);
  const std::vector<JournalEntry>& journal() const { return journal_; }
  /// Those that have been carried out where the session stands now.
  std::span<const JournalEntry> journal_done() const { return {journal_.data(), journal_cursor_}; }
  /// What the journal begins at: a restored state, or the one that commands beyond the journal's bound have
  /// moved its beginning to; none: the world's initial state.
  const std::optional<WorldState>& origin() const { return origin_; }
  /// The earliest step that can be gone back to.
  uint64_t first_step() const { return origin_ ? origin_->step : 0; }

  // --- the past
  void reset();
  /// Goes to a step, back from the nearest snapshot or forward, repeating the journal: exact.
  void seek(uint64_t step);
  /// Continues from a state of this world (Error "bad_snapshot" when its shape is another).
  void restore(WorldState state);
  /// Steps at which a snapshot is kept.
  std::vector<uint64_t> snapshot_steps() const { return history_.steps(); }
  /// What is kept, each from before the commands of its step.
  std::vector<const WorldState*> snapshots() const { return history_.snapshots(); }

  // --- what comes out
  void add_sink(std::shared_ptr<Sink> sink);
  void remove_sink(const Sink* sink);
  void remove_sinks() { sinks_.clear(); }
  /// Builds a frame of the present state.
  FramePtr frame(const FrameRequest& request) const;
  /// The state of an earlier step, computed from the nearest snapshot; the session stays where it is.
  WorldState state_at(uint64_t step) const;
  /// A frame of an earlier step. Error "not_found" when the step lies before this session's past or ahead.
  FramePtr frame_at(uint64_t step, const FrameRequest& request) const;
  /// Frames built so far; a frame nobody asked for is not built.
  uint64_t frames_built() const { return frames_built_; }
  Observables observe() const { return world_->observe(state_); }
  /// Kept when the scene names observables.
  const Series& series() const { return series_; }
  const std::optional<Failure>& failure() const { return failure_; }
  std::span<const Profile> profiles() const { return profiles_; }
  uint32_t topology_version() const;
  /// Beside the world and the state itself: history, series, journal.
  size_t overhead_bytes() const;
  /// Throws away scratch memory; it comes back with the next step.
  void drop_workspace() { workspace_.clear(); }

 private:
  bool one_step();
  void step_world();
  void after_step();
  void drain_queue();
  void replay_commands();
  void shorten_journal();
  void load(WorldState state);
  void fail(const Instability& e);
  void notify(std::string_view kind, const std::string& detail);
  FramePtr build_frame(const WorldState& state, double alpha, const FrameRequest& request) const;
  void record_series();
  WorldState snapshot_at_or_before(uint64_t step) const;
  void step_silently_to(uint64_t step);

  std::shared_ptr<const World> world_;
  std::shared_ptr<const ThreadArena> arena_;
  SessionOptions options_;
  WorldState state_;
  std::optional<WorldState> origin_;  ///< see origin()
  Workspace workspace_;
  std::vector<Profile> profiles_;
  History history_;
  Series series_;

  bool playing_ = false;
  double speed_ = 1;
  double accumulator_ = 0;  ///< s of simulated time not yet stepped
  uint64_t skipped_ = 0;

  std::mutex queue_mutex_;
  std::vector<std::pair<uint64_t, Command>> queue_;
  std::atomic<uint64_t> next_sequence_{1};
  std::atomic<bool> queue_waiting_{false};
  std::vector<JournalEntry> journal_;
  size_t journal_cursor_ = 0;  ///< first entry not yet carried out at this step

  std::vector<std::shared_ptr<Sink>> sinks_;
  std::vector<std::shared_ptr<Sink>> due_;  ///< those of the present step
  mutable uint64_t frames_built_ = 0;
  std::optional<Failure> failure_;
};

}  // namespace truestep
