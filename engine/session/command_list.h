// Several commands at once: all are carried out, or none.
#pragma once
#include <boost/json.hpp>
#include <string>
#include <vector>

#include "engine/session/session.h"

namespace truestep {

/// Carries out commands as users write them, each for the state that those before it leave; their sequence
/// numbers in the session's journal. Error "bad_command" with a pointer below `pointer`, also for more than
/// 1,000: the session is as it was. (Several are tried on a copy of its state before.)
std::vector<uint64_t> carry_out(Session& session, const boost::json::array& documents,
                                const std::string& pointer);

}  // namespace truestep
