// Contacts of a step solved in substeps: velocities, bias, positions, relax (Catto, "Solver2D", 2024), the
// contacts of one colour side by side. Bodies are moved by what comes out. The impulses of all contacts act
// on from substep to substep; their sum is kept per body, so that starting warm is one addition.
#pragma once
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/contact_solve3.h"
#include "engine/kernels/impact_rows3.h"
#include "engine/systems/rigid3d/contact_softness.h"
#include "engine/systems/rigid3d/contacts.h"
#include "engine/systems/rigid3d/solver_ball.h"
#include "engine/systems/rigid3d/solver_joint.h"

namespace truestep::rigid3d {

/// What forces do to every body in a step.
struct ForceChange {
  std::span<const Vec3> velocity;  ///< m/s
  std::span<const Vec3> momentum;  ///< angular, N m s, in the world; empty where nothing twists
};

template <class T>
class ContactSolver {
 public:
  using W = Wide<T>;
  /// Moves the bodies that have contacts (`slots` tells which) by in.h; `change` is what gravity, pushes and
  /// torques add to the velocity and to the angular momentum of every body in that time.
  void solve(State& s, std::span<const BodyKind> kinds, const JointList& joints,
             std::span<Contact* const> contacts, std::span<const BodyNow> now, const ForceChange& change,
             const SolverSettings& settings, const StepInput& in);
  /// Per body: its place among those that this step's solver moved, or kNoBody.
  std::span<const uint32_t> slots() const { return slot_; }

 private:
  static constexpr size_t kBodiesPerBlock = 256;
  void choose_bodies(const State& s, std::span<const BodyKind> kinds, std::span<Contact* const> contacts,
                     std::span<const BodyNow> now);
  void load_bodies(const State& s, std::span<const BodyKind> kinds, std::span<const BodyNow> now,
                   const ForceChange& change, const SolverSettings& settings, double h);
  void fill(size_t group, std::span<Contact* const> contacts, const State& s, std::span<const BodyKind> kinds,
            std::span<const BodyNow> now);
  void substeps(const State& s, const JointList& joints, const SolverSettings& settings, const StepInput& in);
  void set_turned(size_t body, const Vec3& gyroscopic);
  /// Where joints are: moves the bodies for a substep of h with the velocities that they have.
  void move_jointed(T h);
  /// Bodies on which springs act alone begin and end a step with half of what pulls them in a substep.
  void choose_sprung(const State& s, const JointList& joints, std::span<Contact* const> contacts);
  void kick(T times);
  /// Marks in parts_ the bodies of islands in which all rest on one another under the impulses that were
  /// found: only their springs may start under load, because what topples would be thrown up by them.
  void find_resting();
  /// Lets the first step start from the impulses and offsets that gravity's loads ask for.
  void find_loads(const State& s, std::span<const BodyKind> kinds, std::span<Contact* const> contacts,
                  std::span<const BodyNow> now, const SolverSettings& settings, double h);
  /// The contacts that bear something, from the highest body down, and the loads that gravity puts on them.
  void list_bearings(std::span<Contact* const> contacts, std::span<const BodyNow> now, const Vec3& up);
  void hand_down_loads(std::span<Contact* const> contacts, std::span<const BodyNow> now);
  /// Lets contacts bounce that close within a substep.
  void hit(const ImpactPass<T>& pass, int substeps_left);
  /// Marks the lanes of islands in which a contact is deep, and remembers their impulses.
  void start_parting(const ContactPass<T>& pass);
  void store_impulses(std::span<Contact* const> contacts, const PenetrationOffsetRule& rule);
  void store_bodies(State& s);
  template <class Body>
  void each_body(Body&& body) {
    team_.for_blocks(body_.size(), kBodiesPerBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) body(i);
    });
  }
  /// Body `upper` rests on `lower` (kNoBody: on what does not move) with this contact.
  struct Bearing {
    uint32_t upper, lower, group;
    int lane;
    uint32_t contact;
    double lean, height;  ///< cosine between normal and vertical; m, of the upper body
  };
  template <class U>
  using Aligned = std::vector<U, CacheLineAllocator<U>>;
  std::vector<uint32_t> slot_, body_;
  std::vector<uint32_t> island_;  // per body that moves, where some overlap deeply
  std::vector<uint8_t> parts_;
  std::vector<ScaledBody> scaled_;
  std::vector<Vec3> moments_;
  /// Where joints follow their bodies' turns: roots and ratios (free_rotation.h) of the moments, half of what
  /// a substep changes in the (scaled) spin, and whether that has an axis to change.
  struct Turning {
    Vec3 root, ratios, half;
    bool asymmetric;
  };
  std::vector<Turning> turning_;
  std::vector<Vec3> twist_;  ///< change of spin per substep by torques, about principal axes; empty: none
  Aligned<Record8<T>> velocity_, displacement_, moved_, cross_, change_, warm_, start_, toi_correction_,
      damping_;
  Aligned<ContactGroup<T>> groups_;
  JointSolver<T> joints_;
  BallSolver<T> balls_;
  ThreadTeam team_;
  LaneGroups contact_lanes_;
  LaneColouring colouring_;
  std::vector<ConstraintEnds> ends_;
  std::vector<uint32_t> listed_;
  std::vector<uint8_t> many_;  // contacts of more than two points
  std::vector<Bearing> bearings_;
  uint32_t flags_ = 0, common_flags_ = 0;  // of any group, of all
  std::vector<uint8_t> held_, sprung_;     // per place: something else acts on it; springs alone do
  bool damped_ = false, springs_ = false, jointed_ = false;
};

}  // namespace truestep::rigid3d
