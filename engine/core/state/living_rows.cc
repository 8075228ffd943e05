#include "engine/core/state/living_rows.h"

#include <algorithm>
#include <cstring>

namespace truestep {

namespace {

std::byte* memory(State& s, State::Column c) {
  const auto of = [](auto span) { return reinterpret_cast<std::byte*>(span.data()); };
  switch (s.info(c).type) {
    case Scalar::f64:
      return of(s.span<double>(c));
    case Scalar::f32:
      return of(s.span<float>(c));
    case Scalar::i32:
      return of(s.span<int32_t>(c));
    case Scalar::u32:
      return of(s.span<uint32_t>(c));
    case Scalar::u64:
      break;
  }
  return of(s.span<uint64_t>(c));
}

}  // namespace

void LivingRows::set(std::span<const uint8_t> dead) {
  runs_.clear();
  kept_ = 0;
  for (size_t i = 0; i < dead.size();) {
    size_t end = i;
    while (end < dead.size() && !dead[end]) ++end;
    if (end > i) {
      runs_.push_back({i, end, kept_});
      kept_ += end - i;
    }
    i = end + 1;
  }
}

std::optional<size_t> LivingRows::place(size_t row) const {
  const auto after = std::upper_bound(runs_.begin(), runs_.end(), row,
                                      [](size_t r, const Run& run) { return r < run.begin; });
  if (after == runs_.begin()) return std::nullopt;
  const Run& run = after[-1];
  if (row >= run.end) return std::nullopt;
  return run.before + (row - run.begin);
}

void LivingRows::close(State& s, State::Column c) const {
  const size_t bytes = s.info(c).width * scalar_size(s.info(c).type);
  std::byte* data = memory(s, c);
  for (const Run& r : runs_) {
    if (r.before == r.begin) continue;
    std::memmove(data + r.before * bytes, data + r.begin * bytes, (r.end - r.begin) * bytes);
  }
  s.resize(c, kept_);
}

}  // namespace truestep
