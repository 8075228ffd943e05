// WS /v1/sessions/{id}/stream without the headers of its protocol.
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>

#include "server/net/websocket/websocket.h"
#include "server/sessions/runner.h"

namespace truestep {

/// Counters over all streams, for the metrics page.
struct StreamStats {
  std::atomic<uint64_t> frames{0}, dropped{0}, bytes{0};
};

/// Serves one client of a session; a StreamClient.
std::shared_ptr<net::WebSocketHandler> make_stream(EntryPtr entry, Runner& runner, StreamStats& stats);

}  // namespace truestep
