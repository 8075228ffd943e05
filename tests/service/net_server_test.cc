// The HTTP and WebSocket layer over real sockets, in one process. The WebSocket client is Beast's own, so
// that both ends do not share a misunderstanding.
#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <filesystem>
#include <fstream>
#include <thread>

#include "engine/base/errors.h"
#include "engine/scene/json.h"
#include "server/net/async.h"
#include "server/net/digest.h"
#include "server/net/server.h"

namespace truestep::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using namespace std::chrono_literals;

// What the tests see of the last WebSocket.
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

class NetServer : public testing::Test {
 protected:
  void start(Options options = {}) {
    options.port = 0;
    Router router;
    router.add(Method::get, "/ok", "small", [](const Request&) { return Response::text("ok"); }).access =
        Access::open;
    router.add(Method::get, "/who", "name of the key",
               [](const Request& r) { return Response::text(std::string(r.principal)); });
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
    router.add(Method::get, "/file", "a file",
               [this](const Request&) { return Response::file(file_.string(), "text/plain"); });
    router.add(Method::get, "/poll", "waits for a signal",
               [this](const Request&) -> asio::awaitable<Response> {
                 const bool raised =
                     co_await signal_.wait(signal_.version(), std::chrono::steady_clock::now() + 20s);
                 co_return Response::text(raised ? "raised" : "timeout");
               });
    router.add(Method::get, "/pool", "computes elsewhere",
               [this](const Request&) -> asio::awaitable<Response> {
                 const auto caller = std::this_thread::get_id();
                 const bool other =
                     co_await offload(pool_, [caller] { return std::this_thread::get_id() != caller; });
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

  using Client = beast::websocket::stream<tcp::socket>;
  Client websocket(const std::string& subprotocols = "") {
    Client client(connect());
    client.set_option(
        beast::websocket::stream_base::decorator([subprotocols](beast::websocket::request_type& r) {
          if (!subprotocols.empty()) r.set(beast::http::field::sec_websocket_protocol, subprotocols);
        }));
    return client;
  }

  asio::io_context io_;
  asio::thread_pool pool_{1};
  Signal signal_;
  Seen seen_;
  std::filesystem::path file_ = std::filesystem::temp_directory_path() / ("truestep_net_" + random_hex128());
  std::unique_ptr<Server> server_;
};

TEST_F(NetServer, AnswersInOrderWhenPipelined) {
  start();
  const std::string close = "GET /nothing HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
  std::string requests;
  for (int i = 0; i < 300; ++i) requests += "GET /ok HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const std::string answer =
      talk(requests + "GET /pool HTTP/1.1\r\nHost: localhost\r\n\r\n" + close + "GET /ok HTTP/1.1\r\n");
  size_t count = 0;
  for (size_t at = 0; (at = answer.find("HTTP/1.1 200 OK", at)) != std::string::npos; ++at) ++count;
  EXPECT_EQ(count, 301u);
  EXPECT_LT(answer.find("there and back"), answer.find("HTTP/1.1 404"))
      << "a waiting handler holds back the next answer";
  EXPECT_TRUE(answer.ends_with("}")) << "nothing after the response that closes";
}

TEST_F(NetServer, RoutesAndMethods) {
  start();
  EXPECT_EQ(body(get("/ok")), "ok");
  const std::string head = get("/ok", "", "HEAD");
  EXPECT_NE(head.find("Content-Length: 2\r\n"), std::string::npos);
  EXPECT_EQ(body(head), "");
  EXPECT_EQ(status(get("/nothing")), 404);
  const std::string wrong = get("/ok", "", "DELETE");
  EXPECT_EQ(status(wrong), 405);
  EXPECT_NE(wrong.find("Allow: GET, HEAD, OPTIONS\r\n"), std::string::npos);
  EXPECT_EQ(status(get("/ok", "", "OPTIONS")), 204);
  const std::string failed = get("/throw");
  EXPECT_EQ(status(failed), 500);
  EXPECT_EQ(failed.find("secret"), std::string::npos);
  EXPECT_EQ(body(get("/big")).size(), size_t{4} << 20);
  EXPECT_EQ(body(get("/pool")), "there and back");
}

TEST_F(NetServer, Bodies) {
  start();
  const auto post = [&](const std::string& path, const std::string& rest) {
    return talk("POST " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + rest);
  };
  EXPECT_EQ(body(post("/length", "Content-Length: 5\r\n\r\nhello")), "5");
  EXPECT_EQ(body(post("/length", "Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n2\r\n!!\r\n0\r\n\r\n")),
            "7");
  EXPECT_EQ(body(post("/length", "Content-Length: 100000\r\n\r\n" + std::string(100000, 'x'))), "100000");
  EXPECT_EQ(status(post("/length", "Content-Length: 100001\r\n\r\n")), 413);
  EXPECT_EQ(status(post("/length", "Transfer-Encoding: chunked\r\n\r\n186A1\r\n")), 413);
  EXPECT_EQ(status(post("/json", "Content-Length: 13\r\n\r\n{\"a\":1,\"a\":2}")), 400);
  const std::string expected = post("/length", "Expect: 100-continue\r\nContent-Length: 0\r\n\r\n");
  EXPECT_EQ(status(expected), 200) << "no body, so there is nothing to continue with";
}

TEST_F(NetServer, FilesAndRanges) {
  std::ofstream(file_) << "0123456789";
  start();
  const std::string whole = get("/file");
  EXPECT_EQ(body(whole), "0123456789");
  const size_t at = whole.find("ETag: ") + 6;
  const std::string etag = whole.substr(at, whole.find("\r\n", at) - at);
  EXPECT_EQ(status(get("/file", "If-None-Match: " + etag + "\r\n")), 304);
  const std::string part = get("/file", "Range: bytes=3-5\r\nIf-Range: " + etag + "\r\n");
  EXPECT_EQ(status(part), 206);
  EXPECT_EQ(body(part), "345");
  EXPECT_EQ(status(get("/file", "Range: bytes=10-\r\n")), 416);
  std::ofstream(file_, std::ios::app) << "x";
  EXPECT_EQ(status(get("/file", "If-None-Match: " + etag + "\r\n")), 200) << "a changed file has another tag";
  std::filesystem::remove(file_);
  EXPECT_EQ(status(get("/file")), 404);
}

TEST_F(NetServer, ForeignHostsAndOriginsAreRefused) {
  start({.allowed_hosts = {"sim.example"}, .allowed_origins = {"https://app.example"}});
  const auto host = [&](const std::string& h) {
    return status(talk("GET /ok HTTP/1.1\r\nConnection: close\r\nHost: " + h + "\r\n\r\n"));
  };
  EXPECT_EQ(host("127.0.0.1:1"), 200);
  EXPECT_EQ(host("[::1]"), 200);
  EXPECT_EQ(host("sim.example"), 200);
  EXPECT_EQ(host("evil.example"), 421);
  EXPECT_EQ(host("localhost.evil.example"), 421);
  EXPECT_EQ(status(get("/ok", "Origin: http://localhost\r\n")), 200);
  EXPECT_EQ(status(get("/ok", "Origin: https://app.example\r\n")), 200);
  EXPECT_EQ(status(get("/ok", "Origin: null\r\n")), 403);
  EXPECT_EQ(status(get("/ok", "Origin: http://localhost.evil.example\r\n")), 403);
}

TEST_F(NetServer, KeysAreAskedForWhenConfigured) {
  std::ofstream(file_) << "# keys\nalice secret-a\nbob sha256:" << sha256_hex("secret-b") << "\n";
  start({.api_key_file = file_.string()});
  EXPECT_EQ(status(get("/ok")), 200) << "an open route";
  EXPECT_EQ(status(get("/who")), 401);
  EXPECT_EQ(status(get("/who", "Authorization: Bearer wrong\r\n")), 401);
  EXPECT_EQ(body(get("/who", "Authorization: Bearer secret-a\r\n")), "alice");
  EXPECT_EQ(body(get("/who", "Authorization: bearer secret-b\r\n")), "bob");
  EXPECT_EQ(status(get("/nothing")), 401) << "which paths exist is not told to strangers";
}

TEST_F(NetServer, SlowRequestsAreCut) {
  start({.head_timeout = 300ms, .body_timeout = 300ms, .idle_timeout = 300ms});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(status(talk("GET /ok HTTP/1.1\r\nHost: loc")), 408);
  EXPECT_EQ(status(talk("POST /length HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\nabc")), 408);
  EXPECT_EQ(talk(""), "") << "an idle connection is closed without a word";
  // Three limits of 0.3 s, each found by a sweep every 0.25 s; ten times that for a busy machine.
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 16s);
  EXPECT_EQ(server_->stats().timeouts, 3u);
}

TEST_F(NetServer, TooManyConnectionsGet503AndRecover) {
  start({.max_connections = 3});
  std::vector<tcp::socket> held;
  for (int i = 0; i < 3; ++i) held.push_back(connect());
  EXPECT_EQ(status(get("/ok")), 503);
  held.clear();
  int last = 0;
  for (int i = 0; i < 500 && last != 200; ++i) {
    std::this_thread::sleep_for(5ms);
    last = status(get("/ok"));
  }
  EXPECT_EQ(last, 200);
}

TEST_F(NetServer, LongPollIsWokenBySignalAndEndedByStop) {
  start();
  std::string woken, ended;
  std::jthread first([&] { woken = get("/poll"); });
  while (woken.empty() && server_->stats().requests < 1) std::this_thread::sleep_for(1ms);
  // The handler may not wait yet when the request is counted: raise until it has answered.
  std::jthread raiser([&](std::stop_token stop) {
    while (!stop.stop_requested()) {
      signal_.notify();
      std::this_thread::sleep_for(1ms);
    }
  });
  first.join();
  EXPECT_EQ(body(woken), "raised");
  raiser.request_stop();
  raiser.join();
  std::jthread second([&] { ended = get("/poll"); });
  while (server_->stats().requests < 2) std::this_thread::sleep_for(1ms);
  std::this_thread::sleep_for(50ms);
  const auto begin = std::chrono::steady_clock::now();
  server_->stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 3s) << "stopping does not wait for the poll's own 20 s";
  second.join();
  EXPECT_EQ(body(ended), "timeout");
}

TEST_F(NetServer, EchoesToBeastsClient) {
  start();
  auto client = websocket();
  beast::websocket::permessage_deflate deflate;
  deflate.client_enable = true;
  client.set_option(deflate);
  client.handshake("localhost", "/echo");
  client.read_message_max(size_t{2} << 20);
  for (const size_t size : {0u, 1u, 125u, 126u, 65535u, 65536u, 1u << 20}) {
    for (const bool text : {true, false}) {
      client.text(text);
      const std::string sent(size, 'm');
      client.write(asio::buffer(sent));
      beast::flat_buffer buffer;
      client.read(buffer);
      EXPECT_EQ(client.got_text(), text);
      EXPECT_TRUE(beast::buffers_to_string(buffer.data()) == sent) << size;
    }
  }
  client.close(beast::websocket::close_code::normal);
  for (int i = 0; i < 2000 && seen_.close_code == 0; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(seen_.close_code, 1000);
}

TEST_F(NetServer, SubprotocolsAreChosenOrRefused) {
  start();
  const auto chosen = [&](const std::string& offered) {
    auto client = websocket(offered);
    beast::websocket::response_type response;
    boost::system::error_code ec;
    client.handshake(response, "localhost", "/echo", ec);
    return std::to_string(response.result_int()) +
           std::string(response[beast::http::field::sec_websocket_protocol]);
  };
  EXPECT_EQ(chosen(""), "101");
  EXPECT_EQ(chosen("a.v1"), "101a.v1");
  EXPECT_EQ(chosen("x, a.v1, b.v1"), "101b.v1") << "the server's order of preference";
  EXPECT_EQ(chosen("x.v1"), "400");
  EXPECT_EQ(status(get("/echo")), 426);
}

TEST_F(NetServer, AnErrorOfTheHandlerClosesWithAReason) {
  start();
  auto client = websocket();
  client.handshake("localhost", "/echo");
  client.text(true);
  client.write(asio::buffer(std::string("throw")));
  beast::flat_buffer buffer;
  boost::system::error_code ec;
  client.read(buffer, ec);
  EXPECT_EQ(ec, beast::websocket::error::closed);
  EXPECT_EQ(client.reason().code, 1008);
  EXPECT_EQ(client.reason().reason, "as asked");
}

TEST_F(NetServer, QueueIsBoundedAndOtherThreadsMaySend) {
  Options options;
  options.websocket.max_queue = size_t{8} << 20;
  start(options);
  auto client = websocket();
  client.handshake("localhost", "/echo");
  const auto socket = seen_.get();
  ASSERT_TRUE(socket);
  const auto frame = std::make_shared<const std::string>(size_t{1} << 20, 'f');
  // Nobody reads: at most the queue's limit and what the kernel takes is accepted, then sends are refused.
  int accepted = 0;
  std::vector<std::jthread> senders;
  std::atomic<int> total{0};
  for (int t = 0; t < 2; ++t) {
    senders.emplace_back([&] {
      for (int i = 0; i < 100; ++i) total += socket->send_binary(frame);
    });
  }
  senders.clear();
  accepted = total;
  EXPECT_LT(accepted, 60);
  EXPECT_GE(accepted, 8);
  EXPECT_LE(socket->queued_bytes(), options.websocket.max_queue);
  // Every accepted message arrives, whole and in one piece.
  client.read_message_max(size_t{2} << 20);
  for (int i = 0; i < accepted; ++i) {
    beast::flat_buffer buffer;
    client.read(buffer);
    ASSERT_EQ(buffer.size(), frame->size());
  }
  EXPECT_TRUE(socket->send_binary(frame)) << "room again";
}

TEST_F(NetServer, StopClosesStreamsWith1001) {
  start();
  auto client = websocket();
  client.handshake("localhost", "/echo");
  ASSERT_TRUE(seen_.get());
  std::jthread stopper([&] { server_->stop(); });
  beast::flat_buffer buffer;
  boost::system::error_code ec;
  client.read(buffer, ec);
  EXPECT_EQ(client.reason().code, 1001);
  stopper.join();
  EXPECT_EQ(seen_.close_code, 1001);
  EXPECT_EQ(server_->stats().connections, 0);
}

TEST(NetServerStart, SaysWhyItCannotListen) {
  Server first({.port = 0}, Router());
  first.start();
  Server second({.port = first.port()}, Router());
  try {
    second.start();
    FAIL() << "two servers on one port";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), "bind_failed");
    EXPECT_NE(std::string(e.what()).find(std::to_string(first.port())), std::string::npos);
  }
}

}  // namespace
}  // namespace truestep::net
