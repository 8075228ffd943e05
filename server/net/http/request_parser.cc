#include "server/net/http/request_parser.h"

#include <algorithm>
#include <functional>

#include "server/net/http/characters.h"

namespace truestep::net {

namespace http = boost::beast::http;

namespace {

constexpr size_t kMaxFields = 100;
constexpr Characters kDigits("0123456789"), kBlanks(": \t"), kTarget = Characters::printable_but("\"<>\\^`#");
// The shortest end of a chunked body, "0" CR LF CR LF. Beast asserts that this much is there when it looks at
// a last chunk again, and no chunked body can end earlier.
constexpr size_t kLastChunk = 5;

// Whether the line before the first CR LF is well-formed except for an unsupported version.
bool asks_other_version(std::string_view head) {
  const std::string_view line = head.substr(0, head.find('\r'));
  if (line.size() < 9 || std::count(line.begin(), line.end(), ' ') != 2) return false;
  const std::string_view v = line.substr(line.size() - 9);
  return v.starts_with(" HTTP/") && v[7] == '.' && kDigits.has(v[6]) && kDigits.has(v[8]);
}

}  // namespace

bool is_target(std::string_view s) {
  return !s.empty() && kTarget.has_all_of(s);
}

bool is_authority(std::string_view s) {
  static constexpr Characters kAddress("0123456789abcdefABCDEF:."),
      kName("0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ!$%&'*+-._~");
  if (s.empty() || s.size() > 255) return false;
  const bool bracketed = s[0] == '[';
  const size_t end = bracketed ? s.find(']') : std::min(s.find(':'), s.size());
  if (end == std::string_view::npos || end == 0) return false;
  const std::string_view name = s.substr(bracketed, end - bracketed), rest = s.substr(end + bracketed);
  if (!(bracketed ? kAddress : kName).has_all_of(name)) return false;
  return rest.empty() || (rest[0] == ':' && rest.size() <= 6 && kDigits.has_all_of(rest.substr(1)));
}

RequestParser::RequestParser(Request& request, size_t head_limit)
    : request_(request), head_limit_(head_limit) {
  request_.clear();
  header_limit(static_cast<uint32_t>(head_limit));
  body_limit(boost::none);  // known once the route is
}

void RequestParser::set_body_limit(size_t limit) {
  body_limit_ = limit;
  body_limit(limit);
  eager(true);
  if (content_length().value_or(0) > limit) refuse(http::error::body_limit, {});
}

size_t RequestParser::stop(size_t used, Progress progress) {
  progress_ = progress;
  return used;
}

size_t RequestParser::feed(std::string_view data) {
  size_t used = 0;
  if (!got_some()) {
    // One empty line before a request is forgiven (RFC 9112 section 2.2).
    if (!empty_line_ && data == "\r") return stop(0, Progress::need_more);
    if (!empty_line_ && data.starts_with("\r\n")) {
      empty_line_ = true;
      used = 2;
    }
  }
  input_ = data;
  while (used < data.size()) {
    if (head_done_ && chunked() && data.size() - used < kLastChunk) break;
    error_code ec;
    used += put(boost::asio::buffer(data.substr(used)), ec);
    if (ec == http::error::need_more) {
      // Chunk headers and trailers wait in the caller's buffer until they are complete.
      if (head_done_ && data.size() - used > head_limit_) refuse(http::error::bad_chunk, {});
      break;
    }
    if (ec) refuse(ec, data.substr(used));
    if (status_ != 0) break;
    if (head_done_ && !eager()) return stop(used, Progress::head);
    if (is_done()) return stop(used, Progress::complete);
  }
  return stop(used, status_ != 0 ? Progress::refused : Progress::need_more);
}

// --- callbacks from Beast

void RequestParser::store(std::string_view text) {
  request_.head_ += text;
  request_.ends_.push_back(static_cast<uint32_t>(request_.head_.size()));
}

void RequestParser::on_request_impl(Verb, text method, text target, int version, error_code& ec) {
  request_.http10 = version == 10;
  store(method);
  store(target);
  if (!is_target(target)) refuse(400, "the target holds characters that must be percent-encoded");
  if (status_ != 0) ec = http::error::bad_target;
}

void RequestParser::on_field_impl(Name name, text name_text, text value, error_code& ec) {
  // Beast unfolds into memory of its own, or skips the first line when it is empty.
  const char* end = input_.data() + input_.size();
  const std::less<const char*> before;
  if (before(value.data(), input_.data()) || before(end, value.data()) ||
      !kBlanks.has_all_of({name_text.end(), static_cast<size_t>(value.data() - name_text.end())})) {
    refuse(400, "folded header lines are not accepted");
  } else if (!head_done_) {
    if (request_.ends_.size() > 2 * kMaxFields) refuse(431, "too many headers");
    // Beast's own limit counts from what it has parsed.
    if (request_.head_.size() + name_text.size() + value.size() > head_limit_)
      refuse(431, "the request's head is too long");
    store(name_text);
    store(value);
    check_field(name, value);
  }
  if (status_ != 0) ec = http::error::bad_field;
}

void RequestParser::on_header_impl(error_code& ec) {
  head_done_ = true;
  check_head();
  if (status_ != 0) ec = http::error::bad_field;
}

size_t RequestParser::on_body_impl(text body, error_code&) {
  request_.body += std::string_view(body);
  return body.size();
}

// --- what Beast does not check

void RequestParser::refuse(int status, std::string_view reason) {
  if (status_ != 0) return;
  status_ = status;
  reason_ = reason;
  progress_ = Progress::refused;
}

void RequestParser::refuse(error_code ec, std::string_view rest) {
  if (ec == http::error::header_limit) {
    refuse(request_.ends_.empty() ? 414 : 431, "the request's head is too long");
  } else if (ec == http::error::body_limit) {
    refuse(413, "the body is larger than " + std::to_string(body_limit_) + " bytes");
  } else if (ec == http::error::bad_version && asks_other_version(rest)) {
    refuse(505, "only HTTP/1.1 and HTTP/1.0 are supported");
  } else {
    refuse(400, "the request is malformed: " + ec.message());
  }
}

void RequestParser::check_field(Name name, std::string_view value) {
  switch (name) {
    case Name::host:
      if (has_host_) refuse(400, "more than one Host header");
      if (!is_authority(value)) refuse(400, "the Host header is malformed");
      has_host_ = true;
      break;
    case Name::expect:
      if (!iequals(value, "100-continue")) refuse(417, "the only supported expectation is 100-continue");
      expects_continue_ = !request_.http10;
      break;
    case Name::content_length:
      // Exactly one header, digits only: lists and repetitions enable request smuggling.
      if (has_length_ || !kDigits.has_all_of(value)) refuse(400, "Content-Length must be one number");
      has_length_ = true;
      break;
    case Name::transfer_encoding:
      if (request_.http10) refuse(400, "Transfer-Encoding in HTTP/1.0");
      if (!iequals(value, "chunked")) refuse(501, "only the chunked transfer coding is supported");
      break;
    default:
      break;
  }
}

void RequestParser::check_head() {
  Request& r = request_;
  const auto text = [&r](size_t i) {
    const size_t begin = i == 0 ? 0 : r.ends_[i - 1];
    return std::string_view(r.head_).substr(begin, r.ends_[i] - begin);
  };
  r.method_text = text(0);
  r.method = method_from(r.method_text);
  r.target = text(1);
  for (size_t i = 2; i < r.ends_.size(); i += 2) r.headers.push_back({text(i), text(i + 1)});
  if (!has_host_ && !r.http10) return refuse(400, "the Host header is missing");
  // Absolute form: the authority must match Host; then only path and query count.
  if (r.target.starts_with("http://") || r.target.starts_with("https://")) {
    std::string_view rest = r.target.substr(r.target.find("//") + 2);
    const size_t path = std::min(rest.find_first_of("/?"), rest.size());
    if (has_host_ && !iequals(rest.substr(0, path), r.header("host")))
      return refuse(400, "target and Host disagree");
    rest.remove_prefix(path);
    r.target = rest.empty() ? std::string_view("/") : rest;
  }
  if (r.target[0] != '/' && !(r.target == "*" && r.method == Method::options))
    return refuse(400, "the target is not a path");
  if (!split_target(r)) refuse(400, "the target's path or query is malformed");
}

}  // namespace truestep::net
