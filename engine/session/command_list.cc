#include "engine/session/command_list.h"

#include "engine/base/error_place.h"
#include "engine/session/commands.h"

namespace truestep {

namespace {

// act(document) for each; its error is placed below the document's pointer.
template <class Act>
void each_placed(const boost::json::array& documents, const std::string& pointer, Act act) {
  for (size_t i = 0; i < documents.size(); ++i) {
    try {
      act(documents[i]);
    } catch (const Error& e) {
      throw placed_below(e, pointer + '/' + std::to_string(i));
    }
  }
}

}  // namespace

std::vector<uint64_t> carry_out(Session& session, const boost::json::array& documents,
                                const std::string& pointer) {
  constexpr size_t kMostCommands = 1000;
  if (documents.size() > kMostCommands)
    throw Error("bad_command", "too many commands",
                {pointer, "out_of_range", "too many commands", std::to_string(documents.size()),
                 "at most 1000", "", ""});
  const World& world = session.world();
  if (documents.size() > 1) {
    WorldState trial = session.state_for_commands();
    each_placed(documents, pointer, [&](const boost::json::value& document) {
      world.apply(trial, read_command_for(world, trial, document));
    });
  }
  std::vector<uint64_t> out;
  each_placed(documents, pointer, [&](const boost::json::value& document) {
    out.push_back(session.command(read_command_for(world, session.state_for_commands(), document)));
  });
  return out;
}

}  // namespace truestep
