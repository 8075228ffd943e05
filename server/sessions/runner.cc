#include "server/sessions/runner.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace truestep {

namespace asio = boost::asio;

namespace {
constexpr auto kSlice = std::chrono::milliseconds(10);
constexpr auto kShortestTick = std::chrono::microseconds(500);
}  // namespace

Runner::Runner(int workers) : pool_(static_cast<size_t>(workers)), picture_thread_(1) {}

Runner::~Runner() {
  stop();
}

void Runner::stop() {
  stopping_ = true;
  pool_.stop();
  picture_thread_.stop();
  pool_.join();
  picture_thread_.join();
}

void Runner::keep_playing(const EntryPtr& entry) {
  if (entry->ticking) return;
  entry->ticking = true;
  const auto timer = std::make_shared<asio::steady_timer>(pool_);
  const auto now = Clock::now();
  asio::post(pool_, [this, entry, timer, now] { tick(entry, timer, now); });
}

void Runner::tick(const EntryPtr& entry, const std::shared_ptr<asio::steady_timer>& timer,
                  Clock::time_point last) {
  if (stopping_) return;
  const auto now = Clock::now();
  Clock::duration wait{};
  {
    const std::lock_guard lock(entry->mutex);
    Session& session = entry->session;
    if (!session.playing() || entry->removed) {
      entry->ticking = false;
      return;
    }
    const uint64_t done = session.advance(std::chrono::duration<double>(now - last).count());
    steps_.fetch_add(done, std::memory_order_relaxed);
    if (done > 0) entry->publish();
    // The next step is due when the accumulator is full again.
    const double seconds = (1 - session.alpha()) * session.world().dt() / session.speed();
    wait = std::max<Clock::duration>(
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(seconds, 1.0))),
        kShortestTick);
  }
  timer->expires_at(now + wait);
  timer->async_wait([this, entry, timer, now](const boost::system::error_code& e) {
    if (!e) tick(entry, timer, now);
  });
}

asio::awaitable<uint64_t> Runner::step_to(EntryPtr entry, uint64_t target) {
  co_return co_await asio::co_spawn(pool_, run_slices(std::move(entry), target), asio::use_awaitable);
}

asio::awaitable<uint64_t> Runner::run_slices(EntryPtr entry, uint64_t target) {
  while (true) {
    uint64_t at = 0;
    bool more = false;
    {
      const std::lock_guard lock(entry->mutex);
      Session& session = entry->session;
      const auto end = Clock::now() + kSlice;
      const uint64_t before = session.step_index();
      while (session.step_index() < target && !session.failure() && Clock::now() < end) session.step(1);
      at = session.step_index();
      if (at != before) steps_.fetch_add(at - std::min(at, before), std::memory_order_relaxed);
      more = at < target && !session.failure();
      // Streams of a bounded rate left out the steps that came too soon: told of the pause, they send the
      // last.
      if (!more && !session.playing()) session.pause();
      entry->publish();
    }
    if (!more || stopping_ || entry->removed) co_return at;
    co_await asio::post(pool_, asio::use_awaitable);
  }
}

}  // namespace truestep
