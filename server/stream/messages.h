// Messages of the stream built from what the engine knows, and their two wire forms.
#pragma once
#include <string>
#include <string_view>

#include "engine/core/overlay.h"
#include "engine/session/session.h"
#include "server/net/message.h"
#include "truestep/v1/stream.pb.h"

namespace truestep {

enum class WireForm : uint8_t { protobuf, json };

v1::ServerMessage hello_message(const Session& session, const std::string& id);
v1::ServerMessage topology_message(const Session& session);
/// Where the scene's shapes are now.
v1::ServerMessage shapes_message(const Session& session);
/// Contacts and joints of all systems as they are now.
v1::ServerMessage marks_message(const Session& session, Overlay wish);
v1::ServerMessage playback_message(const Session& session);
v1::ServerMessage problem_message(std::string_view code, std::string_view detail, std::string_view request_id,
                                  std::string_view pointer);

/// The bytes of one WebSocket message.
net::SharedBuffer to_wire(const v1::ServerMessage& message, WireForm form);
/// Error "bad_request" when the bytes are no ClientMessage.
v1::ClientMessage client_message_from_wire(std::string_view payload, WireForm form);

}  // namespace truestep
