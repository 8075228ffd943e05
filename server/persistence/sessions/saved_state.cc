#include "server/persistence/sessions/saved_state.h"

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/commands.h"

namespace truestep {

namespace json = boost::json;

std::string command_text(const Command& command) {
  return write_json(write_command(command));
}

Command command_of(std::string_view text) {
  try {
    return read_command(parse_json(text));
  } catch (const Error& e) {
    throw Error("session_damaged", std::string("a command of the journal cannot be read: ") + e.what());
  }
}

Bytes write_saved_state(const SavedState& state) {
  SealedWriter out;
  out.block(state.snapshot);
  out.number(state.ahead.size());
  for (const JournalEntry& e : state.ahead) {
    out.number(e.step);
    out.number(e.sequence);
    out.text(command_text(e.command));
  }
  out.number(state.last_sequence);
  return seal(kSavedState, out.contents());
}

SavedState read_saved_state(std::span<const std::byte> file) {
  SealedReader in(kSavedState, unseal(kSavedState, file));
  SavedState state;
  const auto snapshot = in.block();
  state.snapshot.assign(snapshot.begin(), snapshot.end());
  for (uint64_t n = in.number(); n > 0; --n) {
    const uint64_t step = in.number(), sequence = in.number();
    if (step > kMostStep || (!state.ahead.empty() && step < state.ahead.back().step))
      in.fail("its commands are out of order");
    state.ahead.push_back({step, sequence, command_of(in.text())});
  }
  state.last_sequence = in.number();
  if (!in.done()) in.fail("unexpected bytes follow its end");
  return state;
}

}  // namespace truestep
