// server/net alone over real sockets, in the test's process, with routes for every kind of answer, and a
// client that sends raw text.
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio.hpp>
#include <filesystem>
#include <fstream>
#include <thread>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "server/net/access/digest.h"
#include "server/net/server.h"
#include "server/net/worker_pool.h"
#include "server/tasks/offload.h"
#include "server/tasks/signal.h"

namespace truestep::net {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace std::chrono_literals;

// What the tests observe of the last WebSocket.
struct Seen {
  std::mutex mutex;
  std::shared_ptr<WebSocket> socket;
  std::atomic<int> close_code{0};
  std::shared_ptr<WebSocket> get() {
    for (int i = 0; i < 2000; ++i) {
      {
        const std::lock_guard lock(mutex);
        if (socket) return socket;
      }
      std::this_thread::sleep_for(1ms);
    }
    return nullptr;
  }
};

class EchoHandler : public WebSocketHandler {
 public:
  explicit EchoHandler(Seen& seen) : seen_(seen) {}
  void on_open(std::shared_ptr<WebSocket> socket) override {
    const std::lock_guard lock(seen_.mutex);
    seen_.socket = socket_ = std::move(socket);
  }
  void on_message(MessageKind kind, std::string_view payload) override {
    if (payload == "throw") throw Error("invalid", "as asked");
    auto copy = std::make_shared<const std::string>(payload);
    kind == MessageKind::text ? socket_->send_text(copy) : socket_->send_binary(copy);
  }
  void on_close(uint16_t code, std::string_view) override {
    seen_.close_code = code;
    const std::lock_guard lock(seen_.mutex);
    seen_.socket.reset();
  }

 private:
  Seen& seen_;
  std::shared_ptr<WebSocket> socket_;
};

class NetServer : public ::testing::Test {
 protected:
  void start(Options options = {}) {
    options.port = 0;
    Router router;
    router.add(Method::get, "/ok", "small", [](const Request&) { return Response::text("ok"); }).access =
        Access::open;
    router.add(Method::get, "/who", "name of the key",
               [](const Request& r) { return Response::text(r.caller.name); });
    router
        .add(Method::post, "/length", "bytes of the body",
             [](const Request& r) { return Response::text(std::to_string(r.body.size())); })
        .max_body = 100000;
    router.add(Method::post, "/json", "parses", [](const Request& r) {
      parse_json(r.body);
      return Response::json("{}");
    });
    router.add(Method::get, "/big", "4 MiB",
               [](const Request&) { return Response::text(std::string(4 << 20, 'b')); });
    router.add(Method::get, "/throw", "fails",
               [](const Request&) -> Response { throw std::runtime_error("secret"); });
    router.add(Method::get, "/file", "a file", [this](const Request&) {
      return Response::file(::open(file_.c_str(), O_RDONLY | O_CLOEXEC), "text/plain");
    });
    router.add(Method::get, "/poll", "waits for a signal", [this](const Request&) -> Task<Response> {
      const bool raised = co_await signal_.wait(signal_.version(), std::chrono::steady_clock::now() + 20s);
      co_return Response::text(raised ? "raised" : "timeout");
    });
    router.add(Method::get, "/pool", "computes elsewhere", [this](const Request&) -> Task<Response> {
      const auto caller = std::this_thread::get_id();
      const bool other = co_await offload(pool_, [caller] { return std::this_thread::get_id() != caller; });
      co_return Response::text(other && std::this_thread::get_id() == caller ? "there and back"
                                                                             : "wrong thread");
    });
    router.websocket("/echo", "echoes", {"b.v1", "a.v1"},
                     [this](const Request&) { return std::make_shared<EchoHandler>(seen_); });
    server_ = std::make_unique<Server>(options, std::move(router));
    server_->start();
  }
  void TearDown() override {
    if (server_) server_->stop();
    pool_.join();
    std::filesystem::remove(file_);
  }

  tcp::socket connect() {
    tcp::socket s(io_);
    s.connect({asio::ip::make_address("127.0.0.1"), server_->port()});
    return s;
  }
  // Sends the text and reads until the server closes.
  std::string talk(const std::string& text) {
    tcp::socket s = connect();
    asio::write(s, asio::buffer(text));
    std::string answer;
    boost::system::error_code ec;
    asio::read(s, asio::dynamic_buffer(answer), ec);
    return answer;
  }
  std::string get(const std::string& target, const std::string& headers = "",
                  const std::string& method = "GET") {
    return talk(method + " " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + headers +
                "\r\n");
  }
  static int status(const std::string& answer) {
    return answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0;
  }
  static std::string body(const std::string& answer) { return answer.substr(answer.find("\r\n\r\n") + 4); }

  asio::io_context io_;
  WorkerPool pool_{1};
  Signal signal_;
  Seen seen_;
  std::filesystem::path file_ = std::filesystem::temp_directory_path() / ("truestep_net_" + random_hex128());
  std::unique_ptr<Server> server_;
};

}  // namespace truestep::net
