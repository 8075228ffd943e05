// The end of the process on request: SIGTERM, SIGINT and SIGHUP.
#pragma once
#include <chrono>
#include <functional>
#include <memory>

namespace truestep::net {

/// From now on these signals end nothing but wait().
class Termination {
 public:
  Termination();
  ~Termination();
  Termination(const Termination&) = delete;
  Termination& operator=(const Termination&) = delete;
  /// Returns when one of the signals has arrived; calls f regularly until then.
  void wait(std::chrono::steady_clock::duration pause, const std::function<void()>& f);

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace truestep::net
