#include "engine/kernels/gravity/body_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace truestep::gravity {

namespace {

constexpr size_t kNodeBlock = 512;

/// The power of two that scales `size` into (1/2, 1].
double power_of_two(double size) {
  return size > 0 ? std::ldexp(1.0, -std::ilogb(size) - 1) : 1;
}

/// The lowest 21 bits of x, each followed by two zeros.
uint64_t spread(uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

}  // namespace

void BodyTree::set_scales(const Bodies& bodies) {
  std::array<double, 3> low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  double mass = 0, half = 0;
  for (size_t i = 0; i < bodies.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], bodies.x[3 * i + k]), high[k] = std::max(high[k], bodies.x[3 * i + k]);
    }
    mass += bodies.mu[i];
  }
  for (size_t k = 0; k < 3; ++k) {
    middle_[k] = 0.5 * low[k] + 0.5 * high[k], half = std::max(half, 0.5 * high[k] - 0.5 * low[k]);
  }
  length_scale_ = power_of_two(half), mass_scale_ = power_of_two(mass);
}

void BodyTree::sort(const Bodies& bodies, const ThreadArena& arena) {
  constexpr double kCells = 1 << (kDepths - 1);  // a unit of length
  const size_t n = bodies.size();
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      uint64_t key = 0;
      for (size_t k = 0; k < 3; ++k) {
        const double at = ((bodies.x[3 * i + k] - middle_[k]) * length_scale_ + 1) * kCells;
        key |= spread(static_cast<uint64_t>(std::clamp(at, 0.0, 2 * kCells - 1))) << k;
      }
      keyed_[i] = {key, static_cast<uint32_t>(i)};
    }
  });
  // Digit by digit from the lowest; stable, so that bodies with the same key stay in the order of their rows.
  constexpr int kDigit = 11;
  constexpr size_t kValues = size_t{1} << kDigit;
  std::array<std::array<uint32_t, kValues>, 6> starts{};
  for (const Keyed& b : keyed_) {
    for (size_t pass = 0; pass < starts.size(); ++pass)
      ++starts[pass][b.key >> (pass * kDigit) & (kValues - 1)];
  }
  for (size_t pass = 0; pass < starts.size(); ++pass) {
    uint32_t sum = 0;
    for (uint32_t& s : starts[pass]) sum += std::exchange(s, sum);
    for (const Keyed& b : keyed_) sorted_[starts[pass][b.key >> (pass * kDigit) & (kValues - 1)]++] = b;
    std::swap(keyed_, sorted_);
  }
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const size_t i = rows_[k] = keyed_[k].row;
      const auto at = [&](size_t c) { return (bodies.x[3 * i + c] - middle_[c]) * length_scale_; };
      points_[k] = {at(0), at(1), at(2), bodies.mu[i] * mass_scale_};
    }
  });
}

void BodyTree::divide() {
  // Enough for bodies that move later, so that their tree does not allocate.
  nodes_.reserve(size() / 2 + 1024), groups_.reserve(size() / 8 + 64), depth_ends_.reserve(kDepths + 2);
  nodes_.assign(1, {0, static_cast<uint32_t>(size())});
  depth_ends_.assign(1, 1);
  size_t begin = 0;
  for (int depth = 1; depth <= kDepths && begin < nodes_.size(); ++depth) {
    const int shift = 3 * (kDepths - depth);
    const size_t end = nodes_.size();
    for (size_t k = begin; k < end; ++k) {
      const Node parent = nodes_[k];
      if (parent.end - parent.begin <= kMostInLeaf) continue;
      const auto first = static_cast<uint32_t>(nodes_.size());
      for (uint32_t b = parent.begin; b < parent.end;) {
        // The end of the octant, by bisection, as bodies are sorted by it.
        const uint64_t octant = keyed_[b].key >> shift;
        const auto past =
            std::partition_point(keyed_.begin() + b, keyed_.begin() + parent.end,
                                 [&](const Keyed& other) { return other.key >> shift == octant; });
        const auto e = static_cast<uint32_t>(past - keyed_.begin());
        nodes_.push_back({b, e});
        b = e;
      }
      nodes_[k].first_child = first, nodes_[k].children = static_cast<uint32_t>(nodes_.size()) - first;
    }
    begin = end;
    depth_ends_.push_back(nodes_.size());
  }
}

void BodyTree::gather_groups(size_t node) {
  const Node& n = nodes_[node];
  if (n.children == 0) {  // single, or more at one position than a group holds
    for (uint32_t b = n.begin; b < n.end; b += kMostInGroup) {
      groups_.push_back({b, std::min<uint32_t>(b + kMostInGroup, n.end)});
    }
    return;
  }
  Group run{n.begin, n.begin};
  const auto flush = [&] {
    if (run.end > run.begin) groups_.push_back(run);
  };
  for (size_t c = n.first_child; c < n.first_child + n.children; ++c) {
    const Node& child = nodes_[c];
    if (child.end - run.begin <= kMostInGroup) {
      run.end = child.end;
      continue;
    }
    flush();
    run = {child.begin, child.end};
    if (child.end - child.begin > kMostInGroup) gather_groups(c), run = {child.end, child.end};
  }
  flush();
}

