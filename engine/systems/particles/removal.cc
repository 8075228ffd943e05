// Closing over dead rows: runs of living rows between them are moved down in one piece.
#include <algorithm>
#include <cstring>

#include "engine/systems/particles/particles_state.h"

namespace truestep::particles {

namespace {

/// Rows [begin, end) of the old arrays that live on.
struct Run {
  size_t begin, end;
};

/// The column's memory; per-particle columns are of 8-byte numbers.
std::byte* memory(State& s, State::Column c) {
  if (s.info(c).type == Scalar::u64) return reinterpret_cast<std::byte*>(s.span<uint64_t>(c).data());
  return reinterpret_cast<std::byte*>(s.f64(c).data());
}

void compact(State& s, State::Column c, std::span<const Run> runs, size_t kept) {
  const size_t bytes = s.info(c).width * sizeof(double);
  std::byte* data = memory(s, c);
  size_t to = runs[0].end;
  for (const Run& r : runs.subspan(1)) {
    std::memmove(data + to * bytes, data + r.begin * bytes, (r.end - r.begin) * bytes);
    to += r.end - r.begin;
  }
  s.resize(c, kept);
}

/// Renumbers the springs' ends and drops springs that lost one. Runs are ascending: search by bisection.
void remap_springs(State& s, std::span<const Run> runs, std::span<const size_t> before) {
  uint32_t* rows = s.span<uint32_t>(columns::spring_rows).data();
  double* values = s.f64(columns::spring_values).data();
  const auto mapped = [&](uint32_t row) -> int64_t {
    const auto at = std::upper_bound(runs.begin(), runs.end(), row,
                                     [](uint32_t r, const Run& run) { return r < run.begin; });
    if (at == runs.begin()) return -1;
    const size_t k = static_cast<size_t>(at - runs.begin()) - 1;
    return row < runs[k].end ? static_cast<int64_t>(before[k] + (row - runs[k].begin)) : -1;
  };
  size_t kept = 0;
  for (size_t i = 0; i < s.rows(columns::spring_rows); ++i) {
    const int64_t a = mapped(rows[2 * i]), b = mapped(rows[2 * i + 1]);
    if (a < 0 || b < 0) continue;
    rows[2 * kept] = static_cast<uint32_t>(a);
    rows[2 * kept + 1] = static_cast<uint32_t>(b);
    store3(values, kept++, load3(values, i));
  }
  s.resize(columns::spring_rows, kept);
  s.resize(columns::spring_values, kept);
}

}  // namespace

void remove_rows(State& s, std::span<const uint8_t> dead, size_t dead_count, Workspace& workspace) {
  const size_t n = s.rows(columns::position), kept = n - dead_count;
  auto& runs = workspace.object<std::vector<Run>>("particles.runs");
  auto& before = workspace.object<std::vector<size_t>>("particles.rows_before_run");
  runs.clear(), before.clear();
  size_t count = 0;
  // The first run starts at row 0 even when it is empty, so that `compact` has a place to begin.
  for (size_t i = 0; i <= n;) {
    size_t end = i;
    while (end < n && !dead[end]) ++end;
    if (end > i || i == 0) {
      runs.push_back({i, end});
      before.push_back(count);
      count += end - i;
    }
    i = end + 1;
  }
  for (State::Column c = 0; c < s.columns(); ++c) {
    // Rows of the integrator's are as wide as positions; its own numbers are as many however few are left.
    const ColumnInfo& info = s.info(c);
    const bool carried = info.name.starts_with("integrator.") && s.rows(c) == n &&
                         info.width == s.info(columns::position).width;
    const bool charge = c == columns::charge && has_charges(s);
    if (c < columns::per_particle_end || carried || charge) compact(s, c, runs, kept);
  }
  if (s.rows(columns::spring_rows) > 0) remap_springs(s, runs, before);
}

}  // namespace truestep::particles
