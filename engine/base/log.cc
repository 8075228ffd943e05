#include "engine/base/log.h"

#include <spdlog/spdlog.h>

#include <string>

namespace truestep {
namespace {

void write_log(spdlog::level::level_enum level, LogTexts texts) {
  if (!spdlog::should_log(level)) return;
  std::string all;
  for (const std::string_view text : texts) all += text;
  spdlog::default_logger_raw()->log(level, spdlog::string_view_t(all));
}

}  // namespace

void log_info(LogTexts texts) {
  write_log(spdlog::level::info, texts);
}
void log_warning(LogTexts texts) {
  write_log(spdlog::level::warn, texts);
}
void log_error(LogTexts texts) {
  write_log(spdlog::level::err, texts);
}

void set_log_level(std::string_view level) {
  spdlog::set_level(spdlog::level::from_str(std::string(level)));
}

void ignore_log_failures() {
  spdlog::set_error_handler([](const std::string&) {});
}

}  // namespace truestep
