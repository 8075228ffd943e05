#include "engine/kernels/gravity/fast_multipole.h"

#include "engine/kernels/gravity/group_walk.h"

namespace truestep::gravity {

namespace {

using walk::Opened;

/// Nodes and masks for one depth, and what a node passes on.
struct Level {
  std::vector<Opened> left;
};
using Levels = std::array<Level, BodyTree::kDepths + 2>;

/// A subtree that can be processed independently.
struct Task {
  uint32_t node = 0;
  std::vector<Opened> left;
  FieldSeries series;
};

}  // namespace

struct MultipoleScratch::Parts {
  std::vector<walk::Place> places;  // of groups
  std::vector<float> accelerations;
  std::vector<Task> tasks;
  size_t task_count = 0;
  std::vector<Levels> levels;  // the first for the part above the tasks, then one per task
};

MultipoleScratch::MultipoleScratch() : parts_(std::make_unique<Parts>()) {}
MultipoleScratch::~MultipoleScratch() = default;
// Nothing is worth copying.
MultipoleScratch::MultipoleScratch(const MultipoleScratch&) : MultipoleScratch() {}

namespace {

template <class T>
class Descent {
 public:
  using Parts = MultipoleScratch::Parts;
  Descent(const BodyTree& tree, const TreeSettings& settings, const walk::Laws& laws, const TreeSums& out,
          Parts& parts, Levels& levels)
      : tree_(tree),
        settings_(settings),
        laws_(laws),
        out_(out),
        parts_(parts),
        levels_(levels),
        way_(tree, settings, laws) {}

  /// Processes a node for which its parent left over `left` and included the rest in `series`, about the
  /// node's own centre. `on_child(child, left, series)` is asked for every child of many bodies.
  template <class OnChild>
  void go(uint32_t node, std::span<const Opened> left, FieldSeries series, size_t depth,
          const OnChild& on_child) {
    const BodyTree::Node& n = tree_.nodes()[node];
    const auto& c = tree_.center(node);
    const std::array<double, 3> center{c.x, c.y, c.z};
    std::vector<Opened>& keep = levels_[depth].left;
    keep.clear();
    const size_t first_group = group_from(n.begin), end_group = group_from(n.end);
    meet(node, center, left, least_acceleration(first_group, end_group), keep, series);
    const auto about = [&](const std::array<double, 3>& place) {
      return series.shifted(static_cast<float>(place[0] - center[0]),
                            static_cast<float>(place[1] - center[1]),
                            static_cast<float>(place[2] - center[2]));
    };
    size_t group = first_group;
    for (uint32_t k = n.first_child; k < n.first_child + n.children; ++k) {
      const BodyTree::Node& child = tree_.nodes()[k];
      if (!divides(child)) continue;
      for (; group < end_group && tree_.groups()[group].begin < child.begin; ++group)
        finish(group, keep, about(parts_.places[group].center));
      while (group < end_group && tree_.groups()[group].begin < child.end) ++group;
      const auto& p = tree_.center(k);
      on_child(k, std::span<const Opened>(keep), about({p.x, p.y, p.z}));
    }
    for (; group < end_group; ++group) finish(group, keep, about(parts_.places[group].center));
  }

  /// Processes the whole subtree.
  void all(uint32_t node, std::span<const Opened> left, const FieldSeries& series, size_t depth) {
    go(node, left, series, depth,
       [&](uint32_t child, std::span<const Opened> rest, const FieldSeries& field) {
         all(child, rest, field, depth + 1);
       });
  }

  static bool divides(const BodyTree::Node& n) {
    return n.children > 0 && n.end - n.begin > BodyTree::kMostInGroup;
  }

 private:
  size_t group_from(uint32_t body) const {
    const auto& g = tree_.groups();
    return static_cast<size_t>(
        std::partition_point(g.begin(), g.end(),
                             [&](const BodyTree::Group& one) { return one.begin < body; }) -
        g.begin());
  }

  float least_acceleration(size_t first, size_t end) const {
    float least = HUGE_VALF;
    for (size_t k = first; k < end; ++k) least = std::min(least, parts_.accelerations[k]);
    return least;
  }

