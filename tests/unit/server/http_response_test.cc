// Conditions and ranges, the table of routes, problems, digests.
#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <string>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "server/net/access/digest.h"
#include "server/net/http/problem.h"
#include "server/net/http/request_parser.h"
#include "server/net/http/response_head.h"
#include "server/net/http/router.h"
#include "server/net/websocket/handshake.h"

namespace truestep::net {
namespace {

// Fills `request` from a request line's target and header lines.
void fill(Request& request, const std::string& target, const std::string& headers = "",
          const std::string& method = "GET") {
  RequestParser parser(request, 16384);
  parser.feed(method + " " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n");
  ASSERT_EQ(parser.progress(), RequestParser::Progress::head);
}

Response conditioned(const std::string& headers) {
  Request request;
  fill(request, "/", headers);
  Response r = Response::shared(std::make_shared<const std::string>("0123456789"), "text/plain", "\"v1\"");
  apply_conditions(request, r);
  return r;
}
std::string part(const Response& r) {
  return std::string(r.body_bytes().substr(r.offset, r.length.value_or(r.body_size())));
}

TEST(Conditions, RangesAndTags) {
  EXPECT_EQ(conditioned("").status, 200);
  EXPECT_EQ(conditioned("If-None-Match: \"v0\", W/\"v1\"\r\n").status, 304);
  EXPECT_EQ(conditioned("If-None-Match: *\r\n").status, 304);
  EXPECT_EQ(conditioned("If-None-Match: \"v2\"\r\n").status, 200);
  const std::tuple<std::string, int, std::string> ranges[] = {{"bytes=2-4", 206, "234"},
                                                              {"bytes=7-", 206, "789"},
                                                              {"bytes=-3", 206, "789"},
                                                              {"bytes=-30", 206, "0123456789"},
                                                              {"bytes=0-99", 206, "0123456789"},
                                                              {"bytes=10-", 416, ""},
                                                              {"bytes=-0", 416, ""},
                                                              {"bytes=4-2", 200, "0123456789"},
                                                              {"bytes=1-2,4-5", 200, "0123456789"},
                                                              {"lines=1-2", 200, "0123456789"},
                                                              {"bytes=x-2", 200, "0123456789"}};
  for (const auto& [range, status, body] : ranges) {
    const Response r = conditioned("Range: " + range + "\r\n");
    EXPECT_EQ(r.status, status) << range;
    EXPECT_EQ(part(r), body) << range;
  }
  EXPECT_EQ(conditioned("Range: bytes=1-2\r\nIf-Range: \"v1\"\r\n").status, 206);
  EXPECT_EQ(conditioned("Range: bytes=1-2\r\nIf-Range: \"v0\"\r\n").status, 200);
  EXPECT_NE(conditioned("Range: bytes=99-\r\n").header_block().find("Content-Range: bytes */10"),
            std::string::npos);
}

Response reply(const Request&) {
  return Response(200);
}

TEST(Router, FindsRowsAndNamesTheOthers) {
  Router router;
  router.add(Method::get, "/", "root", reply);
  router.add(Method::get, "/v1/sessions/{id}", "one", reply);
  router.add(Method::delete_, "/v1/sessions/{id}", "delete", reply);
  router.add(Method::get, "/v1/sessions/latest", "literal wins", reply);
  router.add(Method::post, "/v1/sessions/{id}/step", "step", reply);
  router.add(Method::get, "/files/{path...}", "rest", reply);
  Request r;
  const auto find = [&](const std::string& target, const std::string& method = "GET") {
    fill(r, target, "", method);
    return router.find(r);
  };
  EXPECT_EQ(find("/").route->summary, "root");
  EXPECT_EQ(find("/v1/sessions/abc").route->summary, "one");
  EXPECT_EQ(r.param("id"), "abc");
  EXPECT_EQ(find("/v1/sessions/abc", "HEAD").route->summary, "one");
  EXPECT_EQ(find("/v1/sessions/latest").route->summary, "literal wins");
  EXPECT_EQ(find("/v1/sessions/latest/step", "POST").route->summary, "step")
      << "a literal that leads nowhere is left again";
  EXPECT_EQ(r.param("id"), "latest");
  EXPECT_EQ(find("/files/a/b.js?x").route->summary, "rest");
  EXPECT_EQ(r.param("path"), "a/b.js");
  EXPECT_FALSE(find("/v1/sessions").path_known);
  EXPECT_FALSE(find("/v1/sessions/").path_known);
  EXPECT_FALSE(find("/v1/sessions/abc/step/x").path_known);
  EXPECT_EQ(find("/v1/sessions/abc", "PUT").allow, "GET, HEAD, DELETE, OPTIONS");
  EXPECT_THROW(router.add(Method::get, "/v1/sessions/{id}", "twice", reply), Error);
  EXPECT_THROW(router.add(Method::get, "/v1/sessions/{other}/x", "two names", reply), Error);
}

TEST(Problem, HasTheMembersOfTheStandardAndOurs) {
  Request r;
  fill(r, "/v1/x", "traceparent: 00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01\r\n");
  Issue issue{.pointer = "/time/dt",
              .code = "out_of_range",
              .message = "m",
              .value = "-1",
              .allowed = "> 0",
              .did_you_mean = "",
              .unit = "s"};
  const Response response = problem(r, Error("scene_invalid", "one error", {issue}));
  EXPECT_EQ(response.status, 422);
  EXPECT_EQ(response.content_type, "application/problem+json");
  const auto o = boost::json::parse(std::string(response.body_bytes())).as_object();
  EXPECT_EQ(o.at("code"), "scene_invalid");
  EXPECT_EQ(o.at("status"), 422);
  EXPECT_EQ(o.at("instance"), "/v1/x");
  EXPECT_EQ(o.at("trace_id"), "4bf92f3577b34da6a3ce929d0e0e4736");
  EXPECT_EQ(o.at("errors").at(0).at("pointer"), "/time/dt");
  EXPECT_EQ(o.at("errors").at(0).at("value"), -1);
  const Response internal = problem(r, Error("no_such_code", "secret path"));
  EXPECT_EQ(internal.status, 500);
  EXPECT_EQ(internal.body_bytes().find("secret"), std::string_view::npos)
      << "internal errors show their trace id only";
  EXPECT_EQ(problem(r, Interrupted()).status, 503) << "work that ends with the service";
}

TEST(ResponseHead, CannotBeInjected) {
  Response r = Response::json("{}");
  r.header("X-Note", "a\r\nSet-Cookie: b");
  std::string head;
  append_head(head, r, 2, ConnectionFate::keep);
  EXPECT_EQ(head.find("\nSet-Cookie"), std::string::npos);
  EXPECT_NE(head.find("Content-Length: 2\r\n"), std::string::npos);
  EXPECT_TRUE(head.starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
}

TEST(Digest, KnownAnswers) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_NE(random_hex128(), random_hex128());
  EXPECT_TRUE(equal_constant_time("ab", "ab"));
  EXPECT_FALSE(equal_constant_time("ab", "ac"));
  EXPECT_FALSE(equal_constant_time("ab", "abc"));
  EXPECT_TRUE(equal_constant_time({}, ""));
}

TEST(Handshake, WhatBeastDoesNotCheck) {
  EXPECT_TRUE(is_websocket_key("dGhlIHNhbXBsZSBub25jZQ==")) << "RFC 6455 section 1.3";
  for (const char* bad :
       {"", "YWJj", "dGhlIHNhbXBsZSBub25jZR==", "dGhlIHNhbXBsZSBub25jZQ=A",
        "dGhlIHNhbXBsZSBub25jZQQ=", "dGhl IHNhbXBsZSBub25jZQ==", "========================"})
    EXPECT_FALSE(is_websocket_key(bad)) << bad;
  EXPECT_TRUE(is_deflate_offer_safe("permessage-deflate; server_max_window_bits=9, x-other; a=8"));
  EXPECT_FALSE(is_deflate_offer_safe("permessage-deflate; server_max_window_bits=8"));
  EXPECT_FALSE(is_deflate_offer_safe("x, permessage-deflate; Server_Max_Window_Bits=\"8\""));
}

}  // namespace
}  // namespace truestep::net
