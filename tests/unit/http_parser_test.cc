// The request parser: what is a request, what is refused with which status, and that it makes no difference
// how the bytes were cut on their way.
#include <gtest/gtest.h>

#include <string>

#include "server/net/chunk_decoder.h"
#include "server/net/head_parser.h"

namespace truestep::net {
namespace {

constexpr size_t kLimit = 16384;

// Status of the refusal, 0 when the head is accepted, -1 when more is awaited.
int verdict(const std::string& text, Request& request) {
  HeadParser parser(kLimit);
  switch (parser.parse(text, request)) {
    case HeadParser::Result::done:
      return 0;
    case HeadParser::Result::error:
      return parser.status();
    default:
      return -1;
  }
}
int verdict(const std::string& text) {
  Request r;
  return verdict(text, r);
}
std::string with(const std::string& headers, const std::string& line = "GET / HTTP/1.1") {
  return line + "\r\nHost: localhost:8080\r\n" + headers + "\r\n";
}

TEST(HeadParser, SplitsTargetAndHeaders) {
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

TEST(HeadParser, RefusesWithAStatus) {
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

TEST(HeadParser, CutsDoNotMatter) {
  const std::string text =
      with("Content-Length: 12\r\nConnection: keep-alive, Upgrade\r\nUpgrade: WebSocket\r\n",
           "POST /a?b=c HTTP/1.1");
  HeadParser parser(kLimit);
  Request r;
  for (size_t n = 0; n < text.size(); ++n) {
    // A copy per call: the buffer may move between two reads.
    const std::string part = text.substr(0, n);
    ASSERT_EQ(parser.parse(part, r), HeadParser::Result::need_more) << n;
  }
  ASSERT_EQ(parser.parse(text + "body", r), HeadParser::Result::done);
  EXPECT_EQ(parser.consumed(), text.size());
  EXPECT_EQ(parser.content_length(), 12u);
  EXPECT_TRUE(parser.upgrade_websocket());
  EXPECT_EQ(r.method, Method::post);
}

// Result and body of a chunked text fed in pieces of the given size.
std::pair<ChunkDecoder::Result, std::string> decode(const std::string& text, size_t piece,
                                                    size_t limit = 1000) {
  ChunkDecoder decoder(limit);
  std::string body;
  for (size_t i = 0; i < text.size(); i += piece) {
    size_t used = 0;
    const auto r = decoder.feed(std::string_view(text).substr(i, piece), body, used);
    if (r != ChunkDecoder::Result::need_more) return {r, body};
  }
  return {ChunkDecoder::Result::need_more, body};
}

TEST(ChunkDecoder, AcceptsAndRefuses) {
  using R = ChunkDecoder::Result;
  const std::pair<std::string, R> cases[] = {{"5\r\nhello\r\n0\r\n\r\n", R::done},
                                             {"5;a=b\r\nhello\r\n0\r\nX: y\r\n\r\n", R::done},
                                             {"A\r\n0123456789\r\n0\r\n\r\n", R::done},
                                             {"-5\r\nhello\r\n", R::bad},
                                             {"0x5\r\nhello\r\n", R::bad},
                                             {"\r\nhello", R::bad},
                                             {"5 5\r\nhello", R::bad},
                                             {"5\nhello", R::bad},
                                             {"5;a\nb\r\nhello", R::bad},
                                             {"5\r\nhelloXX0\r\n\r\n", R::bad},
                                             {"10000000000000005\r\nhello", R::too_large},
                                             {"3E9\r\n", R::too_large},
                                             {"5;" + std::string(10000, 'a'), R::bad}};
  for (const auto& [text, result] : cases) {
    for (const size_t piece : {1u, 3u, 100000u})
      EXPECT_EQ(decode(text, piece).first, result) << text.substr(0, 40);
  }
  EXPECT_EQ(decode("5\r\nhello\r\n6\r\n world\r\n0\r\n\r\n", 1).second, "hello world");
  EXPECT_EQ(decode("3E8\r\n", 1).first, R::need_more) << "the limit itself is allowed";
}

}  // namespace
}  // namespace truestep::net
