// Writing of a connection: one system call for head and body where the socket takes them, waiting only when
// it does not; files go from the page cache to the socket without passing through this process.
#include <sys/sendfile.h>

#include <boost/beast/core/buffers_suffix.hpp>
#include <cerrno>
#include <charconv>

#include "server/net/connection.h"
#include "server/net/http/response_head.h"

namespace truestep::net {

namespace asio = boost::asio;

namespace {

// Bodies up to this size are copied behind their head and leave in one segment.
constexpr size_t kSmallBody = size_t{16} << 10;
// Answers to pipelined requests are collected up to this size.
constexpr size_t kCollect = size_t{64} << 10;

}  // namespace

// Writes out_ and then body; false when the connection is gone.
Task<bool> Connection::write_out(std::string_view body) {
  const std::array<asio::const_buffer, 2> both{asio::buffer(out_), asio::buffer(body)};
  boost::beast::buffers_suffix<std::array<asio::const_buffer, 2>> rest(both);
  while (boost::beast::buffer_bytes(rest) > 0) {
    boost::system::error_code ec;
    rest.consume(socket_.write_some(rest, ec));
    if (ec == asio::error::would_block) {
      co_await wait_writable();
    } else if (ec) {
      abort();
      co_return false;
    }
  }
  out_.clear();
  co_return true;
}

// The write time-out restarts whenever the peer has taken something.
Task<> Connection::wait_writable() {
  enter(Phase::write);
  co_await Io([&](const Resume& handler) { socket_.async_wait(Socket::wait_write, handler); });
}

Task<bool> Connection::send_file(const FileBody& file, uint64_t offset, uint64_t length) {
  auto at = static_cast<off_t>(offset);
  while (length > 0) {
    const ssize_t sent =
        ::sendfile(socket_.native_handle(), file.fd(), &at, std::min<uint64_t>(length, uint64_t{1} << 20));
    if (sent > 0) {
      length -= static_cast<uint64_t>(sent);
      // A fast reader must not keep the network thread to itself for a whole file.
      if (length > 0) co_await wait_writable();
    } else if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      co_await wait_writable();
    } else if (sent == 0 || errno != EINTR) {
      // The file became shorter than announced, or the peer left: closing is the only honest answer.
      abort();
    }
    if (!socket_.is_open()) co_return false;
  }
  co_return true;
}

// RFC 9112 section 7.1: size in hexadecimal, line, piece, line. A stream that fails ends without the last
// chunk, so that the client knows.
Task<bool> Connection::send_stream(const StreamBody& stream) {
  const bool chunked = !closing_;
  for (;;) {
    enter(Phase::handler);
    std::optional<std::string> piece;
    try {
      Task<std::optional<std::string>> next = stream.next();
      handler_context_.reset();
      next.run_in(handler_context_);
      piece = co_await next;
    } catch (const std::exception&) {
      abort();
      co_return false;
    }
    if (!piece) break;
    char size[24];
    const auto end = std::to_chars(size, size + sizeof size, piece->size(), 16).ptr;
    if (chunked) out_.append(size, end) += "\r\n";
    out_ += *piece;
    if (chunked) out_ += "\r\n";
    if (!co_await write_out()) co_return false;
  }
  if (chunked) out_ += "0\r\n\r\n";
  co_return true;
}

// Serialises a response. True when it is complete in out_, which leaves with the next flush; false when
// finish_response has to send a large body or too much has been collected.
bool Connection::prepare(Response& r, std::string_view& large_body) {
  if (!r.etag.empty() || request_.has_header("if-match")) apply_conditions(request_, r);
  if (r.status >= 500) {
    service_.stats.errors_5xx++;
  } else if (r.status >= 400) {
    service_.stats.errors_4xx++;
  }
  // Without a complete head the peer's preferences are unknown, and the connection ends anyway.
  const bool may_continue = parser_->is_header_done() && parser_->keep_alive();
  closing_ = closing_ || r.close || !may_continue || service_.draining.load(std::memory_order_relaxed);
  const bool stream = std::holds_alternative<StreamBody>(r.body);
  if (stream && request_.http10) closing_ = true;
  const uint64_t length = r.length.value_or(r.body_size());
  append_head(out_, r, length,
              closing_          ? ConnectionFate::close
              : request_.http10 ? ConnectionFate::keep_http10
                                : ConnectionFate::keep);
  if (stream && request_.method != Method::head) return false;
  if (request_.method == Method::head || r.status == 204 || r.status == 304 || length == 0)
    return out_.size() < kCollect;
  if (std::holds_alternative<FileBody>(r.body)) return false;
  const std::string_view body = r.body_bytes().substr(r.offset, length);
  if (body.size() > kSmallBody) {
    large_body = body;
    return false;
  }
  out_ += body;
  return out_.size() < kCollect;
}

Task<bool> Connection::finish_response(const Response& r, std::string_view large_body) {
  if (!co_await write_out(large_body)) co_return false;
  if (const auto* stream = std::get_if<StreamBody>(&r.body)) {
    const bool sent = co_await send_stream(*stream);
    co_return sent;
  }
  const auto* file = std::get_if<FileBody>(&r.body);
  if (!file || request_.method == Method::head || r.status == 304) co_return true;
  const bool sent = co_await send_file(*file, r.offset, r.length.value_or(file->size()));
  co_return sent;
}

Task<> Connection::linger() {
  boost::system::error_code ec;
  socket_.shutdown(Socket::shutdown_send, ec);
  enter(Phase::linger);
  do {
    buffer_.clear();
  } while (co_await read_more(kRead));
}

}  // namespace truestep::net