  void meet(uint32_t node, const std::array<double, 3>& center, std::span<const Opened> left,
            float acceleration, std::vector<Opened>& keep, FieldSeries& series) {
    const float radius = tree_.columns().radius[node],
                eps2 =
                    laws_.clear > 0 ? walk::kTiny : static_cast<float>(laws_.eps * laws_.eps) + walk::kTiny;
    const walk::Box box{walk::Lanes(center[0]),
                        walk::Lanes(center[1]),
                        walk::Lanes(center[2]),
                        walk::Lanes(radius),
                        walk::Lanes(radius),
                        walk::Lanes(radius),
                        walk::Lanes(radius),
                        walk::Lanes(settings_.opening * static_cast<double>(acceleration)),
                        static_cast<float>(laws_.clear)};
    LocalField field;
    field.clear();
    bool any = false;
    walk::OpenNodes open;
    const auto judge = [&](uint32_t parent, unsigned mask) {
      const BodyTree::Node& n = tree_.nodes()[parent];
      const unsigned there = ((1u << n.children) - 1) & mask,
                     far = walk::standing(tree_.columns(), n.first_child, box).far & there;
      for (unsigned b = far; b != 0; b &= b - 1) {
        field.add(walk::source_of(tree_, n.first_child + static_cast<size_t>(std::countr_zero(b)), center),
                  eps2);
        any = true;
      }
      unsigned kept = 0;
      for (unsigned b = there & ~far; b != 0; b &= b - 1) {
        const auto bit = static_cast<unsigned>(std::countr_zero(b));
        const uint32_t child = n.first_child + bit;
        if (tree_.nodes()[child].children > 0 && tree_.columns().radius[child] > radius) {
          open.push(child);
        } else {
          kept |= 1u << bit;
        }
      }
      if (kept != 0) keep.push_back({parent, kept});
    };
    for (const Opened& o : left) {
      judge(o.node, o.left);
      while (!open.empty()) judge(open.pop(), 0xff);
    }
    if (any) series += field.series(eps2);
  }

  void finish(size_t group, std::span<const Opened> left, const FieldSeries& series) {
    const TreeWork work = way_.run(tree_.groups()[group], parts_.places[group], parts_.accelerations[group],
                                   left, &series, out_);
    if (!out_.work.empty()) out_.work[group] = work;
  }

  const BodyTree& tree_;
  const TreeSettings& settings_;
  const walk::Laws& laws_;
  const TreeSums& out_;
  Parts& parts_;
  Levels& levels_;
  walk::Walk<T> way_;
};

template <class T>
void descend(const BodyTree& tree, const TreeSettings& settings, const TreeSums& out,
             MultipoleScratch::Parts& parts, const ThreadArena& arena) {
  constexpr size_t kShare = 16;    // groups
  constexpr uint32_t kTasks = 64;  // a subtree with less than this share of all bodies is a task
  constexpr Opened kRoot{0, 0xff};
  const walk::Laws laws = walk::laws_of(tree, settings, out);
  parts.places.resize(tree.groups().size()), parts.accelerations.resize(tree.groups().size());
  arena.for_blocks(tree.groups().size(), kShare, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      parts.places[k] = walk::Place(tree, tree.groups()[k]);
      parts.accelerations[k] = walk::coarse_acceleration(tree, parts.places[k], laws);
    }
  });
  if (parts.levels.empty()) parts.levels.resize(1);

  // Above the tasks: one thread, few nodes.
  parts.task_count = 0;
  const uint32_t most = static_cast<uint32_t>(tree.size()) / kTasks;
  {
    Descent<T> above(tree, settings, laws, out, parts, parts.levels[0]);
    const auto go = [&](const auto& self, uint32_t node, std::span<const Opened> left,
                        const FieldSeries& series, size_t depth) -> void {
      above.go(node, left, series, depth,
               [&](uint32_t child, std::span<const Opened> rest, const FieldSeries& field) {
                 const BodyTree::Node& n = tree.nodes()[child];
                 if (n.end - n.begin > most) return self(self, child, rest, field, depth + 1);
                 if (parts.task_count == parts.tasks.size()) parts.tasks.emplace_back();
                 Task& task = parts.tasks[parts.task_count++];
                 task.node = child, task.series = field;
                 task.left.assign(rest.begin(), rest.end());
               });
    };
    go(go, 0, {&kRoot, 1}, {}, 0);
  }
  if (parts.levels.size() < parts.task_count + 1) parts.levels.resize(parts.task_count + 1);
  arena.for_blocks(parts.task_count, 1, [&](size_t k, size_t) {
    Descent<T> below(tree, settings, laws, out, parts, parts.levels[k + 1]);
    const Task& task = parts.tasks[k];
    below.all(task.node, task.left, task.series, 0);
  });
}

}  // namespace

void multipole_sums(const BodyTree& tree, const TreeSettings& settings, const TreeSums& out,
                    MultipoleScratch& scratch, const ThreadArena& arena) {
  if (walk::in_doubles(tree, settings)) {
    descend<double>(tree, settings, out, scratch.parts(), arena);
  } else {
    descend<float>(tree, settings, out, scratch.parts(), arena);
  }
}

}  // namespace truestep::gravity
