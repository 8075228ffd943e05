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
  waiter->timer.expires_at(deadline);
  boost::system::error_code ec;
  // notify() posts to this thread, so its cancel cannot come before this wait has begun.
  co_await waiter->timer.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  const std::lock_guard lock(mutex_);
  std::erase(waiters_, waiter);
  co_return waiter->woken || version_ != seen;
}

}  // namespace truestep::net
