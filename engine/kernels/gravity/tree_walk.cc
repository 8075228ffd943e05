#include "engine/kernels/gravity/tree_walk.h"

#include "engine/kernels/gravity/group_walk.h"

namespace truestep::gravity {

namespace {

template <class T>
void walk_every_group(const BodyTree& tree, const TreeSettings& settings, const TreeSums& out,
                      const ThreadArena& arena) {
  constexpr size_t kShare = 16;  // groups
  constexpr walk::Opened kRoot{0, 0xff};
  const walk::Laws laws = walk::laws_of(tree, settings, out);
  arena.for_blocks(tree.groups().size(), kShare, [&](size_t begin, size_t end) {
    walk::Walk<T> way(tree, settings, laws);
    for (size_t k = begin; k < end; ++k) {
      const BodyTree::Group& group = tree.groups()[k];
      const walk::Place at(tree, group);
      const TreeWork work =
          way.run(group, at, walk::coarse_acceleration(tree, at, laws), {&kRoot, 1}, nullptr, out);
      if (!out.work.empty()) out.work[k] = work;
    }
  });
}

}  // namespace

void tree_sums(const BodyTree& tree, const TreeSettings& settings, const TreeSums& out,
               const ThreadArena& arena) {
  if (walk::in_doubles(tree, settings)) {
    walk_every_group<double>(tree, settings, out, arena);
  } else {
    walk_every_group<float>(tree, settings, out, arena);
  }
}

}  // namespace truestep::gravity
