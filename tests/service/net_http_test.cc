// Requests and responses: order, routes, bodies, files, long polls.
#include "tests/service/net_server.h"
#include "tests/support/patience.h"

namespace truestep::net {
namespace {

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

TEST_F(NetServer, LongPollIsWokenBySignalAndEndedByStop) {
  start();
  std::string woken, ended;
  std::jthread first([&] { woken = get("/poll"); });
  while (woken.empty() && server_->stats().requests < 1) std::this_thread::sleep_for(1ms);
  // The handler may not be waiting yet when the request is counted: notify until it has answered.
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
  EXPECT_LT(std::chrono::steady_clock::now() - begin, patience(0.75))
      << "stopping does not wait for the poll's own 20 s";
  second.join();
  EXPECT_EQ(body(ended), "timeout");
}

}  // namespace
}  // namespace truestep::net
