// Commands as JSON, both ways: POST /v1/sessions/{id}/commands, the stream's Command, the journal.
//   {"type": "impulse", "system": "cloth", "index": 5, "impulse": [0, 1, 0]}
#pragma once
#include <boost/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/errors.h"
#include "engine/core/commands/command.h"
#include "engine/core/def/def.h"

namespace truestep {

/// One command type: its name, what it does and its parameters.
struct CommandType {
  std::string_view name;
  CommandKind kind;
  const DefTable* table;
};
std::span<const CommandType> command_types();

/// Error "bad_command" with every fault and its pointer.
Command read_command(const boost::json::value& document);
boost::json::object write_command(const Command& command);

/// What a document calls a member of Command: drag's "value" is its "stiffness".
std::string written_name(CommandKind kind, std::string_view member);
/// The error of a system that refused a command, with pointers that name what the document says.
Error as_written(const Error& refused, CommandKind kind);

class World;
struct WorldState;
/// A command from a user for this state: "index" may be the id of a body or joint instead of its row, and
/// what set_parameter and spawn take is checked against the table of their system. Error "bad_command" with
/// pointer, what is allowed and the nearest name.
Command read_command_for(const World& world, const WorldState& state, const boost::json::value& document);

}  // namespace truestep
