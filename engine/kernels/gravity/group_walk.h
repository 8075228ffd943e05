// How a group of bodies finds its sources in a tree (tree_walk.h), for the two methods that end there: a walk
// from the root for every group, and one that shares distant sources with neighbouring groups
// (fast_multipole.h). Private to them.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "engine/kernels/gravity/far_sums.h"
#include "engine/kernels/gravity/local_field.h"
#include "engine/kernels/gravity/tree_walk.h"

namespace truestep::gravity::walk {

using Lanes = Wide<float>;
using Eight = Lanes::Mask;
inline constexpr size_t kPending = 512;  // sources gathered before they are summed
inline constexpr float kTiny = 1e-24f;   // scaled; kTiny^(3/2) times a mass is still a normal float
inline constexpr double kTiny64 = 1e-180;

inline unsigned bits(Eight mask) {
#if defined(__AVX2__)
  return static_cast<unsigned>(_mm256_movemask_ps((__m256)mask));
#else
  unsigned r = 0;
  for (int k = 0; k < 8; ++k) r |= (mask[k] ? 1u : 0u) << k;
  return r;
#endif
}

inline Lanes load(const std::vector<float>& column, size_t at) {
  Lanes r;
  std::memcpy(&r, column.data() + at, sizeof r);
  return r;
}

/// What a walk through the tree needs to know of the force laws, in the tree's lengths.
struct Laws {
  const LawLoops& bodies;
  const LawLoops& nodes;
  double eps;    ///< of both; 0 for the nodes if the bodies' law ends before them
  double clear;  ///< distance within which no node may be used
  Sums sums;
};

/// The extent of a group and its error tolerance.
struct Box {
  Lanes x, y, z, half_x, half_y, half_z, radius, bearable;
  float clear;  // no node may be nearer
};

inline Laws laws_of(const BodyTree& tree, const TreeSettings& settings, const TreeSums& out) {
  const PairLoops& all = pair_loops();
  const bool ends = settings.softening.kind == SofteningKind::spline && settings.softening.length > 0;
  const double eps = settings.softening.length * tree.length_scale();
  return {settings.softening.loops(all), ends ? all.newton : settings.softening.loops(all), eps,
          ends ? kSplineSupport * eps : 0,
          out.p.empty() ? Sums::accelerations : Sums::accelerations_and_potentials};
}

/// Hardly softened bodies pull so hard that only doubles can resolve them; others are as accurate in floats
/// as the nodes.
inline bool in_doubles(const BodyTree& tree, const TreeSettings& settings) {
  constexpr double kSoft = 1e-5;
  return settings.softening.length * tree.length_scale() < kSoft;
}

/// A node that is opened, and a bit mask of its children still to be tested.
struct Opened {
  uint32_t node;
  unsigned left;
};

/// A node relative to a centre, in the tree's lengths.
inline NodeSource source_of(const BodyTree& tree, size_t node, const std::array<double, 3>& center) {
  const auto& c = tree.center(node);
  NodeSource s{static_cast<float>(c.x - center[0]),
               static_cast<float>(c.y - center[1]),
               static_cast<float>(c.z - center[2]),
               static_cast<float>(c.m),
               {}};
  std::memcpy(s.s, tree.moments(node).s.data(), sizeof s.s);
  return s;
}

/// The box around a group's bodies.
struct Place {
  std::array<double, 3> center{};
  std::array<float, 3> half{};
  float radius = 0;  // distance of the farthest body from the centre

  Place() = default;
  Place(const BodyTree& tree, const BodyTree::Group& group) {
    std::array<double, 3> low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (size_t i = group.begin; i < group.end; ++i) {
      const BodyTree::Point& p = tree.point(i);
      const std::array<double, 3> x{p.x, p.y, p.z};
      for (size_t c = 0; c < 3; ++c) low[c] = std::min(low[c], x[c]), high[c] = std::max(high[c], x[c]);
    }
    for (size_t c = 0; c < 3; ++c) {
      center[c] = 0.5 * (low[c] + high[c]);
      half[c] = static_cast<float>(0.5 * (high[c] - low[c]) * (1 + 1e-6));
    }
    double far2 = 0;
    for (size_t i = group.begin; i < group.end; ++i) {
      const BodyTree::Point& p = tree.point(i);
      const double x = p.x - center[0], y = p.y - center[1], z = p.z - center[2];
      far2 = std::max(far2, x * x + y * y + z * z);
    }
    radius = static_cast<float>(std::sqrt(far2) * (1 + 1e-6));
  }

  Box box(double bearable, const Laws& laws) const {
    return {Lanes(center[0]), Lanes(center[1]), Lanes(center[2]),
            Lanes(half[0]),   Lanes(half[1]),   Lanes(half[2]),
            Lanes(radius),    Lanes(bearable),  static_cast<float>(laws.clear)};
  }
};

/// Nodes waiting to be opened: at most seven per depth behind the open one.
class OpenNodes {
 public:
  bool empty() const { return count_ == 0; }
  void push(size_t node) { nodes_[count_++] = static_cast<uint32_t>(node); }
  uint32_t pop() { return nodes_[--count_]; }

