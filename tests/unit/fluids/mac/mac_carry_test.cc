// Scalars in flux form: sums stay, values stay between their extremes, a constant stays one.
#include "engine/kernels/mac/carry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/kernels/mac/ghosts.h"

namespace truestep::mac {
namespace {

/// Eddies that drift through a periodic square: without divergence to rounding, differences of a stream
/// function at the cells' corners.
struct CarryRun {
  explicit CarryRun(size_t n) {
    g.cells = {n, n, 1};
    g.spacing = {1.0 / double(n), 1.0 / double(n), 1};
    g.periodic = {true, true, false};
    for (auto& axis : sides) axis[0].mirror = axis[1].mirror = Mirror::periodic;
    for (auto* a : {&u, &v, &q, &content, &room, &flux}) a->assign(g.size(), 0);
    const double k = 2 * std::numbers::pi;
    const auto psi = [&](size_t i, size_t j) {
      const double x = double(i) / double(n), y = double(j) / double(n);
      return std::sin(k * x) * std::sin(k * y) / k + 0.3 * y - 0.2 * x;
    };
    for (size_t j = 0; j < n; ++j) {
      for (size_t i = 0; i < n; ++i) {
        u[g.at(i, j, 0)] = (psi(i, j + 1) - psi(i, j)) * double(n);
        v[g.at(i, j, 0)] = -(psi(i + 1, j) - psi(i, j)) * double(n);
      }
    }
    fill_ghosts(g, 0, sides, u.data(), arena), fill_ghosts(g, 1, sides, v.data(), arena);
    outflow = largest_outflow(g, {u.data(), v.data(), nullptr}, arena);
  }
  enum class Room { kept, forgotten };
  /// Crosses up to `most` of a cell's volume.
  void step(size_t number, double most, Room kept = Room::kept) {
    const double h = most / outflow;
    fill_all(g, 1.0, room.data(), arena);
    content = q;
    for (size_t k = 0; k < 2; ++k) {
      const size_t axis = (number + k) % 2;
      const double* w = axis == 0 ? u.data() : v.data();
      fill_ghosts(g, kCentre, sides, q.data(), arena), fill_ghosts(g, kCentre, sides, room.data(), arena);
      scalar_flux(g, axis, w, h, q.data(), room.data(), flux.data(), arena);
      pass_scalar(g, axis, w, h, flux.data(), content.data(), room.data(), q.data(), arena);
      if (kept == Room::forgotten) fill_all(g, 1.0, room.data(), arena), q = content;
    }
    q = content;
  }
  std::pair<double, double> extremes() const {
    double low = 1e300, high = -1e300;
    for_rows(g, kCentre, arena, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = at; i < at + n; ++i) low = std::min(low, q[i]), high = std::max(high, q[i]);
    });
    return {low, high};
  }
  double sum() const {
    double total = 0;
    for_rows(g, kCentre, arena, [&](size_t at, size_t, size_t, size_t n) {
      for (size_t i = at; i < at + n; ++i) total += q[i];
    });
    return total / double(g.cell_count());
  }

  MacGrid g;
  Sides sides;
  ThreadArena arena{1};
  std::vector<double> u, v, q, content, room, flux;
  double outflow = 0;
};

TEST(MacCarry, SumsStayAndValuesStayBetweenTheirExtremes) {
  CarryRun run(32);
  uint64_t seed = 7;
  for (double& x : run.q) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    x = double(seed >> 63);
  }
  const double before = run.sum();
  double low = 0, high = 1;
  for (size_t k = 0; k < 200; ++k) {
    run.step(k, 1);
    const auto [least, most] = run.extremes();
    low = std::min(low, least), high = std::max(high, most);
  }
  EXPECT_NEAR(run.sum(), before, 1e-13);
  // Rounding of a few hundred sweeps.
  EXPECT_GT(low, -1e-12);
  EXPECT_LT(high, 1 + 1e-12);
  EXPECT_LT(run.extremes().second, 0.9) << "it has been mixed";
  // Control: where twice a cell's volume leaves it in a step, values do not stay.
  CarryRun far(32);
  far.q = CarryRun(32).q;
  far.q[far.g.at(5, 9, 0)] = 1;
  for (size_t k = 0; k < 20; ++k) far.step(k, 2.5);
  EXPECT_LT(far.extremes().first, -1e-3);
}

TEST(MacCarry, AConstantStaysOne) {
  CarryRun run(32), forgets(32);
  std::fill(run.q.begin(), run.q.end(), 1.0), std::fill(forgets.q.begin(), forgets.q.end(), 1.0);
  for (size_t k = 0; k < 20; ++k) run.step(k, 1), forgets.step(k, 1, CarryRun::Room::forgotten);
  const auto [low, high] = run.extremes();
  EXPECT_NEAR(low, 1, 1e-12);
  EXPECT_NEAR(high, 1, 1e-12);
  // Control: without the room that the first axis has left.
  EXPECT_GT(forgets.extremes().second - forgets.extremes().first, 1e-3);
}

TEST(MacCarry, OutflowIsWhatLeavesACellThroughAllFaces) {
  CarryRun run(8);
  std::fill(run.u.begin(), run.u.end(), -2.0), std::fill(run.v.begin(), run.v.end(), 0.5);
  EXPECT_NEAR(largest_outflow(run.g, {run.u.data(), run.v.data(), nullptr}, run.arena), 8 * 2.5, 1e-12);
  // A source in a cell: all four faces.
  std::fill(run.u.begin(), run.u.end(), 0.0), std::fill(run.v.begin(), run.v.end(), 0.0);
  const size_t cell = run.g.at(3, 4, 0);
  run.u[cell] = run.v[cell] = -1, run.u[cell + 1] = run.v[cell + run.g.stride(1)] = 1;
  EXPECT_NEAR(largest_outflow(run.g, {run.u.data(), run.v.data(), nullptr}, run.arena), 8 * 4, 1e-12);
}

}  // namespace
}  // namespace truestep::mac
