#include "engine/kernels/gravity/mixed_sums.h"

#include "engine/kernels/gravity/group_walk.h"
#include "engine/math/vec3.h"

namespace truestep::gravity {

namespace {

constexpr size_t kMost = BodyTree::kMostInGroup;
constexpr double kNear = 3;  // radii of a group within which bodies meet it in doubles

class MixedGroup {
 public:
  MixedGroup(const BodyTree& tree, const LawLoops& loops, double eps)
      : tree_(tree), loops_(loops), eps_(eps) {}

  void run(const BodyTree::Group& group, std::span<double> a) {
    const walk::Place at(tree_, group);
    place(near_, group, at), place(far_, group, at);
    sum_.fill({});
    const double reach = kNear * static_cast<double>(at.radius), reach2 = reach * reach;
    for (size_t i = 0; i < tree_.size(); ++i) {
      const BodyTree::Point& p = tree_.point(i);
      const double x = p.x - at.center[0], y = p.y - at.center[1], z = p.z - at.center[2];
      if (x * x + y * y + z * z > reach2) {
        if (fars_ == walk::kPending) sum_far(group);
        far_sources_[fars_++] = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z),
                                 static_cast<float>(p.m)};
      } else {
        if (nears_ == walk::kPending) sum_near();
        near_sources_[nears_++] = {x, y, z, p.m};
      }
    }
    sum_near(), sum_far(group);
    const double length = tree_.length_scale(), force = length * length / tree_.mass_scale();
    for (size_t i = 0; i < group.end - group.begin; ++i) {
      const Vec3 all = sum_[i] + Vec3{near_.ax[i], near_.ay[i], near_.az[i]};
      store3(a.data(), tree_.row(group.begin + i), all * force);
    }
  }

 private:
  template <class T>
  void place(GroupSums<T, kMost>& g, const BodyTree::Group& group, const walk::Place& at) {
    g.clear(group.end - group.begin);
    for (size_t i = 0; i < g.rows; ++i) {
      const BodyTree::Point& p = tree_.point(std::min<size_t>(group.begin + i, group.end - 1));
      g.x[i] = static_cast<T>(p.x - at.center[0]), g.y[i] = static_cast<T>(p.y - at.center[1]);
      g.z[i] = static_cast<T>(p.z - at.center[2]);
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
  const LawLoops& loops_;
  double eps_;
  GroupSums<double, kMost> near_;
  GroupSums<float, kMost> far_;
  std::array<Vec3, kMost> sum_;
  alignas(64) std::array<BodySource<double>, walk::kPending> near_sources_;
  alignas(64) std::array<BodySource<float>, walk::kPending> far_sources_;
  size_t nears_ = 0, fars_ = 0;
};

}  // namespace

void mixed_accelerations(const BodyTree& tree, const Softening& softening, std::span<double> a,
                         const ThreadArena& arena) {
  constexpr size_t kShare = 16;  // groups
  const LawLoops& loops = softening.loops(pair_loops());
  arena.for_blocks(tree.groups().size(), kShare, [&](size_t begin, size_t end) {
    MixedGroup group(tree, loops, softening.length * tree.length_scale());
    for (size_t k = begin; k < end; ++k) group.run(tree.groups()[k], a);
  });
}

}  // namespace truestep::gravity
