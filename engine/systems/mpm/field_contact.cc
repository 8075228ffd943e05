#include "engine/systems/mpm/field_contact.h"

namespace truestep::mpm {

template <int D, int Nodes, class T>
void FieldContact<D, Nodes, T>::reserve(size_t slots) {
  near_.reserve(slots);
  for (Aligned<float>* c : {&x_, &y_, &z_, &side_}) c->reserve(slots + 8);
  cloud_.reserve(slots), places_.reserve(slots / 64 + 64);
}

template <int D, int Nodes, class T>
double FieldContact<D, Nodes, T>::act(G& g, const Setting& set, double t, double h,
                                      const ThreadArena& arena) {
  find_places(g);
  arena.for_blocks(places_.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      Place& p = places_[k];
      p.shared = shared_nodes(g, p);
      p.many = 0;
      if (p.shared != 0) for_near(g, p, [&](const Near&) { ++p.many; });
    }
  });
  size_t total = 0;
  for (Place& p : places_) p.begin = total, total += (p.many + 7) / 8 * 8;
  near_.resize(total), cloud_.resize(total);
  for (Aligned<float>* c : {&x_, &y_, &z_, &side_}) c->resize(total);
  arena.for_blocks(places_.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      Place& p = places_[k];
      if (p.many == 0) continue;
      Near* to = near_.data() + p.begin;
      for_near(g, p, [&](const Near& n) { *to++ = n; });
      p.fastest = meet_at(g, set, p, t, h);
    }
  });
  double most = 0;
  for (const Place& p : places_) most = std::max(most, p.fastest);
  return std::sqrt(most);
}

template <int D, int Nodes, class T>
void FieldContact<D, Nodes, T>::find_places(const G& g) {
  places_.clear();
  const auto& all = g.blocks.blocks;
  for (size_t k = 0, end; k < all.size(); k = end) {
    for (end = k + 1; end < all.size() && all[end].id / g.blocks.fields == all[k].id / g.blocks.fields;)
      ++end;
    if (end > k + 1) places_.push_back({.first = k, .last = end});
  }
}

template <int D, int Nodes, class T>
auto FieldContact<D, Nodes, T>::shared_nodes(G& g, const Place& p) -> uint64_t {
  uint64_t once = 0, twice = 0;
  for (size_t k = p.first; k < p.last; ++k) {
    uint64_t here = 0;
    for (size_t n = 0; n < Size::kBlockNodes; ++n) here |= uint64_t{node_of(g, k, n)[0] > 0} << n;
    twice |= once & here, once |= here;
  }
  return twice;
}

template <int D, int Nodes, class T>
double FieldContact<D, Nodes, T>::half_width(const G& g, const Piece& piece, size_t slot, const Vec3& n) {
  const Law law = piece.material.law;
  const double d[3] = {piece.spacing.x, piece.spacing.y, piece.spacing.z}, to[3] = {n.x, n.y, n.z};
  const bool solid = law == Law::corotated || law == Law::neo_hookean || law == Law::elastic;
  const double swell = std::clamp(1 + (double{g.now.at(slot, L::jacobian)} - 1) / D, 0.5, 2.0);
  double sum = 0;
  for (int a = 0; a < D; ++a) {
    double along = solid ? 0 : swell * to[a];
    for (int i = 0; solid && i < D; ++i) along += to[i] * double{g.now.at(slot, L::f + D * i + a)};
    sum += along * along * d[a] * d[a];
  }
  return 0.5 * std::sqrt(sum);
}

template <int D, int Nodes, class T>
double FieldContact<D, Nodes, T>::meet_at(G& g, const Setting& set, const Place& p, double t, double h) {
  double most = 0;
  for (size_t n = 0; n < Size::kBlockNodes; ++n) {
    if (!(p.shared >> n & 1)) continue;
    for (size_t a = p.first; a < p.last; ++a) {
      for (size_t b = a + 1; b < p.last; ++b) {
        if (node_of(g, a, n)[0] > 0 && node_of(g, b, n)[0] > 0)
          most = std::max(most, meet_pair(g, set, p, n, a, b, t, h));
      }
    }
  }
  return most;
}

