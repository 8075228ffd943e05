#include "engine/kernels/fem/element.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace truestep::fem {

namespace {

struct OneD {
  double n, dn;
};
// Lagrange polynomial of the node at `at` (-1, 0 or 1), linear or quadratic.
OneD lagrange(double at, double x, int order) {
  if (order == 1) return {0.5 * (1 + at * x), 0.5 * at};
  if (at == 0) return {1 - x * x, -2 * x};
  return {0.5 * x * (x + at), x + 0.5 * at};
}

bool quadratic(const Element& e) {
  return e.nodes.size() > e.corners;
}

void simplex_shape(const Element& e, const Vec3& p, std::vector<double>& n, std::vector<Vec3>& g) {
  const double l[4] = {1 - p.x - p.y - p.z, p.x, p.y, p.z};
  constexpr Vec3 dl[4] = {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto flat = [&](Vec3 v) {
    if (e.dimension < 3) v.z = 0;
    return v;
  };
  for (size_t a = 0; a < e.size(); ++a) {
    const auto& s = e.supports[a];
    if (!quadratic(e)) {
      n[a] = l[s[0]], g[a] = flat(dl[s[0]]);
    } else if (s.size() == 1) {
      n[a] = l[s[0]] * (2 * l[s[0]] - 1), g[a] = flat((4 * l[s[0]] - 1) * dl[s[0]]);
    } else {
      n[a] = 4 * l[s[0]] * l[s[1]], g[a] = flat(4 * (l[s[1]] * dl[s[0]] + l[s[0]] * dl[s[1]]));
    }
  }
}

void product_shape(const Element& e, const Vec3& p, std::vector<double>& n, std::vector<Vec3>& g) {
  const int order = quadratic(e) ? 2 : 1;
  for (size_t a = 0; a < e.size(); ++a) {
    const Vec3& r = e.nodes[a];
    const OneD x = lagrange(r.x, p.x, order);
    const OneD y = e.dimension > 1 ? lagrange(r.y, p.y, order) : OneD{1, 0};
    const OneD z = e.dimension > 2 ? lagrange(r.z, p.z, order) : OneD{1, 0};
    n[a] = x.n * y.n * z.n;
    g[a] = {x.dn * y.n * z.n, x.n * y.dn * z.n, x.n * y.n * z.dn};
  }
}

void set_rule(Element& e) {
  const bool second = quadratic(e);
  if (e.simplex && e.dimension == 2) {
    e.points = second ? std::vector<Vec3>{{1. / 6, 1. / 6, 0}, {2. / 3, 1. / 6, 0}, {1. / 6, 2. / 3, 0}}
                      : std::vector<Vec3>{{1. / 3, 1. / 3, 0}};
    e.weights.assign(e.points.size(), 0.5 / static_cast<double>(e.points.size()));
  } else if (e.simplex) {
    const double a = 0.25 + 0.15 * std::sqrt(5.0), b = 0.25 - 0.05 * std::sqrt(5.0);
    e.points = second ? std::vector<Vec3>{{b, b, b}, {a, b, b}, {b, a, b}, {b, b, a}}
                      : std::vector<Vec3>{{0.25, 0.25, 0.25}};
    e.weights.assign(e.points.size(), 1 / 6. / static_cast<double>(e.points.size()));
  } else {
    const double r = second ? std::sqrt(0.6) : std::sqrt(1. / 3);
    const std::vector<double> x = second ? std::vector{-r, 0., r} : std::vector{-r, r};
    const std::vector<double> w = second ? std::vector{5. / 9, 8. / 9, 5. / 9} : std::vector{1., 1.};
    const size_t m = x.size(), my = e.dimension > 1 ? m : 1, mz = e.dimension > 2 ? m : 1;
    for (size_t k = 0; k < mz; ++k) {
      for (size_t j = 0; j < my; ++j) {
        for (size_t i = 0; i < m; ++i) {
          e.points.push_back({x[i], my > 1 ? x[j] : 0, mz > 1 ? x[k] : 0});
          e.weights.push_back(w[i] * (my > 1 ? w[j] : 1) * (mz > 1 ? w[k] : 1));
        }
      }
    }
  }
  std::vector<double> n(e.size());
  std::vector<Vec3> g(e.size());
  for (const Vec3& p : e.points) {
    shape_at(e, p, n, g);
    e.shape.insert(e.shape.end(), n.begin(), n.end());
    e.gradient.insert(e.gradient.end(), g.begin(), g.end());
  }
}

// Exact integrals of N_a^2, scaled: 6 : 32 for quadratic simplices, in space and in the plane.
void set_lump(Element& e) {
  double total = 0;
  for (size_t a = 0; a < e.size(); ++a) {
    double share = 1;
    if (e.simplex) {
      if (quadratic(e)) share = e.supports[a].size() == 1 ? 6 : 32;
    } else if (quadratic(e)) {
      const Vec3& r = e.nodes[a];
      for (const double c : {r.x, e.dimension > 1 ? r.y : 1, e.dimension > 2 ? r.z : 1})
        share *= c == 0 ? 4 : 1;
    }
    e.lump.push_back(share);
    total += share;
  }
  for (double& s : e.lump) s /= total;
}

using Lists = std::vector<std::vector<uint32_t>>;

Element make(std::string_view name, uint32_t dimension, bool simplex, std::vector<Vec3> corners,
             const Lists& middles) {
  Element e;
  e.name = name, e.dimension = dimension, e.simplex = simplex;
  e.corners = static_cast<uint32_t>(corners.size());
  e.nodes = std::move(corners);
  for (uint32_t c = 0; c < e.corners; ++c) e.supports.push_back({c});
  for (const auto& m : middles) {
    Vec3 at;
    for (const uint32_t c : m) at += e.nodes[c] / static_cast<double>(m.size());
    e.nodes.push_back(at);
    e.supports.push_back(m);
  }
  set_rule(e);
  set_lump(e);
  return e;
}

void set_faces(Element& e, ElementKind kind, const Lists& corner_lists) {
  const Element& face = element_of(kind);
  for (const auto& corners : corner_lists) {
    Element::Face f{&face, {}};
    for (const auto& support : face.supports) {
      std::vector<uint32_t> wanted;
      for (const uint32_t c : support) wanted.push_back(corners[c]);
      std::sort(wanted.begin(), wanted.end());
      for (uint32_t a = 0; a < e.size(); ++a) {
        std::vector<uint32_t> has = e.supports[a];
        std::sort(has.begin(), has.end());
        if (has == wanted) f.nodes.push_back(a);
      }
    }
    e.faces.push_back(std::move(f));
  }
}

const std::vector<Vec3> kLine{{-1, 0, 0}, {1, 0, 0}}, kTriangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
    kQuad{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
    kTetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    kHexahedron{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
const Lists kTriangleEdges{{0, 1}, {1, 2}, {2, 0}}, kQuadEdges{{0, 1}, {1, 2}, {2, 3}, {3, 0}},
    kQuadMiddles{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 1, 2, 3}},
    kTetrahedronEdges{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
    kTetrahedronFaces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
    kHexahedronFaces{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
    kHexahedronMiddles{{0, 1},
                       {1, 2},
                       {2, 3},
                       {3, 0},
                       {4, 5},
                       {5, 6},
                       {6, 7},
                       {7, 4},
                       {0, 4},
                       {1, 5},
                       {2, 6},
                       {3, 7},
                       {0, 3, 2, 1},
                       {4, 5, 6, 7},
                       {0, 1, 5, 4},
                       {1, 2, 6, 5},
                       {2, 3, 7, 6},
                       {3, 0, 4, 7},
                       {0, 1, 2, 3, 4, 5, 6, 7}};

Element build(ElementKind kind) {
  using enum ElementKind;
  Element e;
  switch (kind) {
    case line2:
      return make("line2", 1, false, kLine, {});
    case line3:
      return make("line3", 1, false, kLine, {{0, 1}});
    case tri3:
      e = make("tri3", 2, true, kTriangle, {});
      set_faces(e, line2, kTriangleEdges);
      e.triangles = {{0, 1, 2}};
      return e;
    case tri6:
      e = make("tri6", 2, true, kTriangle, kTriangleEdges);
      set_faces(e, line3, kTriangleEdges);
      e.triangles = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
      return e;
    case quad4:
      e = make("quad4", 2, false, kQuad, {});
      set_faces(e, line2, kQuadEdges);
      e.triangles = {{0, 1, 2}, {0, 2, 3}};
      return e;
    case quad9:
      e = make("quad9", 2, false, kQuad, kQuadMiddles);
      set_faces(e, line3, kQuadEdges);
      e.triangles = {{0, 4, 8}, {4, 1, 8}, {1, 5, 8}, {5, 2, 8}, {2, 6, 8}, {6, 3, 8}, {3, 7, 8}, {7, 0, 8}};
      return e;
    case tet4:
      e = make("tet4", 3, true, kTetrahedron, {});
      set_faces(e, tri3, kTetrahedronFaces);
      return e;
    case tet10:
      e = make("tet10", 3, true, kTetrahedron, kTetrahedronEdges);
      set_faces(e, tri6, kTetrahedronFaces);
      return e;
    case hex8:
      e = make("hex8", 3, false, kHexahedron, {});
      set_faces(e, quad4, kHexahedronFaces);
      return e;
    case hex27:
      e = make("hex27", 3, false, kHexahedron, kHexahedronMiddles);
      set_faces(e, quad9, kHexahedronFaces);
      return e;
  }
  return e;
}

}  // namespace

void shape_at(const Element& e, const Vec3& xi, std::vector<double>& n, std::vector<Vec3>& g) {
  n.resize(e.size()), g.resize(e.size());
  e.simplex ? simplex_shape(e, xi, n, g) : product_shape(e, xi, n, g);
}

const Element& element_of(ElementKind kind) {
  using enum ElementKind;
  // Faces first: the others refer to them.
  switch (kind) {
    case line2: {
      static const Element kElement = build(line2);
      return kElement;
    }
    case line3: {
      static const Element kElement = build(line3);
      return kElement;
    }
    default:
      break;
  }
  static const std::array<Element, 4> kPlane = {build(tri3), build(tri6), build(quad4), build(quad9)};
  const auto k = static_cast<size_t>(kind);
  if (k < 4) return kPlane[k];
  static const std::array<Element, 4> kSolid = {build(tet4), build(tet10), build(hex8), build(hex27)};
  return kSolid[k - 4];
}

}  // namespace truestep::fem