 private:
  std::array<uint32_t, (BodyTree::kDepths + 1) * BodyTree::kMostChildren> nodes_;
  size_t count_ = 0;
};

/// For eight nodes, a bit each: whether they may stand for their bodies for every body of the group, or even
/// for the group as a whole.
struct Standing {
  unsigned near, far;
};

inline Standing standing(const BodyTree::Columns& c, size_t first, const Box& box) {
  constexpr float kApart = 1.6f, kFar = 4;
  const Lanes x = load(c.x, first) - box.x, y = load(c.y, first) - box.y, z = load(c.z, first) - box.z;
  const Lanes r = load(c.radius, first), both = r + box.radius, least(box.clear);
  const auto fifth = [](Lanes square) { return square * square * sqrt(square); };
  const Lanes s2 = madd(x, x, madd(y, y, z * z)), wide = both * Lanes(kApart) + least;
  const Lanes s = sqrt(s2), gap = s - both;
  const auto far = (s > wide) & (Lanes(kFar) * load(c.mass, first) * both * both * both <
                                 box.bearable * s2 * s * gap * gap);
  const auto beyond = [](Lanes a, Lanes half) { return max(max(a, -a) - half, Lanes::zero()); };
  const Lanes dx = beyond(x, box.half_x), dy = beyond(y, box.half_y), dz = beyond(z, box.half_z);
  const Lanes d2 = madd(dx, dx, madd(dy, dy, dz * dz)), enough = max(r, least);
  const auto near = (d2 > enough * enough) & (load(c.strength, first) < box.bearable * fifth(d2));
  return {bits(near), bits(far)};
}

/// Magnitude of the acceleration at the centre of a group by a coarse walk of monopoles; at least a fraction
/// of the sum of the magnitudes of its parts, which cancel when the group is in the middle of everything.
inline float coarse_acceleration(const BodyTree& tree, const Place& place, const Laws& laws) {
  const auto eps2 = static_cast<float>(laws.eps * laws.eps);
  constexpr float kShare = 0.1f;
  const auto& c = tree.columns();
  Lanes ax = Lanes::zero(), ay = ax, az = ax, all = ax;
  OpenNodes open;
  open.push(0);
  while (!open.empty()) {
    const BodyTree::Node& n = tree.nodes()[open.pop()];
    const size_t first = n.first_child;
    const Lanes x = load(c.x, first) - Lanes(place.center[0]), y = load(c.y, first) - Lanes(place.center[1]),
                z = load(c.z, first) - Lanes(place.center[2]);
    const Lanes r = load(c.radius, first), d2 = madd(x, x, madd(y, y, z * z));
    unsigned near = ~bits(d2 > r * r * Lanes(2.25f)) & ((1u << n.children) - 1);
    Lanes m = Lanes::zero();
    for (unsigned k = 0; k < n.children; ++k) {
      const BodyTree::Node& child = tree.nodes()[first + k];
      const bool is_far =
          !(near >> k & 1) || child.children == 0 || child.end - child.begin <= BodyTree::kMostInGroup;
      if (is_far) m.set(static_cast<int>(k), static_cast<float>(tree.center(first + k).m));
      if (!is_far) open.push(first + k);
    }
    const Lanes inverse = Lanes(1) / sqrt(d2 + r * r * Lanes(0.5f) + Lanes(eps2 + kTiny));
    const Lanes w = inverse * inverse * inverse * m;
    ax = madd(w, x, ax), ay = madd(w, y, ay), az = madd(w, z, az), all = madd(w, sqrt(d2), all);
  }
  const auto sum = [](Lanes a) { return ((a[0] + a[4]) + (a[1] + a[5])) + ((a[2] + a[6]) + (a[3] + a[7])); };
  const float x = sum(ax), y = sum(ay), z = sum(az);
  return std::max(std::sqrt(x * x + y * y + z * z), kShare * sum(all));
}

/// One group's walk through the tree. T: scalar of the sums over bodies; nodes are summed in floats.
template <class T>
class Walk {
 public:
  Walk(const BodyTree& tree, const TreeSettings& settings, const Laws& laws)
      : tree_(tree),
        settings_(settings),
        laws_(laws),
        node_eps2_(static_cast<float>(laws.clear > 0 ? 0 : laws.eps * laws.eps)) {}

  /// The group's sums from `start` on (nodes of which only the children in the mask remain) and from the
  /// field of all others.
  TreeWork run(const BodyTree::Group& group, const Place& at, float acceleration,
               std::span<const Opened> start, const FieldSeries* field, const TreeSums& out) {
    center_ = at.center;
    place(near_, group), place(far_, group), local_.clear();
    if (field) field->add_to(far_);
    const double bearable = settings_.opening * static_cast<double>(acceleration);
    const Box box = at.box(bearable, laws_);
    OpenNodes open;
    for (const Opened& o : start) {
      judge(tree_.nodes()[o.node], o.left, box, open);
      while (!open.empty()) judge(tree_.nodes()[open.pop()], 0xff, box, open);
    }
    if (tree_.nodes()[0].children == 0) take_bodies(0, tree_.nodes()[0].end);
    sum_bodies(), sum_nodes();
    if (met_far_ > 0) local_.series(node_eps2_ + kTiny).add_to(far_);
    finish(group, out);
    const TreeWork work{static_cast<double>(met_bodies_), static_cast<double>(met_nodes_),
                        static_cast<double>(met_far_)};
    met_bodies_ = met_nodes_ = met_far_ = 0;
    return work;
  }