template <int D, int Nodes, class T>
size_t FieldContact<D, Nodes, T>::gather_cloud(const Place& p, size_t n, size_t a, size_t b) {
  int at[3] = {};
  index_of(n, at);
  size_t many = 0;
  for (size_t i = p.begin; i < p.begin + p.many; ++i) {
    const Near& q = near_[i];
    if (q.block != a && q.block != b) continue;
    float x[3] = {};
    bool inside = true;
    for (int c = 0; c < D; ++c) {
      x[c] = q.x[c] - static_cast<float>(at[c]);
      inside = inside && std::abs(x[c]) < kReach;
    }
    if (!inside) continue;
    const size_t to = p.begin + many++;
    x_[to] = x[0], y_[to] = x[1], z_[to] = x[2], side_[to] = q.block == a ? -1.0F : 1.0F;
    cloud_[to] = static_cast<uint32_t>(i);
  }
  for (size_t i = p.begin + many; i % 8 != 0; ++i) x_[i] = y_[i] = z_[i] = side_[i] = 0;
  return many;
}

template <int D, int Nodes, class T>
bool FieldContact<D, Nodes, T>::parts(const Place& p, size_t many, const Vec3& w) const {
  Vec3 sum[2];
  double count[2] = {};
  for (size_t i = p.begin; i < p.begin + many; ++i) {
    const size_t k = side_[i] > 0;
    sum[k] += Vec3{double{x_[i]}, double{y_[i]}, double{z_[i]}}, ++count[k];
  }
  if (count[0] == 0 || count[1] == 0) return true;
  const Vec3 line = sum[1] / count[1] - sum[0] / count[0];
  const double away = dot(w, line);
  return away > 0 && 4 * away * away > 3 * norm2(w) * norm2(line);
}

template <int D, int Nodes, class T>
double FieldContact<D, Nodes, T>::meet_pair(G& g, const Setting& set, const Place& p, size_t n, size_t a,
                                            size_t b, double t, double h) {
  T *one = node_of(g, a, n), *other = node_of(g, b, n);
  FieldNode of_a{double{one[0]}, {double{one[1]}, double{one[2]}, double{one[3]}}},
      of_b{double{other[0]}, {double{other[1]}, double{other[2]}, double{other[3]}}};
  if (norm2(of_a.velocity - of_b.velocity) == 0) return 0;
  const size_t many = gather_cloud(p, n, a, b), padded = (many + 7) / 8 * 8;
  if (parts(p, many, of_b.velocity - of_a.velocity)) return 0;
  const auto part = [&](const Aligned<float>& c) {
    return std::span<const float>(c.data() + p.begin, padded);
  };
  const Vec3 normal = normal_between({part(x_), part(y_), part(z_), part(side_)});
  // One body alone, or no separating direction.
  if (norm2(normal) == 0) return 0;
  double end = -HUGE_VAL, begin = HUGE_VAL;
  for (size_t i = p.begin; i < p.begin + many; ++i) {
    const Near& q = near_[cloud_[i]];
    const double along = set.def.cell * dot(normal, {double{x_[i]}, double{y_[i]}, double{z_[i]}});
    const double half = half_width(g, set.pieces[q.piece], q.slot, normal);
    if (side_[i] < 0) {
      end = std::max(end, along + half);
    } else {
      begin = std::min(begin, along - half);
    }
  }
  if (!meet(of_a, of_b, normal, std::max(0.0, begin - end) / h, set.def.field_friction)) return 0;
  return std::max(settle(g, set, a, n, of_a.velocity, t), settle(g, set, b, n, of_b.velocity, t));
}

template <int D, int Nodes, class T>
double FieldContact<D, Nodes, T>::settle(G& g, const Setting& set, size_t block, size_t n, const Vec3& to,
                                         double t) {
  T* node = node_of(g, block, n);
  const Vec3T<T> wish{static_cast<T>(to.x), static_cast<T>(to.y), static_cast<T>(to.z)};
  const Vec3T<T> v = g.held(set, g.place_of(set.def, g.blocks.blocks[block], n), t, wish);
  if (!g.changes.empty()) {
    T* c = g.changes.data() + (node - g.nodes.data());
    c[1] += v.x - node[1], c[2] += v.y - node[2], c[3] += v.z - node[3];
  }
  node[1] = v.x, node[2] = v.y, node[3] = v.z;
  return double{norm2(v)};
}

template class FieldContact<2, 3, float>;
template class FieldContact<2, 4, float>;
template class FieldContact<3, 3, float>;
template class FieldContact<3, 4, float>;
template class FieldContact<2, 3, double>;
template class FieldContact<2, 4, double>;
template class FieldContact<3, 3, double>;
template class FieldContact<3, 4, double>;

}  // namespace truestep::mpm
