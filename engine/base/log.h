// The log of the process, on standard error through spdlog. Its headers and those of its formatter take
// seconds wherever they are included, so only log.cc does; a message is put together from texts:
// log_error({"session ", id, ": ", e.what()}).
#pragma once
#include <initializer_list>
#include <string_view>

namespace truestep {

using LogTexts = std::initializer_list<std::string_view>;

void log_info(LogTexts texts);
void log_warning(LogTexts texts);
void log_error(LogTexts texts);

/// What is less than "debug", "info", "warn" or "error" is left out; everything with "off".
void set_log_level(std::string_view level);
/// From now on nothing is said of messages that could not be written.
void ignore_log_failures();

}  // namespace truestep
