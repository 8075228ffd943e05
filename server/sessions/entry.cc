#include "server/sessions/entry.h"

#include <cmath>

#include "engine/sinks/recording/recording_sink.h"
#include "server/persistence/sessions/session_keeper.h"

namespace truestep {

void SessionEntry::settle() {
  if (!session.profiles().empty() && Clock::now() > profiled_until) session.stop_profiling();
  if (recording && !recording_failed && recording->failed()) {
    recording_failed = true;
    session.announce("recording_incomplete", recording->status().message);
    // What nobody records would be played for nobody; steps that are asked for go on.
    if (session.playing()) session.pause();
  }
  constexpr double kWorthAWord = 64 << 10;
  // The series are leased from the start.
  const double now = static_cast<double>(session.overhead_bytes() - session.history_bytes() -
                                         session.series().memory_bytes() + (poll ? poll->memory_bytes() : 0) +
                                         encoded.memory_bytes());
  if (std::abs(now - kept.bytes()) > kWorthAWord) kept.count(now);
}

// While seeking, the session stands where it was until it has arrived.
bool SessionEntry::acknowledged() const {
  return !keeper || jobs.seeking() || keeper->acknowledged();
}

void SessionEntry::acknowledge() {
  if (!acknowledged()) keeper->acknowledge();
}

}  // namespace truestep
