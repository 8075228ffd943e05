// What a crowd gives out: its groups, observables of all people, and those of each door.
#include <algorithm>
#include <cmath>

#include "engine/core/outputs/outputs_of.h"
#include "engine/systems/crowd/crowd_rows.h"

namespace truestep::crowd {
namespace {
constexpr double kHalfTurn = 3.141592653589793;
}  // namespace

struct Crowd::Whole {
  double people, left, arrived, speed, density, energy, separation, pressure, order;
};
struct Crowd::Passages {
  double forward, backward, flow;
};

const OutputTable& Crowd::outputs() {
  using C = Columns;
  static const OutputTable kTable =
      OutputsOf<Crowd>("a present person of the first group; in part group<k> one of group k")
          .part("", [](const Crowd& c) { return points_part(people_of(c.def_.groups[0])); })
          .rows([](const Crowd&, const State& s, size_t) { return rows_of(s, 0); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(C::position), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(C::velocity), "")
          .field({"speed", "m/s"}, length_of(C::velocity), "magnitude of the velocity")
          .field({"radius", "m"}, column(C::radius), "")
          .field({"pressure", "N/m"},
                 computed_by<Crowd>([](const Crowd& c, const State& s, ShownRows rows, double* out) {
                   c.fill_pressure(s, rows, out);
                 }),
                 "radial forces over circumference; of orca 0")
          .part("group<k>",
                [](const Crowd& c) {
                  std::vector<PartInfo> parts;
                  for (size_t k = 1; k < c.def_.groups.size(); ++k) {
                    parts.push_back(points_part(people_of(c.def_.groups[k])));
                    parts.back().name = "group" + std::to_string(k);
                  }
                  return parts;
                })
          .rows([](const Crowd&, const State& s, size_t k) { return rows_of(s, k + 1); })
          .like_main("of part group<k>: those of group k, from 1; and so on")
          .measured(&Crowd::whole,
                    {{"people", "1", &Whole::people, "still there"},
                     {"left", "1", &Whole::left, "people who have arrived and left"},
                     {"arrived", "1", &Whole::arrived, "people who are at their goals or have left"},
                     {"speed.mean", "m/s", &Whole::speed, "0 when nobody is left, like the next"},
                     {"density.mean", "1/m^2", &Whole::density,
                      "of people within density_radius, mean over people"},
                     {"energy.kinetic", "J", &Whole::energy},
                     {"separation.smallest", "m", &Whole::separation,
                      "smallest between two rims; negative: in contact; the reach if nobody is within it"},
                     {"pressure.largest", "N/m", &Whole::pressure,
                      "largest radial force on a person over circumference"},
                     {"lanes.order", "1", &Whole::order,
                      "mean of ((same - other) / (same + other))^2 within lane_width"}})
          .measured_each(
              &Crowd::doors, &Crowd::passages,
              {{"door.<id>.forward", "1", &Passages::forward,
                "crossings from right to left, seen from its first point"},
               {"door.<id>.backward", "1", &Passages::backward},
               {"door.<id>.flow", "1/s", &Passages::flow, "from the first forward crossing to the last"}})
          .build();
  return kTable;
}

const Outputs& crowd_outputs() {
  static const Outputs kDescribed = Crowd::outputs().described();
  return kDescribed;
}

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

Crowd::Whole Crowd::whole(const State& s, double) const {
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
  return {.people = count,
          .left = left,
          .arrived = left + arrived,
          .speed = n > 0 ? speed / count : 0.0,
          .density = n > 0 ? density / (count * kHalfTurn * disc) : 0.0,
          .energy = energy,
          // Nobody is looked for farther away.
          .separation = smallest < HUGE_VAL ? smallest : reach_,
          .pressure = pressure,
          .order = lane_order(s)};
}

Crowd::Passages Crowd::passages(const State& s, double, size_t door) const {
  const double* row = &s.f64(Columns::doors)[4 * door];
  return {row[0], row[1], row[3] > row[2] ? (row[0] - 1) / (row[3] - row[2]) : 0.0};
}

std::vector<std::string> Crowd::doors() const {
  std::vector<std::string> ids;
  for (const auto& door : def_.doors) ids.push_back(door.id);
  return ids;
}

ShownRows Crowd::rows_of(const State& s, size_t group) {
  // Groups are runs of rows, in their order.
  const auto all = s.span<uint32_t>(Columns::group);
  const auto [from, to] = std::equal_range(all.begin(), all.end(), static_cast<uint32_t>(group));
  return {static_cast<size_t>(from - all.begin()), static_cast<size_t>(to - from)};
}

void Crowd::fill_pressure(const State& s, ShownRows rows, double* out) const {
  std::fill_n(out, rows.count, 0.0);
  if (def_.model != Model::social_force) return;
  Sorted sorted;
  sorted.build(s, reach_, ThreadArena{});
  for (size_t slot = 0; slot < sorted.grid.size(); ++slot) {
    const size_t row = sorted.grid.point(slot);
    if (row < rows.first || row >= rows.first + rows.count || !(sorted.r[slot] > 0)) continue;
    out[row - rows.first] = load(sorted, s, slot).radial / (2 * kHalfTurn * sorted.r[slot]);
  }
}

}  // namespace truestep::crowd
