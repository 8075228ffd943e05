#include "server/net/async.h"

#include <algorithm>

namespace truestep::net {

namespace asio = boost::asio;

void Signal::notify() {
  std::vector<std::shared_ptr<Waiter>> woken;
  {
    const std::lock_guard lock(mutex_);
    ++version_;
    woken.swap(waiters_);
  }
  for (auto& w : woken) {
    asio::post(w->timer.get_executor(), [w] {
      w->woken = true;
      w->timer.cancel();
    });
  }
}

asio::awaitable<bool> Signal::wait(uint64_t seen, std::chrono::steady_clock::time_point deadline) {
  auto waiter = std::make_shared<Waiter>(co_await asio::this_coro::executor);
  {
    const std::lock_guard lock(mutex_);
    if (version_ != seen) co_return true;
    waiters_.push_back(waiter);
  }
  // Also when the coroutine is destroyed with its context: no timer may outlive that.
  const Leave leave{*this, waiter};
  waiter->timer.expires_at(deadline);
  boost::system::error_code ec;
  // notify() posts to this thread, so its cancel cannot come before this wait has begun.
  co_await waiter->timer.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  co_return waiter->woken || version() != seen;
}

Signal::Leave::~Leave() {
  const std::lock_guard lock(signal.mutex_);
  std::erase(signal.waiters_, waiter);
}

}  // namespace truestep::net
