// The log, by spdlog.
#include "engine/base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace truestep {

void log_line(LogLevel level, std::string_view format, std::initializer_list<LogValue> values) noexcept try {
  constexpr spdlog::level::level_enum kLevels[] = {spdlog::level::info, spdlog::level::warn,
                                                   spdlog::level::err};
  const spdlog::level::level_enum wanted = kLevels[static_cast<size_t>(level)];
  if (!spdlog::should_log(wanted)) return;
  std::string line;
  for (const LogValue& value : values) {
    const size_t hole = format.find("{}");
    if (hole == format.npos) break;
    line.append(format.substr(0, hole)).append(value.text());
    format.remove_prefix(hole + 2);
  }
  line.append(format);
  spdlog::log(wanted, line);
} catch (...) {  // nowhere is left to say it
}

void start_log(const std::string& level) {
  spdlog::set_level(spdlog::level::from_str(level));
  spdlog::set_error_handler([](const std::string&) {});
}

void log_to_stderr(const std::string& name) {
  spdlog::set_default_logger(spdlog::stderr_color_mt(name));
}

}  // namespace truestep
