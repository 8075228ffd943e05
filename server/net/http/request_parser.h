// One HTTP/1.x request: Boost.Beast parses it, and what Beast lets through is refused here (RFC 9112 sections
// 2 to 7): obs-fold, transfer codings other than "chunked", several Host headers, repeated and listed
// Content-Length, Transfer-Encoding in HTTP/1.0, characters that a target must encode, and unbounded chunk
// headers and trailers. Trailer fields are parsed and dropped, so they cannot change a header.
#pragma once
#include <boost/beast/http/basic_parser.hpp>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/net/http/message.h"

namespace truestep::net {

/// Printable ASCII without what RFC 3986 forbids everywhere and browsers do send encoded.
bool is_target(std::string_view text);
/// Host or host:port with a name, an IPv4 address or a bracketed IPv6 address.
bool is_authority(std::string_view text);
/// Splits and decodes request.target into segments and query; false when it is malformed: bad
/// percent-encoding, control characters, invalid UTF-8, "." or ".." segments.
bool split_target(Request& request);

/// Parses one request; a new one is made for the next.
class RequestParser final : public boost::beast::http::basic_parser<true> {
 public:
  /// After `head` the request is complete but for its body: call set_body_limit, then feed again if
  /// has_body().
  enum class Progress : uint8_t { need_more, head, complete, refused };

  /// Clears `request` and fills it; `head_limit` in bytes.
  RequestParser(Request& request, size_t head_limit);

  /// Takes bytes from the front of `data` and returns how many; the rest must be passed again together with
  /// what follows.
  size_t feed(std::string_view data);
  Progress progress() const { return progress_; }

  bool has_body() const { return !is_done(); }
  bool expects_continue() const { return expects_continue_; }
  /// Refuses a body that is announced to be longer than `limit` bytes, or becomes longer.
  void set_body_limit(size_t limit);

  /// After refused: the status to answer and a sentence.
  int status() const { return status_; }
  const std::string& reason() const { return reason_; }

 private:
  using error_code = boost::beast::error_code;
  using text = boost::beast::string_view;
  using Name = boost::beast::http::field;
  using Verb = boost::beast::http::verb;

  void on_request_impl(Verb, text method, text target, int version, error_code& ec) override;
  void on_field_impl(Name name, text name_text, text value, error_code& ec) override;
  void on_header_impl(error_code& ec) override;
  void on_body_init_impl(const boost::optional<uint64_t>&, error_code&) override {}
  size_t on_body_impl(text body, error_code& ec) override;
  void on_chunk_header_impl(uint64_t, text, error_code&) override {}
  size_t on_chunk_body_impl(uint64_t, text body, error_code& ec) override { return on_body_impl(body, ec); }
  void on_response_impl(int, text, int, error_code&) override {}
  void on_finish_impl(error_code&) override {}

  void refuse(int status, std::string_view reason);
  void refuse(error_code ec, std::string_view rest);
  void check_field(Name name, std::string_view value);
  void check_head();
  void store(std::string_view text);
  size_t stop(size_t used, Progress progress);

  Request& request_;
  size_t head_limit_, body_limit_ = 0;
  Progress progress_ = Progress::need_more;
  bool empty_line_ = false;  ///< an empty line before the request was skipped
  bool has_host_ = false, has_length_ = false, expects_continue_ = false, head_done_ = false;
  std::string_view input_;  ///< what feed was given, to recognise folded values
  int status_ = 0;
  std::string reason_;
};

}  // namespace truestep::net
