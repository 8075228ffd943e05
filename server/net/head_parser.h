// Strict, resumable parser of an HTTP/1.x request head (RFC 9112 sections 2 to 6). It reads line by line so
// that junk is refused at the first bad byte and not when a limit or a time-out is reached. What Beast's
// parser lets through is refused here: obs-fold, transfer codings other than "chunked", several Host headers,
// signs and lists in Content-Length, Transfer-Encoding in HTTP/1.0.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "server/net/message.h"

namespace truestep::net {

/// How the body of a request is delimited.
enum class Framing : uint8_t { none, length, chunked };

/// Parses one head at the front of a growing buffer.
class HeadParser {
 public:
  enum class Result { need_more, done, error };

  explicit HeadParser(size_t head_limit, size_t field_limit = 100)
      : head_limit_(head_limit), field_limit_(field_limit) {}

  /// `data` is the buffer from the request's first byte; call again with more of the same bytes.
  /// After done, `request` holds the head and `consumed` says how long it was.
  Result parse(std::string_view data, Request& request);

  size_t consumed() const { return consumed_; }
  Framing framing() const { return framing_; }
  uint64_t content_length() const { return content_length_; }
  bool keep_alive() const { return keep_alive_; }
  bool expects_continue() const { return expects_continue_; }
  bool upgrade_websocket() const { return upgrade_websocket_; }

  /// After error: the status to answer and a sentence.
  int status() const { return status_; }
  std::string_view reason() const { return reason_; }

  /// Forgets everything; ready for the next request.
  void reset();

 private:
  struct Span {
    uint32_t begin, size;
  };
  struct FieldSpan {
    Span name, value;
  };
  bool fail(int status, std::string_view reason);
  bool start_line(std::string_view line, size_t offset);
  bool field_line(std::string_view line, size_t offset);
  bool finish(std::string_view head, Request& request);
  bool interpret(const Field& field, const Request& request);

  size_t head_limit_, field_limit_;
  size_t line_ = 0;     ///< offset of the line being collected
  size_t scanned_ = 0;  ///< no line feed before this offset
  bool started_ = false;
  bool http10_ = false;
  Span method_{}, target_{};
  std::vector<FieldSpan> fields_;

  size_t consumed_ = 0;
  Framing framing_ = Framing::none;
  uint64_t content_length_ = 0;
  bool keep_alive_ = true, expects_continue_ = false, upgrade_websocket_ = false;
  bool has_length_ = false, has_coding_ = false, has_host_ = false, connection_upgrade_ = false;
  int status_ = 0;
  std::string_view reason_;
};

/// Splits and decodes request.target into segments and query; false when it is malformed: bad
/// percent-encoding, control characters, invalid UTF-8, "." or ".." segments.
bool parse_target(Request& request);

}  // namespace truestep::net
