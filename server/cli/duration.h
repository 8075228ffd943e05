// Durations as given by options.
#pragma once
#include <chrono>
#include <optional>
#include <string>

namespace truestep {

/// "7d", "12h", "30m", "90s" or "90"; empty for "forever". Error "bad_request" naming the option otherwise.
std::optional<std::chrono::seconds> read_duration(const std::string& option, const std::string& text);

}  // namespace truestep
