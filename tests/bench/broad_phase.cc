// Broad phase time per step: our trees beside sort-and-sweep along the widest axis and beside the cell grid
// of point contacts, both rebuilt in every step as they must be. Scenes: a pyramid of 1240 boxes at rest, a
// creeping pile of 2000 bodies, 1e5 random boxes at rest and all moving. Seconds per step; every method must
// find the same pairs.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "engine/base/random.h"
#include "engine/collision/broad/box_grid.h"
#include "engine/collision/broad/broad_phase.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;

struct Scene {
  const char* name;
  std::vector<Box> boxes;
  double speed;  // m per step, each body in its own direction
  double margin;
};

void add(Scene& s, const Vec3& c, const Vec3& h) {
  s.boxes.push_back(Box{c - h, c + h}.grown(0.01));
}

Scene pyramid() {
  Scene s{"pyramid of 1240 boxes at rest", {}, 1e-5, 0.05};
  for (int k = 0; k < 15; ++k) {
    for (int i = 0; i < 15 - k; ++i) {
      for (int j = 0; j < 15 - k; ++j)
        add(s, Vec3{i + 0.5 * k, 0, j + 0.5 * k} * 1.05 + Vec3{0, 0.5 + k, 0}, {0.5, 0.5, 0.5});
    }
  }
  return s;
}

Scene pile() {
  Scene s{"pile of 2000 bodies creeping", {}, 2e-3, 0.05};
  for (uint64_t i = 0; i < 2000; ++i) {
    const auto u = uniform4(1, 1, i);
    add(s, {20 * u[0] - 10, 4 * u[1], 20 * u[2] - 10}, Vec3{0.35, 0.35, 0.35} + Vec3{0.2, 0.2, 0.2} * u[3]);
  }
  return s;
}

Scene random_boxes(const char* name, double speed) {
  Scene s{name, {}, speed, 0.05};
  for (uint64_t i = 0; i < 100000; ++i) {
    const auto u = uniform4(2, 1, i);
    add(s, Vec3{u[0], u[1], u[2]} * 100.0, {0.6, 0.6, 0.6});
  }
  return s;
}

void step(Scene& s, uint64_t t) {
  for (size_t i = 0; i < s.boxes.size(); ++i) {
    const auto u = uniform4(3, t % 16 < 8 ? 0 : 1, i);
    const Vec3 d = Vec3{u[0] - 0.5, u[1] - 0.5, u[2] - 0.5} * (2 * s.speed);
    s.boxes[i] = {s.boxes[i].low + d, s.boxes[i].high + d};
  }
}

/// Sorted along x, then every box against those that begin before it ends.
size_t sweep(const std::vector<Box>& boxes, std::vector<uint32_t>& order, std::vector<uint64_t>& pairs) {
  order.resize(boxes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return boxes[a].low.x < boxes[b].low.x; });
  pairs.clear();
  for (size_t i = 0; i < order.size(); ++i) {
    const Box& a = boxes[order[i]];
    for (size_t j = i + 1; j < order.size() && boxes[order[j]].low.x <= a.high.x; ++j) {
      if (!a.overlaps(boxes[order[j]])) continue;
      const uint64_t p = std::min(order[i], order[j]), q = std::max(order[i], order[j]);
      pairs.push_back(p << 32 | q);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs.size();
}

size_t grid(const std::vector<Box>& boxes, BoxGrid& cells, std::vector<uint64_t>& pairs) {
  cells.build(boxes);
  pairs.clear();
  for (uint32_t i = 0; i < boxes.size(); ++i) {
    cells.overlapping(boxes[i], [&](uint32_t j) {
      if (j > i) pairs.push_back(uint64_t{i} << 32 | j);
    });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs.size();
}

void compare(Scene s, int rounds) {
  BroadPhase trees;
  BoxGrid cells;
  std::vector<Mobility> mobility(s.boxes.size(), Mobility::moving);
  std::vector<uint32_t> order;
  std::vector<uint64_t> pairs;
  std::vector<double> ours, by_sweep, by_grid;
  for (int r = 0; r < rounds; ++r) {
    step(s, static_cast<uint64_t>(r));
    const double t0 = bench::thread_seconds();
    const size_t n = trees.update(s.boxes, mobility, s.margin).size();
    const double t1 = bench::thread_seconds();
    const size_t m = sweep(s.boxes, order, pairs);
    const double t2 = bench::thread_seconds();
    const size_t k = grid(s.boxes, cells, pairs);
    const double t3 = bench::thread_seconds();
    // Boxes rounded to floats may touch where doubles do not.
    if (n < m || n > m + 5 || k != m) {
      std::fprintf(stderr, "%s: %zu, %zu and %zu pairs\n", s.name, n, m, k);
      std::exit(1);
    }
    if (r < 3) continue;
    ours.push_back(t1 - t0), by_sweep.push_back(t2 - t1), by_grid.push_back(t3 - t2);
  }
  const auto middle = [](std::vector<double>& v) {
    return bench::median(v.data(), static_cast<int>(v.size()));
  };
  const double t = middle(ours);
  bench::report({.bench = "broad_phase",
                 .metric = std::string("seconds per step, ") + s.name,
                 .ours = t,
                 .peer = middle(by_sweep),
                 .peer_name = "sort and sweep"});
  bench::report({.bench = "broad_phase",
                 .metric = std::string("seconds per step, ") + s.name,
                 .ours = t,
                 .peer = middle(by_grid),
                 .peer_name = "cell grid"});
}

}  // namespace

int main() {
  compare(pyramid(), 40);
  compare(pile(), 40);
  compare(random_boxes("100000 random boxes at rest", 1e-5), 11);
  compare(random_boxes("100000 random boxes, each 0.1 m a step", 0.1), 11);
}
