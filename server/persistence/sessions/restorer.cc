#include "server/persistence/sessions/restorer.h"

#include "engine/base/errors.h"
#include "engine/session/snapshot/snapshot.h"

namespace truestep {

namespace {

void resume(Session& session, const SavedSession& saved) {
  std::optional<WorldState> origin;
  try {
    if (!saved.snapshot.empty()) origin = read_snapshot(session.world(), saved.snapshot);
  } catch (const Error& e) {
    throw Error("session_damaged",
                std::string("the saved state of this session cannot be used: ") + e.what());
  }
  if ((origin ? origin->step : 0) != saved.from_step)
    throw Error("session_damaged", "the saved state of this session is of another step than its name says");
  session.resume(std::move(origin), saved.course.journal);
}

}  // namespace

LastCommand bring_back(SessionEntry& entry, const SavedSession& saved, std::optional<uint64_t> recorded,
                       const std::function<void()>& before_steps) {
  Session& session = entry.session;
  entry.accuracy = saved.scene.accuracy;
  resume(session, saved);
  before_steps();
  LastCommand last = LastCommand::known;
  try {
    while (session.step_index() < saved.course.step && !session.failure()) session.step(1);
    session.carry_out_due_commands();
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& e) {
    throw Error("session_damaged",
                std::string("the journal of this session cannot be repeated: ") + e.what());
  }
  if (saved.course.unconfirmed && !session.failure()) {
    try {
      session.command(saved.course.unconfirmed->command);
    } catch (const Error&) {
      last = LastCommand::refused;
    }
  }
  // A recording can be ahead of what any client was told; its frames still belong to this session.
  const bool went_back = saved.course.step < saved.course.furthest;
  while (recorded && !went_back && session.step_index() < *recorded && !session.failure()) session.step(1);
  entry.restored = Restored{saved.from_step, session.step_index(), saved.complete};
  return last;
}

}  // namespace truestep
