// One network thread: an event loop, the connections it serves, and the sweep that checks their deadlines.
#pragma once
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/steady_timer.hpp>
#include <list>
#include <memory>
#include <optional>
#include <thread>

#include "server/net/connection.h"
#include "server/net/event_loop.h"

namespace truestep::net {

class Shard {
 public:
  explicit Shard(Service& service);
  ~Shard();

  void start();
  /// Any thread: closes idle connections and asks the others to finish.
  void drain();
  /// Any thread: cuts every connection.
  void abort_all();
  /// Lets the loop end when nothing is left to do, or at once after `stop_loop`; then joins the thread.
  void join();
  void stop_loop() { io().stop(); }
  boost::asio::io_context& io() { return loop_.io(); }
  /// On this shard's thread: serves an accepted connection.
  void adopt(Socket socket);

 private:
  struct Served {
    std::shared_ptr<Connection> connection;
    std::optional<RootTask> task;
  };
  void run();
  void sweep();
  Service& service_;
  EventLoop loop_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_;
  boost::asio::steady_timer timer_;
  bool sweeping_ = false;
  TaskContext context_{loop_};
  std::list<Served> connections_;
  std::thread thread_;
};

}  // namespace truestep::net
