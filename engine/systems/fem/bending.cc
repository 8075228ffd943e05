#include "engine/systems/fem/bending.h"

#include <algorithm>
#include <cmath>

namespace truestep::fem {

namespace {

constexpr size_t kBlockRows = 256;
constexpr double kStraight = 1e-9;  // |J| at rest below which it is rounding

std::array<Vec3, 3> corners_of(const Mesh& mesh, size_t cell) {
  const auto nodes = mesh.cell(cell);
  return {mesh.x[nodes[0]], mesh.x[nodes[1]], mesh.x[nodes[2]]};
}

// The sides of every edge: one or two facets of elements, ordered by the first.
struct Edge {
  std::array<uint32_t, 2> ends;
  Facet one, two;
  bool rim;
};
std::vector<Edge> edges_of(const Mesh& mesh) {
  std::vector<std::pair<std::array<uint32_t, 2>, Facet>> sides;
  for (uint32_t k = 0; k < mesh.cells(); ++k) {
    for (uint32_t f = 0; f < 3; ++f) {
      const uint32_t a = mesh.facet_node({k, f}, 0), b = mesh.facet_node({k, f}, 1);
      sides.push_back({{std::min(a, b), std::max(a, b)}, {k, f}});
    }
  }
  std::stable_sort(sides.begin(), sides.end(), [](auto& a, auto& b) { return a.first < b.first; });
  std::vector<Edge> out;
  for (size_t i = 0; i < sides.size();) {
    const bool twin = i + 1 < sides.size() && sides[i + 1].first == sides[i].first;
    out.push_back({sides[i].first, sides[i].second, sides[twin ? i + 1 : i].second, !twin});
    i += twin ? 2 : 1;
  }
  return out;
}

}  // namespace

std::optional<std::array<size_t, 2>> first_fold(const Mesh& mesh) {
  constexpr double kSame = 1 - 1e-9;  // cosine between the two sides
  for (const Edge& e : edges_of(mesh)) {
    if (e.rim) continue;
    const Vec3 from = mesh.x[e.ends[0]], along = normalized(mesh.x[e.ends[1]] - from);
    Vec3 in[2];
    for (size_t side = 0; side < 2; ++side) {
      const Facet& f = side == 0 ? e.one : e.two;
      const Vec3 third = mesh.x[mesh.cell(f.cell)[(f.face + 2) % 3]] - from;
      in[side] = normalized(third - dot(third, along) * along);
    }
    if (dot(in[0], in[1]) > kSame) return std::array<size_t, 2>{e.one.cell, e.two.cell};
  }
  return std::nullopt;
}

Bending::Bending(const Mesh& mesh, const std::vector<uint8_t>& clamped, double poisson)
    : constant_(mesh.x.size()) {
  for (size_t k = 0; k < mesh.cells(); ++k) {
    const auto corners = corners_of(mesh, k);
    const auto block = triangle_bending(triangle_curvature(corners), poisson);
    const auto nodes = mesh.cell(k);
    for (size_t a = 0; a < 6; ++a) {
      for (size_t b = 0; b < 6; ++b) entries_.push_back({{nodes[a], nodes[b]}, block[6 * a + b]});
    }
  }
  for (const Edge& e : edges_of(mesh)) {
    if (!e.rim) add_edge(mesh, e.one, &e.two, poisson);
    if (e.rim && clamped[e.ends[0]] && clamped[e.ends[1]]) add_edge(mesh, e.one, nullptr, poisson);
  }
  std::stable_sort(entries_.begin(), entries_.end(), [](auto& a, auto& b) { return a.first < b.first; });
  row_begin_.assign(mesh.x.size() + 1, 0);
  for (size_t i = 0; i < entries_.size();) {
    const BlockSparse::Pair place = entries_[i].first;
    double sum = 0;
    for (; i < entries_.size() && entries_[i].first == place; ++i) sum += entries_[i].second;
    columns_.push_back(place[1]), values_.push_back(sum);
    row_begin_[place[0] + 1] = static_cast<uint32_t>(columns_.size());
  }
  for (size_t i = 1; i < row_begin_.size(); ++i) row_begin_[i] = std::max(row_begin_[i], row_begin_[i - 1]);
  entries_ = {};
  std::vector<double> rest;
  for (const Vec3& p : mesh.x) rest.insert(rest.end(), {p.x, p.y, p.z});
  static const ThreadArena kSerial(1);
  at_rest_ = energy(1, rest, kSerial);
}

void Bending::add_edge(const Mesh& mesh, const Facet& one, const Facet* two, double poisson) {
  const auto first = corners_of(mesh, one.cell);
  const auto second = corners_of(mesh, two ? two->cell : one.cell);
  const auto points =
      edge_points(first, one.face, two ? second.data() : nullptr, two ? two->face : 0, poisson);
  std::vector<uint32_t> nodes(mesh.cell(one.cell).begin(), mesh.cell(one.cell).end());
  if (two) nodes.insert(nodes.end(), mesh.cell(two->cell).begin(), mesh.cell(two->cell).end());
  for (const EdgePoint& p : points) {
    Vec3 jump, along, between;
    for (size_t a = 0; a < nodes.size(); ++a) {
      const Vec3& x = mesh.x[nodes[a]];
      jump += p.jump[a] * x, along += p.along[a] * x, between += p.between[a] * x;
      for (size_t b = 0; b < nodes.size(); ++b) {
        const double value = p.weight * (p.penalty * p.jump[a] * p.jump[b] - p.moment[a] * p.jump[b] -
                                         p.jump[a] * p.moment[b]);
        entries_.push_back({{nodes[a], nodes[b]}, value});
      }
    }
    if (!two) {
      // J is the slope relative to rest.
      for (size_t a = 0; a < nodes.size(); ++a)
        constant_[nodes[a]] += p.weight * (p.penalty * p.jump[a] - p.moment[a]) * jump;
      continue;
    }
    const double bent = dot(jump, normalized(cross(along, between)));
    if (!(std::abs(bent) > kStraight)) continue;
    BentPoint out{{}, {}, p.weight * bent, p.penalty * bent, {}};
    for (size_t a = 0; a < nodes.size(); ++a) {
      const auto known = std::find(out.nodes.begin(), out.nodes.end(), nodes[a]);
      const auto place = static_cast<size_t>(known - out.nodes.begin());
      if (known == out.nodes.end()) out.nodes.push_back(nodes[a]), out.sums.push_back({});
      out.sums[place][0] += p.moment[a] - p.penalty * p.jump[a];
      out.sums[place][1] += p.along[a];
      out.sums[place][2] += p.between[a];
    }
    bent_.push_back(std::move(out));
  }
}

void Bending::add_pairs(std::vector<BlockSparse::Pair>& pairs) const {
  for (uint32_t i = 0; i + 1 < row_begin_.size(); ++i) {
    for (uint32_t k = row_begin_[i]; k < row_begin_[i + 1]; ++k) {
      if (columns_[k] > i) pairs.push_back({i, columns_[k]});
    }
  }
}

void Bending::find_slots(const BlockSparse& pattern) {
  for (uint32_t i = 0; i + 1 < row_begin_.size(); ++i) {
    for (uint32_t k = row_begin_[i]; k < row_begin_[i + 1]; ++k)
      slots_.push_back(pattern.slot(i, columns_[k]));
  }
  for (BentPoint& p : bent_) {
    for (const uint32_t a : p.nodes) {
      for (const uint32_t b : p.nodes) p.slots.push_back(pattern.slot(a, b));
    }
  }
}

std::array<Vec3, 3> Bending::sums_of(const BentPoint& p, std::span<const double> x) const {
  std::array<Vec3, 3> out;
  for (size_t a = 0; a < p.nodes.size(); ++a) {
    const Vec3 place = load3(x.data(), p.nodes[a]);
    for (size_t c = 0; c < 3; ++c) out[c] += p.sums[a][c] * place;
  }
  return out;
}

// Row i of Q x, computed from differences, as its rows sum to 0: the sheet's position adds no rounding.
Vec3 Bending::row(std::span<const double> x, size_t i) const {
  const Vec3 own = load3(x.data(), i);
  Vec3 out;
  for (uint32_t k = row_begin_[i]; k < row_begin_[i + 1]; ++k)
    out += values_[k] * (load3(x.data(), columns_[k]) - own);
  return out;
}

double Bending::energy(double rigidity, std::span<const double> x, const ThreadArena& arena) const {
  const Vec3 origin = load3(x.data(), 0);
  double sum = arena.sum_blocks(row_begin_.size() - 1, kBlockRows, [&](size_t begin, size_t end) {
    double part = 0;
    for (size_t i = begin; i < end; ++i) {
      part += dot(load3(x.data(), i) - origin, 0.5 * row(x, i) - constant_[i]);
    }
    return part;
  });
  for (const BentPoint& p : bent_) {
    const auto [l, t, c] = sums_of(p, x);
    sum += p.weight * bent(l, t, c).value;
  }
  return rigidity * (sum - at_rest_);
}

void Bending::add_forces(double rigidity, std::span<const double> x, std::span<double> f,
                         const ThreadArena& arena) const {
  arena.for_blocks(row_begin_.size() - 1, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      store3(f.data(), i, load3(f.data(), i) - rigidity * (row(x, i) - constant_[i]));
    }
  });
  // Neighbours share nodes, so one after another.
  for (const BentPoint& p : bent_) {
    const auto [l, t, c] = sums_of(p, x);
    const Bent b = bent(l, t, c);
    for (size_t a = 0; a < p.nodes.size(); ++a) {
      Vec3 slope;
      for (size_t s = 0; s < 3; ++s) slope += p.sums[a][s] * b.slope[s];
      const uint32_t node = p.nodes[a];
      store3(f.data(), node, load3(f.data(), node) - (rigidity * p.weight) * slope);
    }
  }
}

