#include "server/cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace truestep {

using Clock = std::chrono::steady_clock;

Progress::Progress(Style style, uint64_t total)
    : output_(style == Style::none                                 ? Output::nothing
              : style == Style::automatic && isatty(STDERR_FILENO) ? Output::bar
                                                                   : Output::lines),
      total_(std::max<uint64_t>(total, 1)),
      start_(Clock::now()),
      last_(start_) {}

void Progress::update(uint64_t done, const std::string& note) {
  if (output_ == Output::nothing) return;
  const auto now = Clock::now();
  if (now - last_ <
      (output_ == Output::bar ? std::chrono::milliseconds(100) : std::chrono::milliseconds(3000)))
    return;
  last_ = now;
  const double share = static_cast<double>(done) / static_cast<double>(total_);
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double left = share > 0 ? seconds / share - seconds : 0;
  if (output_ == Output::bar) {
    constexpr int kWidth = 30;
    const int filled = std::min(kWidth, static_cast<int>(share * kWidth));
    const std::string bar = std::string(static_cast<size_t>(filled), '#') +
                            std::string(static_cast<size_t>(kWidth - filled), '.');
    std::fprintf(stderr, "\r[%s] %3.0f %%  step %llu/%llu  %.0f s left  %s\033[K", bar.c_str(), share * 100,
                 static_cast<unsigned long long>(done), static_cast<unsigned long long>(total_), left,
                 note.c_str());
    drawn_ = true;
  } else {
    std::fprintf(stderr, "step %llu of %llu, %.0f s left  %s\n", static_cast<unsigned long long>(done),
                 static_cast<unsigned long long>(total_), left, note.c_str());
  }
}

void Progress::finish() {
  if (drawn_) std::fprintf(stderr, "\r\033[K");
  drawn_ = false;
}

Progress::Style progress_style(std::string_view name) {
  return name == "none"    ? Progress::Style::none
         : name == "plain" ? Progress::Style::plain
                           : Progress::Style::automatic;
}

}  // namespace truestep
