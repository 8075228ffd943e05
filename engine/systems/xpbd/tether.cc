#include "engine/systems/xpbd/tether.h"

#include <cmath>
#include <queue>

namespace truestep::xpbd {

std::vector<Tether> build_tethers(const Body& body, double slack) {
  const size_t n = body.x.size();
  std::vector<std::vector<std::pair<uint32_t, double>>> beside(n);
  for (const Link& l : body.links) beside[l.a].push_back({l.b, l.rest}), beside[l.b].push_back({l.a, l.rest});
  // Dijkstra from all pins at once; ties go to the first pin.
  struct Reached {
    double way;
    uint32_t point, anchor;
    bool operator>(const Reached& o) const {
      return way != o.way ? way > o.way : anchor != o.anchor ? anchor > o.anchor : point > o.point;
    }
  };
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
  std::vector<double> way(n, HUGE_VAL);
  std::vector<uint32_t> anchor(n, UINT32_MAX);
  for (const uint32_t p : body.pins) open.push({0, p, p});
  while (!open.empty()) {
    const Reached at = open.top();
    open.pop();
    if (anchor[at.point] != UINT32_MAX) continue;
    anchor[at.point] = at.anchor, way[at.point] = at.way;
    for (const auto& [next, length] : beside[at.point]) {
      if (anchor[next] == UINT32_MAX) open.push({at.way + length, next, at.anchor});
    }
  }
  std::vector<Tether> out;
  for (uint32_t i = 0; i < n; ++i) {
    if (anchor[i] != UINT32_MAX && anchor[i] != i) out.push_back({i, anchor[i], way[i] * (1 + slack)});
  }
  return out;
}

}  // namespace truestep::xpbd
