// What a handler sees and answers: one HTTP request with its target already split and decoded, and one
// response. Texts of a Request are views into storage that the request owns and the connection reuses, so a
// handler that keeps one beyond its answer copies it.
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "server/tasks/task.h"

namespace truestep::net {

/// Content that many responses and frames share without copying.
using SharedBuffer = std::shared_ptr<const std::string>;

enum class Method : uint8_t { get, head, post, put, patch, delete_, options, other };
inline constexpr size_t kMethods = 8;

/// Upper-case name as sent on the wire; "" for other.
std::string_view method_name(Method m);
Method method_from(std::string_view name);

struct Field {
  std::string_view name, value;
};

/// Who is asking, and how much of other callers' data is visible.
struct Caller {
  std::string name;  ///< of the presented key; empty when no keys are required
  enum class Scope : uint8_t { own, all } scope = Scope::all;
  bool may_see(std::string_view owner) const { return scope == Scope::all || owner == name; }
};

/// One request. The connection fills it in; handlers only read.
class Request {
 public:
  Request() = default;
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;

  Method method = Method::other;
  std::string_view method_text;            ///< as sent
  std::string_view target;                 ///< path and query as sent
  std::string_view raw_path;               ///< the target up to '?', not decoded
  std::vector<std::string_view> segments;  ///< path between '/', percent-decoded; "/" has none
  std::vector<Field> query;                ///< decoded name and value in the order sent
  std::vector<Field> headers;              ///< in the order sent, values trimmed
  std::vector<Field> params;               ///< what the pattern's {names} matched
  std::string body;                        ///< complete, chunked coding already undone
  std::string_view remote;                 ///< address and port of the peer
  Caller caller;                           ///< everybody when no keys are required
  std::string key_digest;                  ///< of the presented key; empty without one
  std::chrono::system_clock::time_point received;
  bool http10 = false;

  /// First value of a header, name compared without case; empty when absent.
  std::string_view header(std::string_view name) const;
  bool has_header(std::string_view name) const;
  /// First value of a query parameter; nullopt when absent.
  std::optional<std::string_view> query_value(std::string_view name) const;
  /// What {name} in the route's pattern matched; empty when the pattern has no such name.
  std::string_view param(std::string_view name) const;
  /// Whether the list-valued header `name` holds this token (case-insensitive, parameters ignored).
  bool header_has_token(std::string_view name, std::string_view token) const;
  /// Whether the client accepts this media type (RFC 9110 section 12.5.1; no header accepts all).
  bool accepts(std::string_view media_type) const;
  /// 32 hexadecimal digits that name this request in logs and problems: the client's traceparent or random.
  const std::string& trace_id() const;

  void clear();

 private:
  friend class RequestParser;
  friend bool split_target(Request& request);
  std::string head_;            // owns the texts as sent: method, target, names and values
  std::vector<uint32_t> ends_;  // of the texts in head_
  std::string decoded_;         // owns what percent-decoding changed
  mutable std::string trace_id_;
};

/// Bytes of an open file; the descriptor closes with the last copy.
class FileBody {
 public:
  /// Takes a file that is open for reading; Error "not_found" when it is none (negative) or no regular file.
  static FileBody of(int fd);
  int fd() const { return *fd_; }
  uint64_t size() const { return size_; }
  /// Strong validator from inode, size and modification time, quoted.
  const std::string& etag() const { return etag_; }

 private:
  std::shared_ptr<int> fd_;
  uint64_t size_ = 0;
  std::string etag_;
};

/// A body produced in pieces while it is sent (server-sent events): `next` is awaited until it returns
/// nothing. A piece holds at least one byte.
struct StreamBody {
  std::function<Task<std::optional<std::string>>()> next;
};

/// One response. With an `etag`, If-None-Match, If-Range and Range are answered by the connection.
class Response {
 public:
  int status = 200;
  std::string content_type;  ///< empty: no Content-Type header
  std::string etag;          ///< quoted, or empty
  std::variant<std::string, SharedBuffer, FileBody, StreamBody> body;
  bool close = false;  ///< close the connection after this response

  Response() = default;
  explicit Response(int status) : status(status) {}
  static Response text(std::string body, std::string content_type = "text/plain; charset=utf-8",
                       int status = 200);
  static Response json(std::string body, int status = 200);
  static Response shared(SharedBuffer body, std::string content_type, std::string etag = {});
  static Response file(int fd, std::string content_type);

  /// Appends one header. Line breaks and other controls in the value are dropped.
  Response& header(std::string_view name, std::string_view value);
  /// The appended headers, ready for the wire ("Name: value\r\n" each).
  const std::string& header_block() const { return header_block_; }

  uint64_t body_size() const;
  /// The bytes in memory; empty for a file.
  std::string_view body_bytes() const;

  /// The part of the body that is sent; set by apply_conditions for a Range.
  uint64_t offset = 0;
  std::optional<uint64_t> length;

 private:
  std::string header_block_;
};

/// Turns a 200 with an etag into 304, 206 or 416 as the request's conditions ask (RFC 9110 sections 13 and
/// 14). A request for several ranges gets the whole body, which the RFC allows.
void apply_conditions(const Request& request, Response& response);
/// Whether the conditions of a request that changes something hold: what can be changed has no entity tags,
/// so that of If-Match only "*" does (RFC 9110 section 13.1.1).
bool may_change(const Request& request);

/// ASCII comparison without case.
bool iequals(std::string_view a, std::string_view b);
/// Without spaces and tabs at both ends.
std::string_view trim(std::string_view s);

}  // namespace truestep::net
