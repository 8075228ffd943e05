#include "server/sessions/entry.h"

#include "server/persistence/sessions/session_keeper.h"

namespace truestep {

// While seeking, the session stands where it was until it has arrived.
bool SessionEntry::acknowledged() const {
  return !keeper || jobs.seeking() || keeper->acknowledged();
}

void SessionEntry::acknowledge() {
  if (!acknowledged()) keeper->acknowledge();
}

}  // namespace truestep
