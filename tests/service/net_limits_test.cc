// Who is turned away: foreign hosts and origins, clients without a key, slow and too many peers.
#include "tests/service/net_server.h"
#include "tests/support/patience.h"

namespace truestep::net {
namespace {

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
  std::ofstream(file_) << "# keys\nalice alice-secret-for-tests\nbob sha256:" << sha256_hex("secret-b")
                       << "\n";
  start({.api_key_file = file_.string()});
  EXPECT_EQ(status(get("/ok")), 200) << "an open route";
  EXPECT_EQ(status(get("/who")), 401);
  EXPECT_EQ(status(get("/who", "Authorization: Bearer wrong\r\n")), 401);
  EXPECT_EQ(body(get("/who", "Authorization: Bearer alice-secret-for-tests\r\n")), "alice");
  EXPECT_EQ(body(get("/who", "Authorization: bearer secret-b\r\n")), "bob");
  EXPECT_EQ(status(get("/nothing")), 401) << "which paths exist is not told to strangers";
}

TEST_F(NetServer, SlowRequestsAreCut) {
  start({.head_timeout = 300ms, .body_timeout = 300ms, .idle_timeout = 300ms});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(status(talk("GET /ok HTTP/1.1\r\nHost: loc")), 408);
  EXPECT_EQ(status(talk("POST /length HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\nabc")), 408);
  EXPECT_EQ(talk(""), "") << "an idle connection is closed without a word";
  // Three limits of 0.3 s, each found by a sweep every 0.25 s; the rest is for a busy machine.
  EXPECT_LT(std::chrono::steady_clock::now() - begin, patience(4));
  EXPECT_EQ(server_->stats().timeouts, 3u);
}

TEST_F(NetServer, TooManyConnectionsGet503AndRecover) {
  start({.max_connections = 3});
  std::vector<tcp::socket> held;
  for (int i = 0; i < 3; ++i) held.push_back(connect());
  EXPECT_EQ(status(get("/ok")), 503);
  held.clear();
  int last = 0;
  const auto end = std::chrono::steady_clock::now() + patience(3);
  while (last != 200 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(5ms);
    last = status(get("/ok"));
  }
  EXPECT_EQ(last, 200);
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
