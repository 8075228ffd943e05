// Slows down clients that guess keys: an address that has sent several wrong ones must wait before it may try
// another. A key that was recently right from the same address is let through meanwhile, so that a guesser
// behind a shared address locks nobody out. Memory is bounded.
#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "server/net/access/address.h"

namespace truestep::net {

class KeyThrottle {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr int kFreeFailures = 10;                ///< wrong keys before an address has to wait ...
  static constexpr std::chrono::seconds kEach{6};         ///< ... and what each of them costs
  static constexpr std::chrono::minutes kRemembered{10};  ///< how long a right key is known at its address
  static constexpr size_t kMostRows = 4096;

  /// Seconds that a peer ("address:port") must wait before this key is checked; 0: now.
  int wait(std::string_view remote, std::string_view digest, Clock::time_point now);
  void failed(std::string_view remote, Clock::time_point now);
  void succeeded(std::string_view remote, std::string_view digest, Clock::time_point now);
  size_t rows() const;

 private:
  using Rows = std::map<std::string, Clock::time_point, std::less<>>;
  static void make_room(Rows& rows, Clock::time_point now);

  mutable std::mutex mutex_;
  Rows debts_;  ///< by address: when its failures are forgotten, kEach for each of them
  Rows known_;  ///< by address and digest: until when
};

}  // namespace truestep::net
