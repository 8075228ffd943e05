// What handlers wait for (server/net/async.h).
#include "server/net/async.h"

#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>

#include <gtest/gtest.h>

namespace truestep::net {
namespace {

namespace asio = boost::asio;

asio::awaitable<void> wait_an_hour(Signal& signal) {
  co_await signal.wait(0, std::chrono::steady_clock::now() + std::chrono::hours(1));
}

TEST(Signal, WhoWaitsLeavesWhenItsContextEnds) {
  Signal signal;
  {
    asio::io_context io;
    asio::co_spawn(io, wait_an_hour(signal), asio::detached);
    io.poll();
    EXPECT_EQ(signal.waiting(), 1u) << "control: it waits";
  }
  // A former bug: its timer stayed here, and was destroyed after the context that it belongs to.
  EXPECT_EQ(signal.waiting(), 0u);
}

TEST(Signal, WhoIsWokenLeaves) {
  Signal signal;
  asio::io_context io;
  asio::co_spawn(io, wait_an_hour(signal), asio::detached);
  io.poll();
  signal.notify();
  io.run();
  EXPECT_EQ(signal.waiting(), 0u);
}

}  // namespace
}  // namespace truestep::net
