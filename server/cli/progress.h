// A progress line on stderr: drawn in place on a terminal, one line every few seconds elsewhere.
#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace truestep {

class Progress {
 public:
  enum class Style : uint8_t { automatic, plain, none };
  Progress(Style style, uint64_t total);
  /// `note` follows the numbers.
  void update(uint64_t done, const std::string& note);
  void finish();

 private:
  enum class Output : uint8_t { bar, lines, nothing } output_;
  uint64_t total_;
  std::chrono::steady_clock::time_point start_, last_;
  bool drawn_ = false;
};

/// The style of "auto", "plain" or "none".
Progress::Style progress_style(std::string_view name);

}  // namespace truestep
