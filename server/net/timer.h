// Timers of Boost.Asio behind the interface that those who know no Asio see.
#pragma once
#include <boost/asio/any_io_executor.hpp>

#include "server/tasks/executor.h"

namespace truestep::net {

TimerPtr start_timer(const boost::asio::any_io_executor& executor, std::chrono::steady_clock::time_point when,
                     std::function<void(const TimerPtr&)> f);

}  // namespace truestep::net
