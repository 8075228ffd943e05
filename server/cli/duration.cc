#include "server/cli/duration.h"

#include <charconv>

#include "engine/base/errors.h"

namespace truestep {

std::optional<std::chrono::seconds> read_duration(const std::string& option, const std::string& text) {
  if (text == "forever") return std::nullopt;
  int64_t n = -1;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, n);
  int64_t unit = 0;
  if (error == std::errc() && n >= 0 && n <= 1'000'000'000 && last - end <= 1) {
    switch (end == last ? 's' : *end) {
      case 's':
        unit = 1;
        break;
      case 'm':
        unit = 60;
        break;
      case 'h':
        unit = 3600;
        break;
      case 'd':
        unit = 86400;
        break;
      default:
        break;
    }
  }
  if (unit == 0)
    throw Error("bad_request", option + " is a length of time such as 7d, 12h, 30m or 90s, or forever");
  return std::chrono::seconds(n * unit);
}

}  // namespace truestep
