// Lines of the log. spdlog writes them; it stands behind this door because its headers, with those of fmt,
// cost every file that logs more of the compiler's time than most files take in all. Each {} of the format is
// replaced by the next value.
#pragma once
#include <charconv>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace truestep {

enum class LogLevel : uint8_t { info, warn, error };

/// A value in a line of the log: text, which must outlive the call, or a whole number.
class LogValue {
 public:
  LogValue(const char* text) : text_(text) {}
  LogValue(std::string_view text) : text_(text) {}
  LogValue(const std::string& text) : text_(text) {}
  LogValue(std::integral auto number) {
    length_ = std::to_chars(digits_, digits_ + sizeof digits_, number).ptr - digits_;
  }
  std::string_view text() const { return length_ > 0 ? std::string_view(digits_, length_) : text_; }

 private:
  std::string_view text_;
  char digits_[24];
  size_t length_ = 0;
};

/// Writes the line; never throws. Values beyond the format's {} are left out.
void log_line(LogLevel level, std::string_view format, std::initializer_list<LogValue> values) noexcept;

template <class... Values>
void log_info(std::string_view format, const Values&... values) {
  log_line(LogLevel::info, format, {LogValue(values)...});
}
template <class... Values>
void log_warn(std::string_view format, const Values&... values) {
  log_line(LogLevel::warn, format, {LogValue(values)...});
}
template <class... Values>
void log_error(std::string_view format, const Values&... values) {
  log_line(LogLevel::error, format, {LogValue(values)...});
}

/// Lines below `level` ("debug", "info", "warn", "error", "off") are not written, and a log that cannot be
/// written (a closed pipe) is not spoken of.
void start_log(const std::string& level);
/// Standard output is for something else: lines go to standard error.
void log_to_stderr(const std::string& name);

}  // namespace truestep
