// The request parser: what is accepted, what is refused with which status, and that the splitting of the
// bytes does not matter. Most refusals here concern what Beast's parser alone lets through.
#include <gtest/gtest.h>

#include <string>

#include "server/net/http/request_parser.h"

namespace truestep::net {
namespace {

constexpr size_t kLimit = 16384;

using Progress = RequestParser::Progress;

// Status of the refusal, 0 if the head is accepted, -1 if more is needed.
int verdict(const std::string& text, Request& request) {
  RequestParser parser(request, kLimit);
  parser.feed(text);
  return parser.progress() == Progress::need_more ? -1 : parser.status();
}
int verdict(const std::string& text) {
  Request r;
  return verdict(text, r);
}
std::string with(const std::string& headers, const std::string& line = "GET / HTTP/1.1") {
  return line + "\r\nHost: localhost:8080\r\n" + headers + "\r\n";
}

TEST(RequestParser, SplitsTargetAndHeaders) {
  Request r;
  ASSERT_EQ(verdict(with("X-A:  b c \r\nAccept: application/json;q=0.5, */*\r\n",
                         "GET /v1/a%2Fb/c?x=1&y=a+b%26&z HTTP/1.1"),
                    r),
            0);
  ASSERT_EQ(r.segments.size(), 3u);
  EXPECT_EQ(r.segments[1], "a/b") << "an encoded slash is data";
  EXPECT_EQ(r.query_value("y"), "a b&");
  EXPECT_EQ(r.query_value("z"), "");
  EXPECT_FALSE(r.query_value("w"));
  EXPECT_EQ(r.header("x-a"), "b c");
  EXPECT_TRUE(r.accepts("image/png"));
  ASSERT_EQ(verdict(with("Accept: image/*;q=0, application/json\r\n"), r), 0);
  EXPECT_FALSE(r.accepts("image/png"));
  EXPECT_TRUE(r.accepts("application/json"));
  EXPECT_TRUE(r.segments.empty());
  ASSERT_EQ(verdict(with("", "GET http://localhost:8080/x HTTP/1.1"), r), 0);
  EXPECT_EQ(r.segments.at(0), "x");
}

TEST(RequestParser, RefusesWithAStatus) {
  const std::pair<std::string, int> cases[] = {
      {"GET / HTTP/1.1\r\n\r\n", 400},
      {"GET / HTTP/2.0\r\nHost: a\r\n\r\n", 505},
      {"GET /\r\n\r\n", 400},
      {"GET / http/1.1\r\nHost: a\r\n\r\n", 400},
      {"GET /a b HTTP/1.1\r\nHost: a\r\n\r\n", 400},
      {"GET / HTTP/1.1\nHost: a\n\n", 400},
      {"\x16\x03\x01", 400},
      {"\r\n\r\nGET", 400},
      {with("Host: b\r\n"), 400},
      {with("X: a\r\n b\r\n"), 400},
      {with("X:\r\n b\r\n"), 400},
      {with("X:\r\n \r\n"), 400},
      {with("X: a\r\n \r\n"), 400},
      {with("X : a\r\n"), 400},
      {with(": a\r\n"), 400},
      {with(std::string("X: a\0b\r\n", 8)), 400},
      {with("X: a\rb\r\n"), 400},
      {with("Content-Length: 5\r\nContent-Length: 5\r\n"), 400},
      {with("Content-Length: +5\r\n"), 400},
      {with("Content-Length: 5, 5\r\n"), 400},
      {with("Content-Length: \r\n"), 400},
      {with("Content-Length: 99999999999999999999\r\n"), 400},
      {with("Transfer-Encoding: chunked\r\nContent-Length: 4\r\n"), 400},
      {with("Transfer-Encoding: gzip, chunked\r\n"), 501},
      {with("Transfer-Encoding: chunked\r\n", "POST / HTTP/1.0"), 400},
      {with("Expect: 200-maybe\r\n"), 417},
      {with("", "GET /%zz HTTP/1.1"), 400},
      {with("", "GET /%00 HTTP/1.1"), 400},
      {with("", "GET /a/../b HTTP/1.1"), 400},
      {with("", "GET /%2e%2e/b HTTP/1.1"), 400},
      {with("", "GET /%ff HTTP/1.1"), 400},
      {with("", "GET http://evil.example/ HTTP/1.1"), 400},
      {with("", "CONNECT a:1 HTTP/1.1"), 400},
      {"GET /" + std::string(70000, 'a'), 414},
      {with("X: " + std::string(70000, 'a')), 431},
      {"GET / HTTP/1.1\r\nHost: a b@c\r\n\r\n", 400}};
  for (const auto& [text, status] : cases) EXPECT_EQ(verdict(text), status) << text.substr(0, 80);
  std::string many = "GET / HTTP/1.1\r\nHost: a\r\n";
  for (int i = 0; i < 200; ++i) many += "X: y\r\n";
  EXPECT_EQ(verdict(many + "\r\n"), 431);
  EXPECT_EQ(verdict("\r\n" + with("")), 0) << "one empty line before a request is forgiven";
  EXPECT_EQ(verdict("GET / HTT"), -1);
}

// Feeds the text in pieces as a connection does: what was not consumed is passed again with the next piece.
// Returns the status of the refusal, 0 if the request is complete, -1 if more is needed.
int feed(const std::string& text, size_t piece, size_t limit, Request& request, size_t& used) {
  RequestParser parser(request, kLimit);
  used = 0;
  for (size_t end = std::min(piece, text.size());; end = std::min(end + piece, text.size())) {
    for (bool again = true; again;) {
      // A copy per call: the buffer may move between two reads.
      const std::string part = text.substr(used, end - used);
      used += parser.feed(part);
      again = parser.progress() == Progress::head && parser.has_body() && !parser.eager();
      if (again) parser.set_body_limit(limit);
      if (parser.status() != 0) return parser.status();
    }
    if (parser.progress() != Progress::need_more) return 0;
    if (end == text.size()) return -1;
  }
}

TEST(RequestParser, CutsDoNotMatter) {
  const std::string text =
      with("Content-Length: 12\r\nConnection: keep-alive, Upgrade\r\nUpgrade: WebSocket\r\n",
           "POST /a?b=c HTTP/1.1") +
      "hello world!";
  for (const size_t piece : {1u, 2u, 7u, 100000u}) {
    Request r;
    size_t used = 0;
    ASSERT_EQ(feed(text + "GET", piece, 100, r, used), 0) << piece;
    EXPECT_EQ(used, text.size());
    EXPECT_EQ(r.method, Method::post);
    EXPECT_EQ(r.body, "hello world!");
    EXPECT_EQ(r.headers.size(), 4u);
    EXPECT_TRUE(r.header_has_token("upgrade", "websocket"));
    EXPECT_EQ(feed(text.substr(0, text.size() - 1), piece, 100, r, used), -1);
    EXPECT_EQ(feed(text, piece, 11, r, used), 413);
  }
}

TEST(RequestParser, ChunkedBodies) {
  const std::pair<std::string, int> cases[] = {{"5\r\nhello\r\n0\r\n\r\n", 0},
                                               {"5;a=b\r\nhello\r\n0\r\nX: y\r\n\r\n", 0},
                                               {"A\r\n0123456789\r\n0\r\n\r\n", 0},
                                               {"5\r\nhello\r\n0\r\nX: y\r\n z\r\n\r\n", 400},
                                               {"-5\r\nhello\r\n", 400},
                                               {"0x5\r\nhello\r\n\r\n", 400},
                                               {"\r\nhello", 400},
                                               {"5 5\r\nhello", 400},
                                               {"5\nhello\r\n", 400},
                                               {"5;a\nb\r\nhello", 400},
                                               {"5\r\nhelloXX0\r\n\r\n", 400},
                                               {"10000000000000005\r\nhello", 400},
                                               {"3E9\r\n", 413},
                                               {"3E8\r\n", -1},
                                               {"5;" + std::string(2 * kLimit, 'a'), 400},
                                               {"0\r\n" + std::string(2 * kLimit, 'a'), 400}};
  for (const auto& [text, status] : cases) {
    for (const size_t piece : {1u, 3u, 100000u}) {
      Request r;
      size_t used = 0;
      EXPECT_EQ(feed(with("Transfer-Encoding: chunked\r\n", "POST / HTTP/1.1") + text, piece, 1000, r, used),
                status)
          << text.substr(0, 40) << " in pieces of " << piece;
    }
  }
  Request r;
  size_t used = 0;
  const std::string text = "5\r\nhello\r\n6\r\n world\r\n0\r\nHost: evil\r\n\r\n";
  EXPECT_EQ(feed(with("Transfer-Encoding: chunked\r\n", "POST / HTTP/1.1") + text, 1, 11, r, used), 0);
  EXPECT_EQ(r.body, "hello world");
  EXPECT_EQ(r.header("host"), "localhost:8080") << "trailers change no header";
}

}  // namespace
}  // namespace truestep::net
