// The server: listens, accepts, and runs one event loop per network thread. It knows routes but not what they
// do.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "server/net/http/router.h"
#include "server/net/options.h"

namespace truestep::net {

/// Counters for the metrics page; all monotonic except the two gauges.
struct ServerStats {
  std::atomic<uint64_t> accepted{0};
  std::atomic<uint64_t> refused{0};  ///< connections turned away: limit reached or no descriptors
  std::atomic<uint64_t> requests{0};
  std::atomic<uint64_t> errors_4xx{0};
  std::atomic<uint64_t> errors_5xx{0};
  std::atomic<uint64_t> timeouts{0};
  std::atomic<int64_t> connections{0};  ///< gauge: open now
  std::atomic<int64_t> websockets{0};   ///< gauge: open now
};

class Server {
 public:
  /// Throws Error("bad_request") for unusable options (key file, host).
  Server(Options options, Router router);
  /// Stops at once if still running.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Binds, listens and starts the network threads. Throws Error("bind_failed") when the address is taken or
  /// not ours.
  void start();
  /// Stops accepting and tells every connection: streams close with 1001, requests that wait are cancelled.
  /// Returns at once.
  void drain();
  /// Stops accepting, lets running requests finish, closes WebSockets with 1001 and joins the threads;
  /// connections still open after `grace` are cut. Must not be called from a handler.
  void stop(std::chrono::milliseconds grace = std::chrono::milliseconds(3000));
  /// Reads the key file at once (it is checked once a second anyway). Any thread.
  void reload_keys();
  /// True once stop() has been called.
  bool draining() const;

  /// The port being listened on (the real one when 0 was requested).
  uint16_t port() const;
  /// "http://127.0.0.1:8080".
  std::string url() const;
  const ServerStats& stats() const;
  const Router& router() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace truestep::net
