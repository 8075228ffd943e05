#include "engine/session/command_list.h"

#include "engine/base/error_place.h"
#include "engine/session/commands.h"

namespace truestep {

std::vector<Command> read_command_list(Session& session, const boost::json::array& documents,
                                       const std::string& pointer) {
  std::vector<Command> out;
  if (documents.empty()) return out;
  const World& world = session.world();
  WorldState trial = session.state_for_commands();
  for (const boost::json::value& document : documents) {
    try {
      const Command command = read_command_for(world, trial, document);
      world.apply(trial, command);
      out.push_back(command);
    } catch (const Error& e) {
      throw placed_below(e, pointer + '/' + std::to_string(out.size()));
    }
  }
  return out;
}

std::vector<uint64_t> carry_out(Session& session, const std::vector<Command>& commands) {
  std::vector<uint64_t> out;
  for (const Command& c : commands) out.push_back(session.command(c));
  return out;
}

}  // namespace truestep
