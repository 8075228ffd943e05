// Durations as given by options.
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace truestep {

/// "7d", "12h", "30m", "90s" or "90"; empty for "forever". Error "bad_request" naming the option otherwise.
std::optional<std::chrono::seconds> read_duration(const std::string& option, const std::string& text);

/// Seconds of "0.5", "250ms", "90s", "5m", "2h", "7d" or "3y" (of 365.25 days); none of anything else.
std::optional<double> read_time(std::string_view text);

}  // namespace truestep