void Bending::add_stiffness(double rigidity, std::span<const double> x, BentSlope kind, BlockSparse& dfdx,
                            const ThreadArena& arena) const {
  arena.for_blocks(row_begin_.size() - 1, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (uint32_t k = row_begin_[i]; k < row_begin_[i + 1]; ++k) {
        const auto block = dfdx.block(slots_[k]);
        for (size_t c = 0; c < 3; ++c) block[4 * c] -= rigidity * values_[k];
      }
    }
  });
  for (const BentPoint& p : bent_) {
    const auto [l, t, c] = sums_of(p, x);
    const auto h = bent_slope(l, t, c, kind, p.penalty);
    const size_t n = p.nodes.size();
    for (size_t a = 0; a < n; ++a) {
      // Sums over this node's coefficients in L, t and c: three rows of nine.
      double rows[3][9] = {};
      for (size_t s = 0; s < 3; ++s) {
        for (size_t r = 0; r < 3; ++r) {
          for (size_t k = 0; k < 9; ++k) rows[r][k] += p.sums[a][s] * h[9 * (3 * s + r) + k];
        }
      }
      for (size_t b = 0; b < n; ++b) {
        double block[9] = {};
        for (size_t s = 0; s < 3; ++s) {
          for (size_t r = 0; r < 3; ++r) {
            for (size_t k = 0; k < 3; ++k) block[3 * k + r] += p.sums[b][s] * rows[r][3 * s + k];
          }
        }
        dfdx.add_block(p.slots[a * n + b], block, -rigidity * p.weight);
      }
    }
  }
}

}  // namespace truestep::fem
