#include "engine/systems/xpbd/sheets/fold_surface.h"

#include <algorithm>
#include <tuple>

#include "engine/geometry/make/surface.h"

namespace truestep::xpbd {

FoldSurface::FoldSurface(const Body& body) : rest_(body.x) {
  for (const auto& t : body.triangles)
    facets_.push_back({.points = t, .corners = 3, .own_points = 0, .own_edges = 0});
  if (facets_.empty()) {
    for (const Link& l : body.links)
      facets_.push_back({.points = {l.a, l.b, l.b}, .corners = 2, .own_points = 0, .own_edges = 0});
  }
  own();
  find_near();
  if (!body.triangles.empty()) find_hinges();
}

void FoldSurface::follow_tears(std::span<const uint32_t> corners, std::span<const uint32_t> origin) {
  rest_.resize(origin.size());
  // Rows split off come after the rows they came from.
  for (size_t i = 0; i < origin.size(); ++i) rest_[i] = rest_[origin[i]];
  for (size_t f = 0; f < facets_.size(); ++f) {
    facets_[f] = {.points = {corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]},
                  .corners = 3,
                  .own_points = 0,
                  .own_edges = 0};
  }
  mean_edge_ = 0;
  own();
  find_hinges();
}

void FoldSurface::find_hinges() {
  std::vector<std::array<uint32_t, 3>> triangles;
  for (const Facet& f : facets_) triangles.push_back(f.points);
  hinges_.clear();
  const auto edges = sorted_edges(triangles);
  for (size_t i = 1; i < edges.size(); ++i) {
    const auto &e = edges[i], &f = edges[i - 1];
    if (e[0] == f[0] && e[1] == f[1] && e[2] != f[2]) hinges_.push_back({e[0], e[1], f[2], e[2]});
  }
}

void FoldSurface::own() {
  struct Edge {
    uint32_t a, b;
    size_t facet, k;
    auto key() const { return std::tuple(a, b, facet); }
  };
  std::vector<Edge> edges;
  std::vector<uint8_t> taken(rest_.size());
  for (size_t f = 0; f < facets_.size(); ++f) {
    Facet& facet = facets_[f];
    // A link has one edge; its ends also meet other edges as end points.
    for (size_t k = 0; k < (facet.corners == 3 ? 3u : 1u); ++k) {
      const uint32_t p = facet.points[k], q = facet.points[(k + 1) % 3];
      edges.push_back({std::min(p, q), std::max(p, q), f, k});
      if (facet.corners < 3 || taken[p]) continue;
      taken[p] = 1;
      facet.own_points |= static_cast<uint8_t>(1u << k);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) { return x.key() < y.key(); });
  size_t count = 0;
  for (size_t i = 0; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    if (i > 0 && edges[i - 1].a == e.a && edges[i - 1].b == e.b) continue;
    facets_[e.facet].own_edges |= static_cast<uint8_t>(1u << e.k);
    if (i + 1 < edges.size() && edges[i + 1].a == e.a && edges[i + 1].b == e.b) {
      facets_[e.facet].across[e.k] = facets_[edges[i + 1].facet].points[(edges[i + 1].k + 2) % 3];
    }
    mean_edge_ += norm(rest_[e.b] - rest_[e.a]), ++count;
  }
  if (count > 0) mean_edge_ /= static_cast<double>(count);
}

void FoldSurface::find_near() {
  std::vector<size_t> start(rest_.size() + 1);
  for (const Facet& f : facets_) {
    for (size_t k = 0; k < f.corners; ++k) ++start[f.points[k] + 1];
  }
  for (size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  std::vector<uint32_t> at(start.back());
  auto next = start;
  for (uint32_t f = 0; f < facets_.size(); ++f) {
    for (size_t k = 0; k < facets_[f].corners; ++k) at[next[facets_[f].points[k]]++] = f;
  }
  std::vector<uint32_t> seen(facets_.size(), UINT32_MAX);
  begin_.push_back(0);
  for (uint32_t f = 0; f < facets_.size(); ++f) {
    const size_t first = near_.size();
    const auto around = [&](uint32_t facet, const auto& visit) {
      for (size_t k = 0; k < facets_[facet].corners; ++k) {
        const uint32_t p = facets_[facet].points[k];
        for (size_t e = start[p]; e < start[p + 1]; ++e) visit(at[e]);
      }
    };
    around(f, [&](uint32_t g) {
      around(g, [&](uint32_t far) {
        if (far <= f || seen[far] == f) return;
        seen[far] = f;
        near_.push_back(far);
      });
    });
    std::sort(near_.begin() + static_cast<ptrdiff_t>(first), near_.end());
    begin_.push_back(near_.size());
  }
}

}  // namespace truestep::xpbd
