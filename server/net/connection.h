// One accepted connection: reads requests, asks the guard and the router, writes responses, upgrades to
// WebSocket. Runs as one coroutine on one network thread. Time-outs are deadlines that the event loop's sweep
// compares a few times a second, so a request costs no timer; a request whose handler answers at once costs
// no further coroutine.
#pragma once
#include <boost/beast/core/flat_buffer.hpp>
#include <memory>
#include <optional>
#include <string>

#include "server/net/access/guard.h"
#include "server/net/http/request_parser.h"
#include "server/net/http/router.h"
#include "server/net/options.h"
#include "server/net/server.h"
#include "server/net/socket.h"
#include "server/net/websocket/websocket_stream.h"

namespace truestep::net {

/// What all connections of a server share.
struct Service {
  Service(Options o, Router r) : options(std::move(o)), router(std::move(r)), guard(options) {}
  Options options;
  Router router;
  Guard guard;
  ServerStats stats;
  std::atomic<bool> draining{false};
};

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  static constexpr size_t kRead = 4096;  ///< bytes per read

  Connection(Socket socket, Service& service, Executor& loop);

  /// Serves until the connection ends.
  Task<> run();
  /// Checks the deadlines.
  void tick(Clock::time_point now);
  /// Lets a running request finish; an idle connection ends at once, a WebSocket is closed with 1001.
  void drain();
  /// Ends at once.
  void abort();

 private:
  enum class Phase : uint8_t { idle, head, body, handler, write, linger };

  RequestParser::Progress parse();
  Task<bool> read_head();
  Task<bool> read_body(size_t limit);
  Task<bool> read_more(size_t size);
  Task<Response> wait_for(const Route& route);
  Response answer(const Route& route);
  Response no_route(const Router::Match& match);
  std::optional<Response> answer_without_body(const Router::Match& match);
  void deny(Response response);
  void refuse(int status, std::string_view reason);
  bool prepare(Response& response, std::string_view& large_body);
  Task<bool> finish_response(const Response& response, std::string_view large_body);
  Task<bool> write_out(std::string_view body = {});
  Task<bool> send_file(const FileBody& file, uint64_t offset, uint64_t length);
  Task<bool> send_stream(const StreamBody& stream);
  Task<> wait_writable();
  Task<> linger();
  Task<Response> open_websocket(const Route& route);
  void enter(Phase phase);
  bool left();
  void check_key_again();

  Socket socket_;
  Service& service_;
  std::optional<RequestParser> parser_;  ///< of the current request
  Request request_;
  boost::beast::flat_buffer buffer_;  ///< received and not yet consumed
  std::string out_;                   ///< heads and small bodies on their way
  std::string remote_;
  Phase phase_ = Phase::idle;
  Clock::time_point deadline_;
  bool timed_out_ = false;
  int ended_looks_ = 0;                        ///< at a peer that has ended its side while a handler waits
  bool gone_ = false;                          ///< the peer has left: nobody reads the answer
  bool closing_ = false;                       ///< no further request after the current response
  bool unread_ = false;                        ///< the peer may still be sending: linger before closing
  std::shared_ptr<WebSocketHandler> upgrade_;  ///< set by a successful handshake
  std::string subprotocol_;
  std::shared_ptr<ServedWebSocket> websocket_;
  uint64_t keys_version_ = 0;    ///< version of the keys among which the open WebSocket's was found
  TaskContext handler_context_;  ///< of the handler that is waited for
};

}  // namespace truestep::net
