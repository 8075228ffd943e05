#include "tests/gallery/weighed_memory.h"

#include <malloc.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>

namespace truestep::testing {
namespace {

// What the kernel adds to the requested memory: pages of the program, the allocator's slack.
constexpr double kCoarse = 8e6;
constexpr double kSmall = 64 << 10;

double allocated() {
  const struct mallinfo2 m = mallinfo2();
  return static_cast<double>(m.uordblks) + static_cast<double>(m.hblkhd);
}

// From the kernel, since `forget_peak`, without pages of the program's file: how many of those are in memory
// depends on what else the machine has read.
double peak_bytes() {
  std::FILE* status = std::fopen("/proc/self/status", "r");
  if (!status) return 0;
  char line[256];
  double kilobytes = 0, of_file = 0;
  while (std::fgets(line, sizeof line, status)) {
    std::sscanf(line, "VmHWM: %lf", &kilobytes);
    if (std::sscanf(line, "RssFile: %lf", &of_file) == 1) break;
  }
  std::fclose(status);
  return 1024 * (kilobytes - of_file);
}

double forget_peak() {
  malloc_trim(0);
  if (std::FILE* f = std::fopen("/proc/self/clear_refs", "w")) {
    std::fputs("5", f);
    std::fclose(f);
  }
  return peak_bytes();
}

}  // namespace

void return_large_blocks() {
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
}

WeighedMemory::WeighedMemory(double estimated_bytes)
    : estimated_(estimated_bytes), held_before_(allocated()), peak_before_(forget_peak()) {}

void WeighedMemory::after_step(size_t steps) {
  if (rests_ || steps > kSteps || (steps != kSteps && !std::has_single_bit(steps))) return;
  rests_ = look() && steps >= kFewest;
}

bool WeighedMemory::look() {
  const double last = bytes();
  grown_ = peak_bytes() - peak_before_, held_ = allocated() - held_before_;
  return std::abs(bytes() - last) <= 0.01 * last && ratio() > 0.8 && ratio() < 1.35;
}

double WeighedMemory::bytes() const {
  return std::max(held_, grown_ - kCoarse);
}

bool memory_is_off(double estimated_bytes, double bytes, double systems) {
  const double ratio = estimated_bytes / bytes;
  return !(ratio >= kLeastRatio && ratio <= kMostRatio) &&
         !(std::abs(estimated_bytes - bytes) <= kSmall * systems);
}

}  // namespace truestep::testing
