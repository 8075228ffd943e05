// The table of routes: one row per method and pattern, each with a sentence, from which the HTTP description
// is generated too. A pattern is a path of literal and {named} segments; a last segment {name...} takes the
// rest. Handlers either answer at once (plain function) or are coroutines that may wait.
#pragma once
#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "server/net/http/message.h"
#include "server/net/websocket/websocket.h"

namespace truestep::net {

/// Answers on the network thread; must not block.
using Handler = std::function<Response(const Request&)>;
/// Answers when it is done; runs on the network thread and waits with co_await.
using AsyncHandler = std::function<Task<Response>(const Request&)>;
/// Accepts a WebSocket by returning the object that will serve it; refuses by throwing Error.
using WebSocketOpener = std::function<std::shared_ptr<WebSocketHandler>(const Request&)>;

/// Who may call a route when keys are configured.
enum class Access { key, open };

/// One row of the table.
struct Route {
  Method method = Method::get;
  std::string pattern;
  std::string summary;
  Handler handler;  ///< exactly one of handler, async_handler and open_websocket is set
  AsyncHandler async_handler;
  WebSocketOpener open_websocket;
  /// Awaited before it; may also throw Error.
  std::function<Task<>(const Request&)> before_open;
  std::vector<std::string> subprotocols;      ///< of a WebSocket, in order of preference
  std::function<void(const Request&)> check;  ///< called before each of them; may throw Error
  size_t max_body = 0;                        ///< bytes; 0 = the server's limit
  Access access = Access::key;
};

/// The table. Rows are added before the server starts and never change afterwards.
class Router {
 public:
  Router();
  ~Router();
  Router(Router&&) noexcept;
  Router& operator=(Router&&) noexcept;

  /// Adds a row and returns it for further settings (max_body, access). Throws Error("internal") when the
  /// pattern is malformed or the pair of method and pattern exists. `f` is a Handler or an AsyncHandler.
  template <class F>
  Route& add(Method method, std::string pattern, std::string summary, F f) {
    Route row;
    row.method = method;
    row.pattern = std::move(pattern);
    row.summary = std::move(summary);
    if constexpr (std::is_same_v<std::invoke_result_t<F, const Request&>, Response>) {
      row.handler = std::move(f);
    } else {
      row.async_handler = std::move(f);
    }
    return insert(std::move(row));
  }
  /// Adds a WebSocket endpoint (GET with an upgrade).
  Route& websocket(std::string pattern, std::string summary, std::vector<std::string> subprotocols,
                   WebSocketOpener open);

  /// What a request's path and method lead to. HEAD falls back to GET.
  struct Match {
    const Route* route = nullptr;
    bool path_known = false;
    std::string allow;  ///< methods of the path, filled when the path is known but the method is not
  };
  /// Finds the row and fills request.params.
  Match find(Request& request) const;

  /// All rows in the order added.
  const std::deque<Route>& rows() const { return rows_; }
  /// Sets `check` of every row to what `make` gives for it.
  void check_rows(const std::function<std::function<void(const Request&)>(const Route&)>& make) {
    for (Route& row : rows_) row.check = make(row);
  }

 private:
  struct Node;
  Route& insert(Route row);
  const Node* walk(const Node& node, Request& request, size_t depth) const;
  std::deque<Route> rows_;
  std::unique_ptr<Node> root_;
};

}  // namespace truestep::net
