// A TCP connection, and its operations as something that a task can wait for: one type of handler for all of
// them, so that Boost.Asio's templates are instantiated once.
#pragma once
#include <boost/asio/basic_stream_socket.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <coroutine>
#include <utility>

namespace truestep::net {

using Socket = boost::asio::basic_stream_socket<boost::asio::ip::tcp, boost::asio::io_context::executor_type>;

/// What an operation came to.
struct IoResult {
  boost::system::error_code error;
  size_t bytes = 0;
};

/// The handler of an operation: resumes the coroutine that waits for it.
class Resume {
 public:
  struct Waiting {
    std::coroutine_handle<> handle;
    IoResult result;
  };
  explicit Resume(Waiting& waiting) : waiting_(&waiting) {}
  void operator()(const boost::system::error_code& error, size_t bytes = 0) const {
    waiting_->result = {error, bytes};
    waiting_->handle.resume();
  }

 private:
  Waiting* waiting_;
};

/// For co_await: `start` begins an operation with the handler that it is given.
template <class Start>
class Io {
 public:
  explicit Io(Start start) : start_(std::move(start)) {}
  bool await_ready() const { return false; }
  void await_suspend(std::coroutine_handle<> handle) {
    waiting_.handle = handle;
    start_(Resume(waiting_));
  }
  IoResult await_resume() const { return waiting_.result; }

 private:
  Start start_;
  Resume::Waiting waiting_;
};

}  // namespace truestep::net
