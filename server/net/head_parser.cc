#include "server/net/head_parser.h"

#include <array>
#include <cstring>

namespace truestep::net {
namespace {

// tchar of RFC 9110 section 5.6.2.
constexpr std::array<bool, 256> make_token_table() {
  std::array<bool, 256> t{};
  for (int c = '0'; c <= '9'; ++c) t[c] = true;
  for (int c = 'a'; c <= 'z'; ++c) t[c] = t[c - 32] = true;
  for (const char c : std::string_view("!#$%&'*+-.^_`|~")) t[static_cast<unsigned char>(c)] = true;
  return t;
}
constexpr auto kToken = make_token_table();

bool is_token(std::string_view s) {
  for (const char c : s) {
    if (!kToken[static_cast<unsigned char>(c)]) return false;
  }
  return !s.empty();
}

// VCHAR without the characters that RFC 3986 forbids everywhere and browsers do send encoded.
bool is_target(std::string_view s) {
  for (const char c : s) {
    const auto u = static_cast<unsigned char>(c);
    if (u <= 0x20 || u >= 0x7F || u == '"' || u == '<' || u == '>' || u == '\\' || u == '^' || u == '`' ||
        u == '#')
      return false;
  }
  return !s.empty();
}

bool is_field_value(std::string_view s) {
  for (const char c : s) {
    const auto u = static_cast<unsigned char>(c);
    if ((u < 0x20 && u != '\t') || u == 0x7F) return false;
  }
  return true;
}

// Host or host:port with a reg-name, an IPv4 address or a bracketed IPv6 address.
bool is_authority(std::string_view s) {
  if (s.empty() || s.size() > 255) return false;
  size_t end = 0;
  if (s[0] == '[') {
    end = s.find(']');
    if (end == std::string_view::npos ||
        s.substr(1, end - 1).find_first_not_of("0123456789abcdefABCDEF:.") != std::string_view::npos)
      return false;
    ++end;
  } else {
    while (end < s.size() && (kToken[static_cast<unsigned char>(s[end])])) ++end;
    if (end == 0) return false;
  }
  if (end == s.size()) return true;
  if (s[end] != ':') return false;
  const std::string_view port = s.substr(end + 1);
  return port.size() <= 5 && port.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

void HeadParser::reset() {
  line_ = scanned_ = consumed_ = 0;
  started_ = http10_ = false;
  fields_.clear();
  framing_ = Framing::none;
  content_length_ = 0;
  keep_alive_ = true;
  expects_continue_ = upgrade_websocket_ = false;
  has_length_ = has_coding_ = has_host_ = connection_upgrade_ = false;
  status_ = 0;
}

bool HeadParser::fail(int status, std::string_view reason) {
  status_ = status;
  reason_ = reason;
  return false;
}

HeadParser::Result HeadParser::parse(std::string_view data, Request& request) {
  for (;;) {
    const std::string_view window = data.substr(0, std::min(data.size(), head_limit_));
    const void* found = scanned_ < window.size()
                            ? std::memchr(window.data() + scanned_, '\n', window.size() - scanned_)
                            : nullptr;
    if (!found) {
      scanned_ = window.size();
      if (data.size() >= head_limit_) {
        fail(started_ ? 431 : 414, "the request's head is too long");
        return Result::error;
      }
      // The first byte tells a request from TLS and other protocols before any line is complete.
      if (!started_ && line_ < data.size() && data[line_] != '\r' &&
          !kToken[static_cast<unsigned char>(data[line_])]) {
        fail(400, "not an HTTP request");
        return Result::error;
      }
      return Result::need_more;
    }
    const size_t feed = static_cast<size_t>(static_cast<const char*>(found) - data.data());
    if (feed == line_ || data[feed - 1] != '\r') {
      fail(400, "a line does not end in CR LF");
      return Result::error;
    }
    const size_t begin = line_;
    const std::string_view line = data.substr(begin, feed - 1 - begin);
    line_ = scanned_ = feed + 1;
    if (line.empty()) {
      if (!started_) {
        // One empty line before a request is forgiven (RFC 9112 section 2.2).
        if (begin == 0) continue;
        fail(400, "empty lines instead of a request");
        return Result::error;
      }
      consumed_ = line_;
      return finish(data.substr(0, line_), request) ? Result::done : Result::error;
    }
    const bool good = started_ ? field_line(line, begin) : start_line(line, begin);
    if (!good) return Result::error;
    started_ = true;
  }
}

bool HeadParser::start_line(std::string_view line, size_t offset) {
  const size_t first = line.find(' ');
  const size_t last = line.rfind(' ');
  if (first == std::string_view::npos || first == last)
    return fail(400, "the request line needs method, target and version");
  const std::string_view method = line.substr(0, first), target = line.substr(first + 1, last - first - 1),
                         version = line.substr(last + 1);
  if (!is_token(method)) return fail(400, "the method is not a token");
  if (method.size() > 32) return fail(501, "the method is unknown");
  if (version == "HTTP/1.0") {
    http10_ = true;
  } else if (version != "HTTP/1.1") {
    const bool well_formed = version.size() == 8 && version.starts_with("HTTP/") && version[6] == '.';
    return well_formed ? fail(505, "only HTTP/1.1 and HTTP/1.0 are spoken here")
                       : fail(400, "the version is malformed");
  }
  if (!is_target(target)) return fail(400, "the target holds characters that must be percent-encoded");
  method_ = {static_cast<uint32_t>(offset), static_cast<uint32_t>(first)};
  target_ = {static_cast<uint32_t>(offset + first + 1), static_cast<uint32_t>(target.size())};
  return true;
}

bool HeadParser::field_line(std::string_view line, size_t offset) {
  if (line[0] == ' ' || line[0] == '\t') return fail(400, "folded header lines are not accepted");
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon)))
    return fail(400, "a header's name is not a token followed by a colon");
  const std::string_view value = trim(line.substr(colon + 1));
  if (!is_field_value(value)) return fail(400, "a header's value holds a control character");
  if (fields_.size() == field_limit_) return fail(431, "too many headers");
  const auto value_begin = static_cast<uint32_t>(offset + static_cast<size_t>(value.data() - line.data()));
  fields_.push_back({{static_cast<uint32_t>(offset), static_cast<uint32_t>(colon)},
                     {value_begin, static_cast<uint32_t>(value.size())}});
  return true;
}

