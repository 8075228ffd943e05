#include "engine/kernels/gravity/mixed_sums.h"

#include "engine/kernels/gravity/group_walk.h"
#include "engine/math/vec3.h"

namespace truestep::gravity {

namespace {

constexpr size_t kMost = BodyTree::kMostInGroup;
constexpr double kNear = 1.5;  // radii of a group within which interactions use doubles

class MixedGroup {
 public:
  MixedGroup(const BodyTree& tree, const MixedScratch& scratch, const LawLoops& loops, double eps)
      : tree_(tree), places_(scratch.places), loops_(loops), eps_(eps) {}

  void run(size_t own, std::span<double> a) {
    const BodyTree::Group& group = tree_.groups()[own];
    at_ = places_[own];
    place(near_, group), place(far_, group);
    sum_.fill({});
    for (size_t k = 0; k < places_.size(); ++k) {
      const BodyTree::Group& other = tree_.groups()[k];
      is_near(places_[k]) ? take(other, nears_, near_sources_, [&] { sum_near(); })
                          : take(other, fars_, far_sources_, [&] { sum_far(group); });
    }
    sum_near(), sum_far(group);
    const double length = tree_.length_scale(), force = length * length / tree_.mass_scale();
    for (size_t i = 0; i < group.end - group.begin; ++i) {
      const Vec3 all = sum_[i] + Vec3{near_.ax[i], near_.ay[i], near_.az[i]};
      store3(a.data(), tree_.row(group.begin + i), all * force);
    }
  }

 private:
  bool is_near(const std::array<double, 4>& other) const {
    const double x = other[0] - at_[0], y = other[1] - at_[1], z = other[2] - at_[2];
    const double reach = kNear * at_[3] + other[3];
    return x * x + y * y + z * z <= reach * reach;
  }
  template <class Source, class Full>
  void take(const BodyTree::Group& group, size_t& count, std::array<Source, walk::kPending>& sources,
            const Full& full) {
    using T = decltype(Source::x);
    if (count + kMost > walk::kPending) full();
    for (size_t i = group.begin; i < group.end; ++i) {
      const BodyTree::Point& p = tree_.point(i);
      sources[count++] = {static_cast<T>(p.x - at_[0]), static_cast<T>(p.y - at_[1]),
                          static_cast<T>(p.z - at_[2]), static_cast<T>(p.m)};
    }
  }
  template <class T>
  void place(GroupSums<T, kMost>& g, const BodyTree::Group& group) {
    g.clear(group.end - group.begin);
    for (size_t i = 0; i < g.rows; ++i) {
      const BodyTree::Point& p = tree_.point(std::min<size_t>(group.begin + i, group.end - 1));
      g.x[i] = static_cast<T>(p.x - at_[0]), g.y[i] = static_cast<T>(p.y - at_[1]);
      g.z[i] = static_cast<T>(p.z - at_[2]);
    }
  }
  void sum_near() {
    loops_.near_bodies.accelerations(near_.columns(), near_sources_.data(), nears_, {eps_, walk::kTiny64});
    nears_ = 0;
  }
  void sum_far(const BodyTree::Group& group) {
    loops_.bodies.accelerations(far_.columns(), far_sources_.data(), fars_,
                                {eps_, static_cast<double>(walk::kTiny)});
    fars_ = 0;
    const size_t bodies = group.end - group.begin;
    for (size_t i = 0; i < bodies; ++i) sum_[i] += Vec3{far_.ax[i], far_.ay[i], far_.az[i]};
    far_.clear(bodies);
  }

  const BodyTree& tree_;
  const std::vector<std::array<double, 4>>& places_;
  const LawLoops& loops_;
  double eps_;
  std::array<double, 4> at_{};
  GroupSums<double, kMost> near_;
  GroupSums<float, kMost> far_;
  std::array<Vec3, kMost> sum_;
  alignas(64) std::array<BodySource<double>, walk::kPending> near_sources_;
  alignas(64) std::array<BodySource<float>, walk::kPending> far_sources_;
  size_t nears_ = 0, fars_ = 0;
};

}  // namespace

void mixed_accelerations(const BodyTree& tree, const Softening& softening, std::span<double> a,
                         MixedScratch& scratch, const ThreadArena& arena) {
  constexpr size_t kShare = 16;  // groups
  const size_t groups = tree.groups().size();
  scratch.places.resize(groups);
  for (size_t k = 0; k < groups; ++k) {
    const walk::Place at(tree, tree.groups()[k]);
    scratch.places[k] = {at.center[0], at.center[1], at.center[2], static_cast<double>(at.radius)};
  }
  const LawLoops& loops = softening.loops(pair_loops());
  arena.for_blocks(groups, kShare, [&](size_t begin, size_t end) {
    MixedGroup group(tree, scratch, loops, softening.length * tree.length_scale());
    for (size_t k = begin; k < end; ++k) group.run(k, a);
  });
}

}  // namespace truestep::gravity
