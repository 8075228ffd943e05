#include "engine/systems/xpbd/tearing/tear_surface.h"

#include <algorithm>
#include <cmath>

namespace truestep::xpbd {

TearSurface::TearSurface(const Body& body) : triangles_(body.triangles), begin_(body.x.size() + 1) {
  for (const auto& t : triangles_) {
    areas_.push_back(0.5 * norm(cross(body.x[t[1]] - body.x[t[0]], body.x[t[2]] - body.x[t[0]])));
    for (const uint32_t p : t) ++begin_[p + 1];
  }
  for (size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  at_.resize(begin_.back());
  auto next = begin_;
  for (uint32_t c = 0; c < 3 * triangles_.size(); ++c) at_[next[triangles_[c / 3][c % 3]]++] = c;
  first_side_.push_back(0);
  for (const Link& l : body.links) {
    find_sides(l);
    first_side_.push_back(sides_.size());
  }
}

void TearSurface::find_sides(const Link& l) {
  const auto others = [&](uint32_t c) {
    const uint32_t t = c - c % 3;
    return std::array<uint32_t, 2>{t + (c + 1) % 3, t + (c + 2) % 3};
  };
  const auto point = [&](uint32_t c) { return triangles_[c / 3][c % 3]; };
  const size_t before = sides_.size();
  for (const uint32_t c : around(l.a)) {
    for (const uint32_t o : others(c)) {
      if (point(o) == l.b) sides_.push_back({c, o, {kNone, kNone, kNone, kNone}});
    }
  }
  if (sides_.size() > before) return;
  for (const uint32_t c : around(l.a)) {
    const auto [p, q] = others(c);
    for (const uint32_t d : around(l.b)) {
      auto [r, s] = others(d);
      if (point(r) != point(p)) std::swap(r, s);
      if (point(r) == point(p) && point(s) == point(q)) return sides_.push_back({c, d, {p, q, r, s}});
    }
  }
}

Strand TearSurface::strand(std::span<const uint32_t> corners, size_t link, size_t side) const {
  const Side* sides = sides_.data() + first_side_[link];
  const size_t count = this->sides(link);
  const Side& mine = sides[side];
  if (mine.across[0] != kNone) {
    const auto& c = mine.across;
    const bool holds = corners[c[0]] == corners[c[2]] && corners[c[1]] == corners[c[3]];
    return {corners[mine.a], corners[mine.b], holds ? 1.0 : 0.0};
  }
  Strand out{corners[mine.a], corners[mine.b], 0};
  size_t same = 0;
  for (size_t k = 0; k < count; ++k) {
    if (corners[sides[k].a] != out.a || corners[sides[k].b] != out.b) continue;
    if (k < side) return out;
    ++same;
  }
  out.share = static_cast<double>(same) / static_cast<double>(count);
  return out;
}

bool TearSurface::whole(std::span<const uint32_t> corners, size_t link) const {
  for (size_t k = first_side_[link]; k < first_side_[link + 1]; ++k) {
    const Side& s = sides_[k];
    if (corners[s.a] != triangles_[s.a / 3][s.a % 3] || corners[s.b] != triangles_[s.b / 3][s.b % 3]) {
      return false;
    }
    const auto& c = s.across;
    if (c[0] != kNone && (corners[c[0]] != corners[c[2]] || corners[c[1]] != corners[c[3]])) return false;
  }
  return true;
}

bool TearSurface::split(std::span<const uint32_t> corners, uint32_t row) const {
  for (const uint32_t c : around(row)) {
    if (corners[c] != row) return true;
  }
  return false;
}

bool TearSurface::cut(State& s, uint32_t row, const Vec3& along, size_t capacity) const {
  using C = XpbdColumns;
  const size_t rows = s.rows(C::position);
  if (rows >= capacity) return false;
  const double* x = s.f64(C::position).data();
  const auto corners = s.span<uint32_t>(columns.corner);
  const uint32_t origin = s.span<uint32_t>(columns.origin)[row];
  const Vec3 here = load3(x, row);
  const auto beyond = [&](uint32_t c) {
    const uint32_t t = c - c % 3;
    const Vec3 p = load3(x, corners[t + (c + 1) % 3]), q = load3(x, corners[t + (c + 2) % 3]);
    return dot(p + q - 2 * here, along) > 0;
  };
  double whole = 0, part = 0;
  for (const uint32_t c : around(origin)) {
    if (corners[c] != row) continue;
    whole += areas_[c / 3];
    if (beyond(c)) part += areas_[c / 3];
  }
  if (!(part > 0) || !(part < whole)) return false;
  const auto added = static_cast<uint32_t>(rows);
  // Decided before any corner changes: `beyond` for one triangle does not depend on the others.
  for (const uint32_t c : around(origin)) {
    if (corners[c] == row && beyond(c)) corners[c] = added;
  }
  for (const State::Column c : {State::Column{C::position}, State::Column{C::velocity},
                                State::Column{C::inverse_mass}, columns.mass, columns.origin}) {
    s.resize(c, rows + 1);
    s.copy_row(c, row, rows);
  }
  const auto mass = s.f64(columns.mass), w = s.f64(C::inverse_mass);
  mass[added] = mass[row] * (part / whole), mass[row] -= mass[added];
  w[row] = 1 / mass[row], w[added] = 1 / mass[added];
  return true;
}

void Tearing::run(const TearSurface& surface, const Body& body, const TearLimits& limits, State& s,
                  std::span<const double> stiffness) {
  using C = XpbdColumns;
  const size_t capacity = body.capacity;
  if (borne_.empty()) {
    overloads_.reserve(surface.first_side(body.links.size()));
    borne_.reserve(capacity), touched_.reserve(capacity);
  }
  overloads_.clear();
  borne_.assign(s.rows(C::position), 0);
  const auto corners = std::as_const(s).span<uint32_t>(surface.columns.corner);
  const auto extension = [&](const Link& l, const Strand& strand) {
    const double* x = std::as_const(s).f64(C::position).data();
    return norm(load3(x, strand.b) - load3(x, strand.a)) - l.rest;
  };
  for (uint32_t k = 0; k < body.links.size(); ++k) {
    const Link& l = body.links[k];
    if (l.family != Family::structural) continue;
    for (uint32_t i = 0; i < surface.sides(k); ++i) {
      const Strand strand = surface.strand(corners, k, i);
      if (!(strand.share > 0)) continue;
      const double e = extension(l, strand), whole = stiffness_of(stiffness, l.family) * l.factor;
      // A strand has its share of the cross-section and bears proportionally less.
      const double ratio = std::max(e / (l.rest * limits.strain), whole * e / limits.force);
      if (!(ratio > 0)) continue;
      borne_[strand.a] += ratio * strand.share, borne_[strand.b] += ratio * strand.share;
      if (ratio > 1) overloads_.push_back({ratio, k, i});
    }
  }
  if (overloads_.empty()) return;
  std::sort(overloads_.begin(), overloads_.end(), [](const Overload& a, const Overload& b) {
    return a.ratio != b.ratio ? a.ratio > b.ratio : a.link != b.link ? a.link < b.link : a.side < b.side;
  });
  touched_.assign(s.rows(C::position), 0);
  for (const Overload& o : overloads_) {
    const Strand strand = surface.strand(s.span<uint32_t>(surface.columns.corner), o.link, o.side);
    if (!(strand.share > 0) || touched_[strand.a] || touched_[strand.b]) continue;
    uint32_t first = strand.a, second = strand.b;
    if (borne_[second] > borne_[first]) std::swap(first, second);
    for (const auto& [at, other] : {std::array{first, second}, std::array{second, first}}) {
      const double* x = std::as_const(s).f64(C::position).data();
      const Vec3 along = load3(x, other) - load3(x, at);
      if (!(s.f64(C::inverse_mass)[at] > 0) || !surface.cut(s, at, along, capacity)) continue;
      touched_[at] = touched_[other] = 1;
      touched_.push_back(1), borne_.push_back(0);
      break;
    }
  }
}

}  // namespace truestep::xpbd
