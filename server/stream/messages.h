// Stream messages built from the engine's data, and their two wire formats.
#pragma once
#include <string>
#include <string_view>

#include "engine/session/session.h"
#include "server/net/http/message.h"
#include "truestep/v1/stream.pb.h"

namespace truestep {

enum class WireForm : uint8_t { protobuf, json };

v1::ServerMessage hello_message(const Session& session, const std::string& id);
/// From a frame requested with Wish::constant and Wish::obstacles.
v1::ServerMessage topology_message(const World& world, const Frame& frame);
/// Positions of the obstacles, as the bytes of Frame.shapes.
std::string shapes_fields(const Frame& frame);
/// The requested contacts and joints, as the bytes of Frame.marks.
std::string marks_fields(const Frame& frame);
v1::ServerMessage playback_message(const Session& session);
v1::ServerMessage bye_message(std::string_view code, std::string_view reason);
v1::ServerMessage problem_message(std::string_view code, std::string_view detail, std::string_view request_id,
                                  std::string_view pointer);

/// The bytes of one WebSocket message.
net::SharedBuffer to_wire(const v1::ServerMessage& message, WireForm form);
/// Error "bad_request" when the bytes are not a ClientMessage.
v1::ClientMessage client_message_from_wire(std::string_view payload, WireForm form);

}  // namespace truestep
