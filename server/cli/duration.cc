#include "server/cli/duration.h"

#include <charconv>
#include <cmath>

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

std::optional<double> read_time(std::string_view text) {
  struct Unit {
    std::string_view name;
    double seconds;
  };
  constexpr Unit kUnits[] = {{"", 1},     {"s", 1},     {"ms", 1e-3},   {"m", 60},
                             {"h", 3600}, {"d", 86400}, {"y", 31557600}};
  double n = 0;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, n);
  if (error != std::errc() || !std::isfinite(n)) return std::nullopt;
  const std::string_view unit(end, static_cast<size_t>(last - end));
  for (const Unit& u : kUnits) {
    if (unit == u.name) return n * u.seconds;
  }
  return std::nullopt;
}

}  // namespace truestep
