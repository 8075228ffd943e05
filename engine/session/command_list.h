// Several commands at once: all are carried out, or none.
#pragma once
#include <boost/json.hpp>
#include <string>
#include <vector>

#include "engine/core/commands/command.h"
#include "engine/session/session.h"

namespace truestep {

/// Commands as users write them, each for the state that those before it leave, tried on a copy of the
/// session's. Error "bad_command" with a pointer below `pointer`; the session is as it was.
std::vector<Command> read_command_list(Session& session, const boost::json::array& documents,
                                       const std::string& pointer);
/// Carries them out; the sequence numbers of the session's journal. Under the errors of Session::command.
std::vector<uint64_t> carry_out(Session& session, const std::vector<Command>& commands);

}  // namespace truestep