 private:
  template <class U>
  void place(GroupSums<U, BodyTree::kMostInGroup>& g, const BodyTree::Group& group) {
    g.clear(group.end - group.begin);
    for (size_t i = 0; i < g.rows; ++i) {
      const auto& p = tree_.point(std::min<size_t>(group.begin + i, group.end - 1));
      g.x[i] = static_cast<U>(p.x - center_[0]), g.y[i] = static_cast<U>(p.y - center_[1]);
      g.z[i] = static_cast<U>(p.z - center_[2]);
    }
  }

  void judge(const BodyTree::Node& parent, unsigned left, const Box& box, OpenNodes& open) {
    const size_t first = parent.first_child;
    const unsigned there = ((1u << parent.children) - 1) & left;
    const Standing seen = standing(tree_.columns(), first, box);
    const unsigned far = seen.far & there, near = seen.near & there & ~far;
    for (unsigned b = far; b != 0; b &= b - 1)
      take_far_node(first + static_cast<size_t>(std::countr_zero(b)));
    for (unsigned b = near; b != 0; b &= b - 1) take_node(first + static_cast<size_t>(std::countr_zero(b)));
    for (unsigned b = there & ~far & ~near; b != 0; b &= b - 1) {
      const size_t child = first + static_cast<size_t>(std::countr_zero(b));
      const BodyTree::Node& n = tree_.nodes()[child];
      if (n.children == 0) {
        take_bodies(n.begin, n.end);
      } else {
        open.push(child);
      }
    }
  }

  void take_node(size_t node) {
    if (nodes_ == kPending) sum_nodes();
    node_sources_[nodes_++] = source_of(tree_, node, center_);
  }

  void take_far_node(size_t node) {
    local_.add(source_of(tree_, node, center_), node_eps2_ + kTiny);
    ++met_far_;
  }

  void take_bodies(size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (bodies_ == kPending) sum_bodies();
      const auto& p = tree_.point(i);
      body_sources_[bodies_++] = {static_cast<T>(p.x - center_[0]), static_cast<T>(p.y - center_[1]),
                                  static_cast<T>(p.z - center_[2]), static_cast<T>(p.m)};
    }
  }

  void sum_bodies() {
    const LawNumbers law{laws_.eps, sizeof(T) == 4 ? static_cast<double>(kTiny) : kTiny64};
    if constexpr (sizeof(T) == 4) {
      laws_.bodies.bodies.of(laws_.sums)(near_.columns(), body_sources_.data(), bodies_, law);
    } else {
      laws_.bodies.near_bodies.of(laws_.sums)(near_.columns(), body_sources_.data(), bodies_, law);
    }
    met_bodies_ += bodies_, bodies_ = 0;
  }
  void sum_nodes() {
    laws_.nodes.nodes.of(laws_.sums)(far_.columns(), node_sources_.data(), nodes_,
                                     {laws_.eps, static_cast<double>(kTiny)});
    met_nodes_ += nodes_, nodes_ = 0;
  }

  void finish(const BodyTree::Group& group, const TreeSums& out) {
    const double length = tree_.length_scale(), mass = tree_.mass_scale();
    const double force = length * length / mass, potential = length / mass;
    for (size_t i = 0; i < group.end - group.begin; ++i) {
      const size_t row = tree_.row(group.begin + i);
      const auto sum = [i](const auto& a, const auto& b) {
        return static_cast<double>(a[i]) + static_cast<double>(b[i]);
      };
      out.a[3 * row] = force * sum(near_.ax, far_.ax);
      out.a[3 * row + 1] = force * sum(near_.ay, far_.ay);
      out.a[3 * row + 2] = force * sum(near_.az, far_.az);
      if (laws_.sums == Sums::accelerations) continue;
      out.p[row] = potential * sum(near_.p, far_.p);
    }
  }

  const BodyTree& tree_;
  const TreeSettings& settings_;
  const Laws& laws_;
  float node_eps2_;
  std::array<double, 3> center_{};
  GroupSums<T, BodyTree::kMostInGroup> near_;
  GroupSums<float, BodyTree::kMostInGroup> far_;
  alignas(64) std::array<BodySource<T>, kPending> body_sources_;
  alignas(64) std::array<NodeSource, kPending> node_sources_;
  size_t bodies_ = 0, nodes_ = 0, met_bodies_ = 0, met_nodes_ = 0, met_far_ = 0;
  LocalField local_;
};

}  // namespace truestep::gravity::walk
