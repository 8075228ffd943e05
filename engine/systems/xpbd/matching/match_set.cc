#include "engine/systems/xpbd/matching/match_set.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/systems/xpbd/matching/match_goal.h"

namespace truestep::xpbd {

namespace {

Mat3 outer(const Vec3& a, const Vec3& b, double s) {
  return {{s * a.x * b.x, s * a.x * b.y, s * a.x * b.z, s * a.y * b.x, s * a.y * b.y, s * a.y * b.z,
           s * a.z * b.x, s * a.z * b.y, s * a.z * b.z}};
}

}  // namespace

double MatchSet::energy(const double* x) const {
  if (!(omega2 < HUGE_VAL)) return 0;
  const auto place = [x](uint32_t p) { return load3(x, p); };
  double sum = 0;
  for (size_t g = 0; g < groups(); ++g) {
    const auto [centre, turn] = goal(g, place);
    for (uint32_t e = begin[g]; e < begin[g + 1]; ++e) {
      sum += 0.5 * omega2 * masses[e] * norm2(centre + turn * rest[e] - place(points[e]));
    }
  }
  return sum;
}

MatchSet build_matches(const MatchDef& def, const Body& body) {
  constexpr double kTwoPi = 6.28318530717958647692;
  MatchSet out;
  const double omega = kTwoPi * def.frequency.value_or(0);
  out.omega2 = def.frequency ? omega * omega : HUGE_VAL, out.linear = def.linear;
  // The smallest row of each row's connected component.
  std::vector<uint32_t> root(body.x.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](uint32_t p) {
    while (root[p] != p) p = root[p] = root[root[p]];
    return p;
  };
  for (const Link& l : body.links) {
    const uint32_t a = find(l.a), b = find(l.b);
    root[std::max(a, b)] = std::min(a, b);
  }
  std::vector<std::pair<uint32_t, uint32_t>> rows;
  for (uint32_t p = 0; p < root.size(); ++p) rows.emplace_back(find(p), p);
  std::sort(rows.begin(), rows.end());
  for (size_t i = 0; i < rows.size();) {
    const size_t first = i;
    Vec3 centre;
    double mass = 0;
    for (; i < rows.size() && rows[i].first == rows[first].first; ++i) {
      const double m = body.masses[rows[i].second];
      centre += body.x[rows[i].second] * m, mass += m;
    }
    centre = centre / mass;
    Mat3 spread;
    out.begin.push_back(static_cast<uint32_t>(out.points.size()));
    for (size_t k = first; k < i; ++k) {
      const uint32_t p = rows[k].second;
      const Vec3 q = body.x[p] - centre;
      out.points.push_back(p), out.masses.push_back(body.masses[p]), out.rest.push_back(q);
      spread = spread + outer(q, q, body.masses[p]);
    }
    out.inverse.push_back(inverse_or_zero(spread));
  }
  out.begin.push_back(static_cast<uint32_t>(out.points.size()));
  return out;
}

}  // namespace truestep::xpbd
