// Contacts of a step solved in substeps: velocities, push, positions, relax (Catto, "Solver2D", 2024), the
// contacts of one colour side by side. Bodies are moved by what comes out. The impulses of all contacts act
// on from substep to substep; their sum is kept per body, so that starting warm is one addition.
#pragma once
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/constraint_colouring.h"
#include "engine/kernels/contact_rows3.h"
#include "engine/kernels/joint_rows3.h"
#include "engine/systems/rigid3d/contacts.h"

namespace truestep {

struct SolverSettings {
  int substeps = 5;
  double rest_speed = 0.05, push_out_speed = 3;
  double contact_hertz = 60, contact_damping = 10;
};

template <class T>
class ContactSolver {
 public:
  using W = Wide<T>;
  /// Moves the bodies that have contacts (`slots` tells which) by in.h; `change` is what gravity and pushes
  /// add to the velocity of every body in that time.
  void solve(State& s, std::span<const BodyKind> kinds, std::span<const Joint> joints,
             std::span<Contact* const> contacts, std::span<const BodyNow> now, std::span<const Vec3> change,
             const SolverSettings& settings, const StepInput& in);
  /// Per body: its place among those that this step's solver moved, or kNoBody.
  std::span<const uint32_t> slots() const { return slot_; }

 private:
  struct Scaled {
    double root;     // 1/sqrt(m)
    double turn[9];  // S = I^-1/2 R^T by rows
  };
  void choose_bodies(const State& s, std::span<const BodyKind> kinds, std::span<Contact* const> contacts,
                     std::span<const BodyNow> now);
  void load_bodies(const State& s, std::span<const BodyKind> kinds, std::span<const BodyNow> now,
                   std::span<const Vec3> change, const SolverSettings& settings, double h);
  /// Lanes of groups, colour by colour.
  struct Groups {
    std::vector<uint32_t> member;        // item in a lane, or kNoBody
    std::vector<uint32_t> colour_begin;  // first group of a colour, and the end
    size_t count = 0;
  };
  void make_groups(std::span<const uint32_t> items, Groups& out);
  void choose_joints(const State& s, std::span<const BodyNow> now);
  void fill_joint(size_t group, const State& s, std::span<const Joint> joints, std::span<const BodyNow> now);
  void store_joints(State& s, std::span<const Joint> joints, double h);
  void fill(size_t group, std::span<Contact* const> contacts, const State& s, std::span<const BodyKind> kinds,
            std::span<const BodyNow> now);
  void substeps(const SolverSettings& settings, const StepInput& in);
  void store_impulses(std::span<Contact* const> contacts);
  void store_bodies(State& s);
  template <class Group, class Body>
  void each_colour(const Groups& groups, Group* first, const ThreadArena& arena, Body&& body);

  template <class U>
  using Aligned = std::vector<U, CacheLineAllocator<U>>;
  std::vector<uint32_t> slot_, body_;
  std::vector<Scaled> scaled_;
  Aligned<Record8<T>> velocity_, displacement_, change_, warm_, start_, damping_;
  Aligned<ContactGroup<T>> groups_;
  Aligned<JointGroup<T>> joint_groups_;
  Groups contact_lanes_, joint_lanes_;
  std::vector<uint32_t> listed_joints_;
  std::vector<ConstraintEnds> ends_;
  std::vector<uint32_t> listed_, order_;
  std::vector<uint64_t> used_;
  std::vector<uint8_t> colour_;
  uint32_t flags_ = 0;
  bool damped_ = false;
};

}  // namespace truestep
