// Observables of a crowd as a whole, and its drawing.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/systems/crowd/crowd_rows.h"

namespace truestep::crowd {
namespace {
constexpr double kHalfTurn = 3.141592653589793;
}  // namespace

/// Nowak, Schadschneider 2012 (Phys. Rev. E 85:066128, after Rex, Loewen 2007), with a strip around each
/// person instead of a row of cells: 1 when everybody in it walks the same way, small when both directions
/// are mixed.
double Crowd::lane_order(const State& s) const {
  const size_t n = s.rows(Columns::position);
  const double* x = s.f64(Columns::position).data();
  const auto group = s.span<uint32_t>(Columns::group);
  std::vector<std::pair<double, int>> rows;
  for (size_t i = 0; i < n; ++i) {
    const auto& heading = def_.groups[group[i]].heading;
    if (heading && heading->x != 0) rows.emplace_back(x[3 * i + 1], heading->x > 0 ? 1 : -1);
  }
  if (rows.empty()) return 0;
  std::sort(rows.begin(), rows.end());
  double sum = 0;
  long net = 0;
  size_t low = 0, high = 0;
  for (const auto& [y, way] : rows) {
    while (high < rows.size() && rows[high].first <= y + 0.5 * def_.lane_width) net += rows[high++].second;
    while (rows[low].first < y - 0.5 * def_.lane_width) net -= rows[low++].second;
    const double share = static_cast<double>(net) / static_cast<double>(high - low);
    sum += share * share;
  }
  return sum / static_cast<double>(rows.size());
}

void Crowd::observe(const State& s, double, Observables& out) const {
  const size_t n = s.rows(Columns::position);
  const double count = static_cast<double>(n), *v = s.f64(Columns::velocity).data();
  double speed = 0, energy = 0, arrived = 0;
  for (size_t i = 0; i < n; ++i) {
    const double u2 = norm2(load3(v, i));
    speed += std::sqrt(u2), energy += 0.5 * s.f64(Columns::mass)[i] * u2;
    if (at_goal(s, i)) arrived += 1;
  }
  Sorted sorted;
  sorted.build(s, std::max(reach_, def_.density_radius), ThreadArena{});
  double smallest = HUGE_VAL, pressure = 0, density = 0;
  const double disc = def_.density_radius * def_.density_radius;
  for (size_t slot = 0; slot < n; ++slot) {
    const Load l = load(sorted, s, slot);
    smallest = std::min(smallest, l.gap);
    const double r = sorted.r[slot];
    if (def_.model == Model::social_force && r > 0)
      pressure = std::max(pressure, l.radial / (2 * kHalfTurn * r));
    images(sorted.grid.position(slot), def_.density_radius, [&](const Vec3& shift) {
      const Vec3 p = sorted.grid.position(slot) + shift;
      sorted.grid.near(p, [&](size_t from, size_t to) {
        for (size_t q = from; q < to; ++q) density += norm2(sorted.grid.position(q) - p) <= disc ? 1 : 0;
      });
    });
  }
  const double left = s.f64(Columns::tally)[0];
  out.add("people", count, "1");
  out.add("left", left, "1");
  out.add("arrived", left + arrived, "1");
  out.add("speed.mean", n > 0 ? speed / count : 0.0, "m/s");
  out.add("density.mean", n > 0 ? density / (count * kHalfTurn * disc) : 0.0, "1/m^2");
  out.add("energy.kinetic", energy, "J");
  // Nobody is looked for farther away.
  out.add("separation.smallest", smallest < HUGE_VAL ? smallest : reach_, "m");
  out.add("pressure.largest", pressure, "N/m");
  out.add("lanes.order", lane_order(s), "1");
  for (size_t k = 0; k < def_.doors.size(); ++k) {
    const double* row = &s.f64(Columns::doors)[4 * k];
    const std::string name = "door." + def_.doors[k].id;
    out.add(name + ".forward", row[0], "1");
    out.add(name + ".backward", row[1], "1");
    out.add(name + ".flow", row[3] > row[2] ? (row[0] - 1) / (row[3] - row[2]) : 0.0, "1/s");
  }
}

FieldView Crowd::field(const State& s, size_t part, size_t which, std::vector<double>& scratch) const {
  // Groups are runs of rows, in their order.
  const auto group = s.span<uint32_t>(Columns::group);
  const auto [from, to] = std::equal_range(group.begin(), group.end(), static_cast<uint32_t>(part));
  const size_t first = static_cast<size_t>(from - group.begin()), n = static_cast<size_t>(to - from);
  if (which == 0) return {s.f64(Columns::position).data() + 3 * first, Scalar::f64, n, 3};
  if (which == 1) return {s.f64(Columns::velocity).data() + 3 * first, Scalar::f64, n, 3};
  if (which == 3) return {s.f64(Columns::radius).data() + first, Scalar::f64, n, 1};
  scratch.assign(n, 0);
  if (which == 2) {
    for (size_t i = 0; i < n; ++i) scratch[i] = norm(load3(s.f64(Columns::velocity).data(), first + i));
  } else if (def_.model == Model::social_force) {
    Sorted sorted;
    sorted.build(s, reach_, ThreadArena{});
    for (size_t slot = 0; slot < sorted.grid.size(); ++slot) {
      const size_t row = sorted.grid.point(slot);
      if (row < first || row >= first + n || !(sorted.r[slot] > 0)) continue;
      scratch[row - first] = load(sorted, s, slot).radial / (2 * kHalfTurn * sorted.r[slot]);
    }
  }
  return {scratch.data(), Scalar::f64, n, 1};
}

void Crowd::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::obstacles)) {
    constexpr double kThick = 0.05, kHigh = 0.5;
    for (const Segment& w : walls_.pieces()) {
      const Vec3 d = w.b - w.a;
      const double half_turn = 0.5 * trig::atan2(d.y, d.x);
      DrawnShape box;
      box.kind = DrawnShape::Kind::box, box.position = (w.a + w.b) * 0.5;
      const trig::SinCos a = trig::sincos(half_turn);
      box.orientation = {a.cos, 0, 0, a.sin};
      box.size = {0.5 * norm(d) + kThick, kThick, kHigh};
      out.obstacles.push_back(box);
    }
  }
  if (!wants(wishes, Wish::constant)) return;
  for (const GroupDef& g : def_.groups) {
    PartDrawing& p = out.parts.emplace_back();
    p.space = PartDrawing::Space::plane;
    p.point_radius = std::max(g.radius, 0.05);
    if (g.color) p.color = {g.color->x, g.color->y, g.color->z};
  }
}

}  // namespace truestep::crowd
