// WebSockets: messages, subprotocols, compression, closing, the queue; and what Beast alone gets wrong,
// tested with raw frames.
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "tests/service/net_server.h"
#include "tests/support/patience.h"

namespace truestep::net {
namespace {

namespace beast = boost::beast;
using namespace std::string_literals;

class NetWebSocket : public NetServer {
 protected:
  using Client = beast::websocket::stream<tcp::socket>;
  Client websocket(const std::string& subprotocols = "") {
    Client client(connect());
    client.set_option(
        beast::websocket::stream_base::decorator([subprotocols](beast::websocket::request_type& r) {
          if (!subprotocols.empty()) r.set(beast::http::field::sec_websocket_protocol, subprotocols);
        }));
    return client;
  }
  // A connection after its handshake, and the answer to that.
  std::pair<tcp::socket, std::string> shake(const std::string& headers = "") {
    tcp::socket s = connect();
    asio::write(s, asio::buffer("GET /echo HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n"
                                "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                                "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                                headers + "\r\n"));
    std::string head;
    asio::read_until(s, asio::dynamic_buffer(head), "\r\n\r\n");
    return {std::move(s), head};
  }
  // What the handler was told at the end.
  int end_code() {
    const auto end = std::chrono::steady_clock::now() + patience(10);
    while (seen_.close_code == 0 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
    return seen_.close_code;
  }
  // Sends the bytes and then end-of-stream, and returns everything that comes back.
  static std::string rest_after(tcp::socket& s, const std::string& bytes) {
    asio::write(s, asio::buffer(bytes));
    s.shutdown(tcp::socket::shutdown_send);
    std::string all;
    boost::system::error_code ec;
    asio::read(s, asio::dynamic_buffer(all), ec);
    EXPECT_EQ(ec, asio::error::eof) << "closed gently, not reset";
    return all;
  }
};

TEST_F(NetWebSocket, EchoesToBeastsClient) {
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
  EXPECT_EQ(end_code(), 1000);
}

TEST_F(NetWebSocket, SubprotocolsAreChosenOrRefused) {
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

TEST_F(NetWebSocket, AnErrorOfTheHandlerClosesWithAReason) {
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

TEST_F(NetWebSocket, DeflateIsOfferedToThoseWhoCanUseIt) {
  start();
  const auto agreed = [&](const std::string& offer) {
    return shake("Sec-WebSocket-Extensions: " + offer + "\r\n").second.find("permessage-deflate") !=
           std::string::npos;
  };
  EXPECT_TRUE(agreed("permessage-deflate"));
  EXPECT_TRUE(agreed("permessage-deflate; client_max_window_bits; server_max_window_bits=10"));
  EXPECT_FALSE(agreed("permessage-deflate; server_max_window_bits=8")) << "Beast would answer 9";
  EXPECT_FALSE(agreed("permessage-deflate; server_max_window_bits=99"));
  EXPECT_FALSE(agreed("x-other"));
}

TEST_F(NetWebSocket, TextThatEndsInsideACharacterIsRefused) {
  start();
  auto [s, head] = shake();
  // The first byte of a two-byte character, then an empty last fragment.
  rest_after(s, "\x01\x81\0\0\0\0\xCE\x80\x80\0\0\0\0"s);
  EXPECT_EQ(end_code(), 1007);
}

TEST_F(NetWebSocket, EndsWhenAFrameBreaksTheRulesWhileItCloses) {
  Options options;
  options.websocket.close_wait = 1s;
  start(options);
  std::weak_ptr<WebSocket> served;
  {
    auto [s, head] = shake();
    served = seen_.get();
    // The text that ends inside a character makes the server close; then comes a frame without a mask, which
    // Beast answers with a close of its own, and no end-of-stream.
    asio::write(s, asio::buffer("\x01\x81\0\0\0\0\xCE\x80\x80\0\0\0\0\x81\x01x"s));
    EXPECT_EQ(end_code(), 1007);
  }
  const auto end = std::chrono::steady_clock::now() + patience(5);
  while (!served.expired() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(served.expired()) << "nothing of the connection is left";
}

TEST_F(NetWebSocket, TheLengthThatACompressedFrameClaimsIsNotBelieved) {
  start();
  auto [s, head] = shake("Sec-WebSocket-Extensions: permessage-deflate\r\n");
  // A compressed text announced as 2^62 bytes, of which empty stored blocks arrive one after the other.
  asio::write(s, asio::buffer("\xC1\xFF\x40\0\0\0\0\0\0\0\0\0\0\0\0\0\0\xFF\xFF"s));
  for (int i = 0; i < 5; ++i) {
    std::this_thread::sleep_for(20ms);
    asio::write(s, asio::buffer("\0\0\0\xFF\xFF"s));
  }
  rest_after(s, "");
  EXPECT_EQ(end_code(), 1006) << "the bytes ended, the server did not";
  EXPECT_EQ(status(get("/ok")), 200);
}

TEST_F(NetWebSocket, CloseCodesBeyondTheRangeAreRefused) {
  start();
  const std::string close_5000 = "\x88\x82\0\0\0\0\x13\x88"s,
                    refused = "\x88\x1F\x03\xEAthe close code is not allowed"s;
  {
    auto [s, head] = shake();
    EXPECT_TRUE(rest_after(s, close_5000).ends_with(refused));
  }
  seen_.close_code = 0;
  // The same while a message that fills the socket is being sent and another one waits.
  auto [s, head] = shake();
  const auto socket = seen_.get();
  ASSERT_TRUE(socket);
  const auto frame = std::make_shared<const std::string>(size_t{16} << 20, 'f');
  EXPECT_TRUE(socket->send_binary(frame));
  EXPECT_TRUE(socket->send_text(frame));
  EXPECT_TRUE(rest_after(s, close_5000).ends_with(refused));
  EXPECT_EQ(end_code(), 1002);
}

TEST_F(NetWebSocket, TwoPartsMakeOneMessage) {
  start();
  auto client = websocket();
  client.handshake("localhost", "/echo");
  const auto socket = seen_.get();
  ASSERT_TRUE(socket);
  const auto part = [](size_t n, char c) { return std::make_shared<const std::string>(n, c); };
  EXPECT_TRUE(socket->send(MessageKind::binary, {part(10, 'a'), part(100000, 'b')}));
  EXPECT_TRUE(socket->send(MessageKind::text, {part(3, 'c'), nullptr}));
  beast::flat_buffer buffer;
  client.read(buffer);
  EXPECT_TRUE(beast::buffers_to_string(buffer.data()) == *part(10, 'a') + *part(100000, 'b'));
  buffer.clear();
  client.read(buffer);
  EXPECT_TRUE(client.got_text());
  EXPECT_EQ(beast::buffers_to_string(buffer.data()), "ccc");
}

TEST_F(NetWebSocket, QueueIsBoundedAndOtherThreadsMaySend) {
  Options options;
  options.websocket.max_queue = size_t{8} << 20;
  start(options);
  auto client = websocket();
  client.handshake("localhost", "/echo");
  const auto socket = seen_.get();
  ASSERT_TRUE(socket);
  const auto frame = std::make_shared<const std::string>(size_t{1} << 20, 'f');
  // Nobody reads: at most the queue's limit plus what the kernel buffers is accepted, then sends are refused.
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
  // Every accepted message arrives complete.
  client.read_message_max(size_t{2} << 20);
  for (int i = 0; i < accepted; ++i) {
    beast::flat_buffer buffer;
    client.read(buffer);
    ASSERT_EQ(buffer.size(), frame->size());
  }
  EXPECT_TRUE(socket->send_binary(frame)) << "room again";
}

TEST_F(NetWebSocket, SilentPeersAreAskedAndThenCut) {
  Options options;
  options.websocket.ping_interval = 1s;
  start(options);
  auto [silent, head] = shake();
  std::string all;
  boost::system::error_code ec;
  const auto begin = std::chrono::steady_clock::now();
  asio::read(silent, asio::dynamic_buffer(all), ec);
  EXPECT_EQ(all, "\x89\0"s) << "one ping";
  // Pinged after 1 s, dropped 2 s later, both found by a sweep every 0.25 s; the rest is for a busy machine.
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 2900ms);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, patience(3.75));
  EXPECT_EQ(end_code(), 1006);
  // The control: Beast's client answers pings while it reads, and its message still comes back afterwards.
  seen_.close_code = 0;
  auto client = websocket();
  client.handshake("localhost", "/echo");
  const auto socket = seen_.get();
  ASSERT_TRUE(socket);
  std::jthread later([socket] {
    std::this_thread::sleep_for(4s);
    socket->send_text(std::make_shared<const std::string>("still there"));
  });
  beast::flat_buffer buffer;
  client.read(buffer, ec);
  EXPECT_EQ(beast::buffers_to_string(buffer.data()), "still there");
}

TEST_F(NetWebSocket, PeersThatTakeNothingAreCut) {
  Options options;
  options.websocket.stall = 1s;
  start(options);
  auto [peer, head] = shake();
  const auto socket = seen_.get();
  ASSERT_TRUE(socket);
  // More than the kernel's buffers hold.
  EXPECT_TRUE(socket->send_binary(std::make_shared<const std::string>(size_t{32} << 20, 'f')));
  EXPECT_GT(socket->queued_bytes(), 0u);
  EXPECT_EQ(end_code(), 1006);
  EXPECT_FALSE(socket->is_open());
}

TEST_F(NetWebSocket, StopClosesStreamsWith1001) {
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

}  // namespace
}  // namespace truestep::net