double BodyTree::farthest(size_t node) const {
  const Point& c = centers_[node];
  double far2 = 0;
  for (size_t k = nodes_[node].begin; k < nodes_[node].end; ++k) {
    const double x = points_[k].x - c.x, y = points_[k].y - c.y, z = points_[k].z - c.z;
    far2 = std::max(far2, x * x + y * y + z * z);
  }
  return std::sqrt(far2);
}

void BodyTree::finish(size_t node) {
  const Point& c = centers_[node];
  const auto& s = seconds_[node];
  for (size_t k = 0; k < 6; ++k) moments_[node].s[k] = static_cast<float>(3 * s[k]);
  moments_[node].s[6] = static_cast<float>(1.5 * (s[0] + s[3] + s[5]));
  columns_.x[node] = static_cast<float>(c.x), columns_.y[node] = static_cast<float>(c.y);
  columns_.z[node] = static_cast<float>(c.z), columns_.mass[node] = static_cast<float>(c.m);
  // Exact for few bodies; otherwise a bound from the children's spheres.
  const Node& n = nodes_[node];
  double radius = 0;
  if (n.end - n.begin <= 8 * kMostInGroup || n.children == 0) {
    radius = farthest(node);
  } else {
    for (size_t k = n.first_child; k < n.first_child + n.children; ++k) {
      const Point& p = centers_[k];
      const double x = p.x - c.x, y = p.y - c.y, z = p.z - c.z;
      radius = std::max(radius, std::sqrt(x * x + y * y + z * z) + static_cast<double>(columns_.radius[k]));
    }
  }
  // Slightly more than it is, because of the centre's rounding.
  radius = radius * (1 + 1e-6) + 1e-7;
  columns_.radius[node] = static_cast<float>(radius);
  columns_.strength[node] = static_cast<float>(c.m * radius * radius * radius);
}

void BodyTree::sum_bodies(size_t node) {
  const Node& n = nodes_[node];
  Point c;
  for (size_t k = n.begin; k < n.end; ++k) {
    const Point& p = points_[k];
    c.x += p.m * p.x, c.y += p.m * p.y, c.z += p.m * p.z, c.m += p.m;
  }
  if (c.m > 0) {
    c.x /= c.m, c.y /= c.m, c.z /= c.m;
  } else {
    c = points_[n.begin];
  }
  centers_[node] = c;
  auto& s = seconds_[node];
  s = {};
  for (size_t k = n.begin; k < n.end; ++k) {
    const Point& p = points_[k];
    const double x = p.x - c.x, y = p.y - c.y, z = p.z - c.z;
    s[0] += p.m * x * x, s[1] += p.m * x * y, s[2] += p.m * x * z;
    s[3] += p.m * y * y, s[4] += p.m * y * z, s[5] += p.m * z * z;
  }
}

void BodyTree::sum_children(size_t node) {
  const Node& n = nodes_[node];
  Point c;
  for (size_t k = n.first_child; k < n.first_child + n.children; ++k) {
    const Point& p = centers_[k];
    c.x += p.m * p.x, c.y += p.m * p.y, c.z += p.m * p.z, c.m += p.m;
  }
  if (c.m > 0) {
    c.x /= c.m, c.y /= c.m, c.z /= c.m;
  } else {
    c = centers_[n.first_child];
  }
  centers_[node] = c;
  auto& s = seconds_[node];
  s = {};
  for (size_t k = n.first_child; k < n.first_child + n.children; ++k) {
    const Point& p = centers_[k];
    const auto& t = seconds_[k];
    const double x = p.x - c.x, y = p.y - c.y, z = p.z - c.z;
    s[0] += t[0] + p.m * x * x, s[1] += t[1] + p.m * x * y, s[2] += t[2] + p.m * x * z;
    s[3] += t[3] + p.m * y * y, s[4] += t[4] + p.m * y * z, s[5] += t[5] + p.m * z * z;
  }
}

void BodyTree::sum_moments(const ThreadArena& arena) {
  const size_t rows = nodes_.size() + kMostChildren;
  for (auto* column :
       {&columns_.x, &columns_.y, &columns_.z, &columns_.mass, &columns_.radius, &columns_.strength}) {
    column->reserve(nodes_.capacity() + kMostChildren);
    column->resize(rows);
    std::fill(column->begin() + static_cast<ptrdiff_t>(nodes_.size()), column->end(), 0.0f);
  }
  centers_.reserve(nodes_.capacity()), seconds_.reserve(nodes_.capacity()),
      moments_.reserve(nodes_.capacity());
  centers_.resize(nodes_.size()), seconds_.resize(nodes_.size()), moments_.resize(nodes_.size());
  for (size_t depth = depth_ends_.size(); depth-- > 0;) {
    const size_t from = depth == 0 ? 0 : depth_ends_[depth - 1];
    arena.for_blocks(depth_ends_[depth] - from, kNodeBlock, [&](size_t first, size_t last) {
      for (size_t k = from + first; k < from + last; ++k) {
        if (nodes_[k].children == 0) {
          sum_bodies(k);
        } else {
          sum_children(k);
        }
        finish(k);
      }
    });
  }
}

void BodyTree::build(const Bodies& bodies, const ThreadArena& arena) {
  const size_t n = bodies.size();
  keyed_.resize(n), sorted_.resize(n), points_.resize(n), rows_.resize(n);
  set_scales(bodies);
  sort(bodies, arena);
  divide();
  groups_.clear();
  gather_groups(0);
  sum_moments(arena);
}

}  // namespace truestep::gravity
