// Numbers of connected bodies, against flooding from every cell.
#include "engine/kernels/mac/connected.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

#include "engine/base/random.h"
#include "engine/kernels/mac/surface.h"

namespace truestep::mac {
namespace {

struct Case {
  MacGrid grid;
  std::vector<uint8_t> liquid;
  std::array<std::vector<double>, 3> faces;

  Case(std::array<size_t, 3> cells, size_t dimensions, std::array<bool, 3> periodic) {
    grid.dimensions = dimensions, grid.cells = cells, grid.periodic = periodic;
    liquid.assign(grid.size(), 0);
    for (auto& f : faces) f.assign(grid.size(), 0);
  }
  void wrap(const ThreadArena& arena) {
    wrap_periodic(grid, liquid.data(), arena);
    for (size_t c = 0; c < grid.dimensions; ++c) wrap_periodic(grid, faces[c].data(), arena);
  }
  template <class F>
  void each_cell(F&& f) const {
    for (size_t k = 0; k < grid.cells[2]; ++k) {
      for (size_t j = 0; j < grid.cells[1]; ++j) {
        for (size_t i = 0; i < grid.cells[0]; ++i) f(grid.at(i, j, k), std::array<size_t, 3>{i, j, k});
      }
    }
  }
  /// The cell beyond the lower (end 0) or upper face along an axis, if that face joins them.
  size_t beyond(size_t at, const std::array<size_t, 3>& cell, size_t a, int end) const {
    const size_t n = grid.cells[a], s = grid.stride(a);
    const bool side = end == 0 ? cell[a] == 0 : cell[a] + 1 == n;
    if (side && !grid.periodic[a]) return at;
    const size_t other = side ? (end == 0 ? at + (n - 1) * s : at - (n - 1) * s) : end == 0 ? at - s : at + s;
    return faces[a][end == 0 ? at : other] > 0 ? other : at;
  }
};

/// Every cell of liquid takes the least number around it until nothing changes.
std::vector<size_t> flooded(const Case& c) {
  std::vector<size_t> out(c.grid.size(), 0);
  c.each_cell([&](size_t at, const auto&) { out[at] = c.liquid[at] ? at + 1 : 0; });
  for (bool changed = true; changed;) {
    changed = false;
    c.each_cell([&](size_t at, const auto& cell) {
      for (size_t a = 0; a < c.grid.dimensions; ++a) {
        for (const int end : {0, 1}) {
          const size_t other = c.beyond(at, cell, a, end);
          if (out[at] == 0 || out[other] == 0 || out[other] >= out[at]) continue;
          out[at] = out[other], changed = true;
        }
      }
    });
  }
  return out;
}

TEST(MacConnected, BodiesAreThoseThatFloodingFinds) {
  const ThreadArena arena(2);
  size_t most = 0;
  for (uint64_t seed = 0; seed < 60; ++seed) {
    const bool space = seed % 2 != 0;
    const bool wraps = seed % 3 == 0;
    Case c({9, 7, space ? size_t{5} : size_t{1}}, space ? 3 : 2, {wraps, seed % 4 == 0, space && wraps});
    // At these shares there are many bodies, some of which wind through the box.
    c.each_cell([&](size_t at, const auto&) {
      const auto u = uniform4(seed, 0, at);
      c.liquid[at] = u[0] < (space ? 0.45 : 0.6);
      for (size_t a = 0; a < 3; ++a) c.faces[a][at] = u[a + 1] < 0.8 ? 0.5 : 0;
    });
    c.wrap(arena);
    std::vector<uint32_t> body(c.grid.size(), 7), scratch(c.grid.cell_count() + 1);
    const uint32_t count =
        number_bodies(c.grid, c.liquid.data(), {c.faces[0].data(), c.faces[1].data(), c.faces[2].data()},
                      body.data(), scratch, arena);
    const std::vector<size_t> expected = flooded(c);
    std::set<std::pair<size_t, uint32_t>> pairs;
    std::set<size_t> roots;
    uint32_t next = 1;
    c.each_cell([&](size_t at, const auto& cell) {
      if (c.liquid[at]) {
        pairs.insert({expected[at], body[at]}), roots.insert(expected[at]);
        EXPECT_LE(body[at], next) << "in the order of first cells";
        if (body[at] == next) ++next;
        return;
      }
      bool beside = body[at] == 0;
      for (size_t a = 0; a < c.grid.dimensions; ++a) {
        for (const int end : {0, 1}) {
          const size_t other = c.beyond(at, cell, a, end);
          if (!c.liquid[other]) continue;
          EXPECT_GT(body[at], 0u);
          beside = beside || body[at] == body[other];
        }
      }
      EXPECT_TRUE(beside);
    });
    EXPECT_EQ(pairs.size(), roots.size());
    EXPECT_EQ(count, roots.size());
    most = std::max<size_t>(most, count);
  }
  EXPECT_GT(most, 5u) << "control: there were several";
}

}  // namespace
}  // namespace truestep::mac
