#include "engine/systems/mass_spring/spring_schedule.h"

#include <algorithm>

namespace truestep::mass_spring {

namespace {

constexpr uint32_t kShortestRun = 8;

}  // namespace

SpringSchedule::SpringSchedule(const Network& network, size_t block_rows)
    : points_(network.x.size()), block_rows_(block_rows) {
  std::vector<SpringLink> links = network.springs;
  std::stable_sort(links.begin(), links.end(),
                   [](const SpringLink& p, const SpringLink& q) { return p.family < q.family; });
  for (const SpringLink& s : links) {
    a.push_back(s.a), b.push_back(s.b);
    rest.push_back(s.rest), scale.push_back(s.scale);
    family.push_back(s.family);
  }

  // Runs, and springs too few to form one.
  const auto n = static_cast<uint32_t>(a.size());
  std::vector<uint32_t> loose;
  for (uint32_t first = 0, end; first < n; first = end) {
    end = first + 1;
    while (end < n && a[end] == a[end - 1] + 1 && b[end] == b[end - 1] + 1 && family[end] == family[first]) {
      ++end;
    }
    if (end - first >= kShortestRun) {
      runs_.push_back({first, end - first});
    } else {
      for (uint32_t s = first; s < end; ++s) loose.push_back(s);
    }
  }

  const size_t blocks = (points_ + block_rows_ - 1) / block_rows_;
  // Loose springs and triangles by block.
  std::vector<std::vector<uint32_t>> block_loose(blocks), block_triangles(blocks);
  const auto block_of = [this](uint32_t point) { return point / block_rows_; };
  for (const uint32_t s : loose) {
    block_loose[block_of(a[s])].push_back(s);
    if (block_of(b[s]) != block_of(a[s])) block_loose[block_of(b[s])].push_back(s);
  }
  for (uint32_t t = 0; t < network.triangles.size(); ++t) {
    for (const uint32_t p : network.triangles[t]) {
      auto& list = block_triangles[block_of(p)];
      if (list.empty() || list.back() != t) list.push_back(t);
    }
  }
  segment_begin_.push_back(0);
  triangle_begin_.push_back(0);
  for (size_t k = 0; k < blocks; ++k) {
    const auto begin = static_cast<uint32_t>(k * block_rows_);
    const auto end = static_cast<uint32_t>(std::min(points_, (k + 1) * block_rows_));
    add_runs(begin, end);
    add_lists(block_loose[k], begin, end);
    segment_begin_.push_back(segments_.size());
    for (const uint32_t t : block_triangles[k]) triangles_.push_back(network.triangles[t]);
    triangle_begin_.push_back(triangles_.size());
  }
  runs_ = {};
}

// Every run is cut where one of its ends enters or leaves the block.
void SpringSchedule::add_runs(uint32_t begin, uint32_t end) {
  const auto clip = [](int64_t at, int64_t count) { return std::clamp<int64_t>(at, 0, count); };
  for (const Run& run : runs_) {
    const int64_t a0 = a[run.first], b0 = b[run.first], count = run.count;
    const int64_t a_in = clip(begin - a0, count), a_out = clip(end - a0, count);
    const int64_t b_in = clip(begin - b0, count), b_out = clip(end - b0, count);
    int64_t cuts[] = {a_in, a_out, b_in, b_out};
    std::sort(std::begin(cuts), std::end(cuts));
    for (int i = 0; i < 3; ++i) {
      const int64_t from = cuts[i], to = cuts[i + 1];
      if (from == to) continue;
      const bool owns_a = from >= a_in && to <= a_out, owns_b = from >= b_in && to <= b_out;
      if (!owns_a && !owns_b) continue;
      segments_.push_back({SpringSegment::Kind::run, family[run.first],
                           owns_a && owns_b ? SpringEnds::both
                           : owns_a         ? SpringEnds::a
                                            : SpringEnds::b,
                           static_cast<uint32_t>(run.first + from), static_cast<uint32_t>(to - from),
                           static_cast<uint32_t>(a0 + from), static_cast<uint32_t>(b0 + from)});
    }
  }
}

void SpringSchedule::add_lists(std::span<const uint32_t> loose, uint32_t begin, uint32_t end) {
  const auto owns = [&](uint32_t p) { return p >= begin && p < end; };
  for (size_t f = 0; f < kSpringFamilies; ++f) {
    for (const SpringEnds ends : {SpringEnds::a, SpringEnds::b, SpringEnds::both}) {
      const auto first = static_cast<uint32_t>(list_a.size());
      for (const uint32_t s : loose) {
        const SpringEnds here = owns(a[s]) && owns(b[s]) ? SpringEnds::both
                                : owns(a[s])             ? SpringEnds::a
                                                         : SpringEnds::b;
        if (family[s] != static_cast<SpringFamily>(f) || here != ends) continue;
        list_a.push_back(a[s]), list_b.push_back(b[s]), list_spring.push_back(s);
        list_rest.push_back(rest[s]), list_scale.push_back(scale[s]);
      }
      const auto count = static_cast<uint32_t>(list_a.size()) - first;
      if (count > 0) {
        segments_.push_back(
            {SpringSegment::Kind::list, static_cast<SpringFamily>(f), ends, first, count, 0, 0});
      }
    }
  }
}

}  // namespace truestep::mass_spring
