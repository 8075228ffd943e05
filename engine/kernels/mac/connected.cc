#include "engine/kernels/mac/connected.h"

#include "engine/kernels/mac/momentum.h"
#include "engine/kernels/mac/surface.h"

namespace truestep::mac {

namespace {

/// Runs that are joined point to the lowest of them, which points to itself.
class JoinedRuns {
 public:
  explicit JoinedRuns(std::span<uint32_t> lower) : lower_(lower) { lower_[0] = 0; }
  uint32_t add() {
    ++last_;
    lower_[last_] = last_;
    return last_;
  }
  void join(uint32_t a, uint32_t b) {
    a = lowest(a), b = lowest(b);
    if (a < b) lower_[b] = a;
    if (b < a) lower_[a] = b;
  }
  /// Replaces every run's entry by its body's number; returns the largest.
  uint32_t number() {
    uint32_t count = 0;
    for (uint32_t run = 1; run <= last_; ++run)
      lower_[run] = lower_[run] == run ? ++count : lower_[lower_[run]];
    return count;
  }

 private:
  uint32_t lowest(uint32_t run) {
    while (lower_[run] != run) {
      lower_[run] = lower_[lower_[run]];
      run = lower_[run];
    }
    return run;
  }
  std::span<uint32_t> lower_;
  uint32_t last_ = 0;
};

}  // namespace

uint32_t number_bodies(const MacGrid& g, const uint8_t* liquid, const std::array<const double*, 3>& faces,
                       uint32_t* body, std::span<uint32_t> scratch, const ThreadArena& arena) {
  JoinedRuns runs(scratch);
  const size_t n[] = {g.cells[0], g.cells[1], g.cells[2]};
  for (size_t k = 0; k < n[2]; ++k) {
    for (size_t j = 0; j < n[1]; ++j) {
      const size_t row = g.at(0, j, k), place[] = {0, j, k};
      for (size_t at = row; at < row + n[0]; ++at) {
        body[at] = 0;
        if (!liquid[at]) continue;
        const bool goes_on = at > row && body[at - 1] > 0 && faces[0][at] > 0;
        body[at] = goes_on ? body[at - 1] : runs.add();
        for (size_t a = 1; a < g.dimensions; ++a) {
          const size_t low = at - g.stride(a);
          if (place[a] > 0 && body[low] > 0 && faces[a][at] > 0) runs.join(body[low], body[at]);
        }
      }
    }
  }
  for (size_t a = 0; a < g.dimensions; ++a) {
    if (!g.periodic[a]) continue;
    const size_t first = a == 0 ? 1 : 0, second = a == 2 ? 1 : 2, far = (n[a] - 1) * g.stride(a);
    for (size_t q = 0; q < n[second]; ++q) {
      for (size_t p = 0; p < n[first]; ++p) {
        const size_t at = g.base() + p * g.stride(first) + q * g.stride(second);
        if (body[at] > 0 && body[at + far] > 0 && faces[a][at] > 0) runs.join(body[at], body[at + far]);
      }
    }
  }
  const uint32_t count = runs.number();
  for_rows(g, kCentre, arena, [&](size_t at, size_t, size_t, size_t width) {
    for (size_t i = at; i < at + width; ++i) body[i] = scratch[body[i]];
  });
  wrap_periodic(g, body, arena);
  for_rows(g, kCentre, arena, [&](size_t at, size_t, size_t, size_t width) {
    for (size_t i = at; i < at + width; ++i) {
      for (size_t a = 0; a < g.dimensions && body[i] == 0; ++a) {
        const size_t low = i - g.stride(a), high = i + g.stride(a);
        if (liquid[low] && faces[a][i] > 0) {
          body[i] = body[low];
        } else if (liquid[high] && faces[a][high] > 0) {
          body[i] = body[high];
        }
      }
    }
  });
  return count;
}

}  // namespace truestep::mac