bool HeadParser::finish(std::string_view head, Request& request) {
  request.clear();
  request.head_.assign(head);
  const char* text = request.head_.data();
  request.method_text = {text + method_.begin, method_.size};
  request.method = method_from(request.method_text);
  request.target = {text + target_.begin, target_.size};
  request.http10 = http10_;
  keep_alive_ = !http10_;
  request.headers.reserve(fields_.size());
  for (const FieldSpan& f : fields_) {
    request.headers.push_back({{text + f.name.begin, f.name.size}, {text + f.value.begin, f.value.size}});
    if (!interpret(request.headers.back(), request)) return false;
  }
  if (!has_host_ && !http10_) return fail(400, "the Host header is missing");
  if (has_coding_ && has_length_) return fail(400, "Content-Length and Transfer-Encoding together");
  upgrade_websocket_ = upgrade_websocket_ && connection_upgrade_ && !http10_;
  // Absolute form: the authority must be the one that Host names, then only path and query count.
  if (request.target.starts_with("http://") || request.target.starts_with("https://")) {
    std::string_view rest = request.target.substr(request.target.find("//") + 2);
    const size_t path = std::min(rest.find_first_of("/?"), rest.size());
    if (has_host_ && !iequals(rest.substr(0, path), request.header("host")))
      return fail(400, "target and Host disagree");
    rest.remove_prefix(path);
    request.target = rest.empty() ? std::string_view("/") : rest;
  }
  if (request.target[0] != '/' && !(request.target == "*" && request.method == Method::options))
    return fail(400, "the target is not a path");
  if (!parse_target(request)) return fail(400, "the target's path or query is malformed");
  return true;
}

bool HeadParser::interpret(const Field& f, const Request& request) {
  switch (f.name.size()) {
    case 4:
      if (iequals(f.name, "host")) {
        if (has_host_) return fail(400, "more than one Host header");
        if (!is_authority(f.value)) return fail(400, "the Host header is malformed");
        has_host_ = true;
      }
      break;
    case 6:
      if (iequals(f.name, "expect")) {
        if (!iequals(f.value, "100-continue")) return fail(417, "only 100-continue can be expected");
        expects_continue_ = !http10_;
      }
      break;
    case 7:
      if (iequals(f.name, "upgrade"))
        upgrade_websocket_ = upgrade_websocket_ || request.header_has_token("upgrade", "websocket");
      break;
    case 10:
      if (iequals(f.name, "connection")) {
        if (request.header_has_token("connection", "close")) keep_alive_ = false;
        if (http10_ && request.header_has_token("connection", "keep-alive")) keep_alive_ = true;
        if (request.header_has_token("connection", "upgrade")) connection_upgrade_ = true;
      }
      break;
    case 14:
      if (iequals(f.name, "content-length")) {
        // One header with digits only: lists and repetitions are how smuggling starts.
        if (has_length_) return fail(400, "more than one Content-Length");
        if (f.value.empty() || f.value.size() > 19)
          return fail(400, "Content-Length is not a number that fits");
        for (const char c : f.value) {
          if (c < '0' || c > '9') return fail(400, "Content-Length is not a number");
          content_length_ = content_length_ * 10 + static_cast<uint64_t>(c - '0');
        }
        has_length_ = true;
        framing_ = content_length_ ? Framing::length : Framing::none;
      }
      break;
    case 17:
      if (iequals(f.name, "transfer-encoding")) {
        if (has_coding_ || http10_) return fail(400, "Transfer-Encoding twice or in HTTP/1.0");
        if (!iequals(f.value, "chunked")) return fail(501, "only the chunked transfer coding is understood");
        has_coding_ = true;
        framing_ = Framing::chunked;
      }
      break;
    default:
      break;
  }
  return true;
}

}  // namespace truestep::net
