// Solves the contacts of a step in substeps: velocities, bias, positions, relax (Catto, "Solver2D", 2024),
// with the contacts of one colour in parallel, and moves the bodies. The impulses of all contacts persist
// from substep to substep; their sum is kept per body, which makes warm starting one addition.
#pragma once
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/kernels/rigid/contact_solve3.h"
#include "engine/kernels/rigid/impact_rows3.h"
#include "engine/systems/rigid3d/contacts.h"
#include "engine/systems/rigid3d/solver/contact_softness.h"
#include "engine/systems/rigid3d/solver/solver_ball.h"
#include "engine/systems/rigid3d/solver/solver_joint.h"

namespace truestep::rigid3d {

/// Change of every body by forces in a step.
struct ForceChange {
  std::span<const Vec3> velocity;  ///< m/s
  std::span<const Vec3> momentum;  ///< angular, N m s, in the world; empty without torques
};

template <class T>
class ContactSolver {
 public:
  using W = Wide<T>;
  /// Moves the bodies that have contacts (see `slots`) by in.h; `change` is the change of velocity and
  /// angular momentum of every body by gravity, pushes and torques in that time.
  void solve(State& s, std::span<const BodyKind> kinds, const JointList& joints,
             std::span<Contact* const> contacts, std::span<const BodyNow> now, const ForceChange& change,
             const SolverSettings& settings, const StepInput& in);
  /// Gives the contacts of a first step, in settings.substeps, the impulses of the loads that are passed
  /// down: close enough to choose their number, without sweeps (as slow as a hundred steps).
  void find_first_loads(const State& s, std::span<const BodyKind> kinds, const JointList& joints,
                        std::span<Contact* const> contacts, std::span<const BodyNow> now,
                        const ForceChange& change, const SolverSettings& settings, const StepInput& in);
  /// Per body: its index among the bodies moved by this step's solver, or kNoBody.
  std::span<const uint32_t> slots() const { return slot_; }

 private:
  static constexpr size_t kBodiesPerBlock = 256;
  void choose_bodies(const State& s, std::span<const BodyKind> kinds, std::span<Contact* const> contacts,
                     std::span<const BodyNow> now);
  void load_bodies(const State& s, std::span<const BodyKind> kinds, std::span<const BodyNow> now,
                   const ForceChange& change, const SolverSettings& settings, double h);
  /// Rows of bodies, contacts and joints.
  void fill_rows(const State& s, std::span<const BodyKind> kinds, const JointList& joints,
                 std::span<Contact* const> contacts, std::span<const BodyNow> now, const ForceChange& change,
                 const SolverSettings& settings, const StepInput& in);
  void fill(size_t group, std::span<Contact* const> contacts, const State& s, std::span<const BodyKind> kinds,
            std::span<const BodyNow> now, double h);
  void substeps(const State& s, const JointList& joints, const SolverSettings& settings, const StepInput& in);
  void set_turned(size_t body, const Vec3& gyroscopic);
  /// What forces and damping make of a velocity of body i in a substep.
  void act(size_t i, Record8<T>& v) const;
  /// A body that nothing but forces acted on has moved by its velocity at the end of a substep, not by the
  /// mean: up to a bounce and after it, it flies freely, also where only that one step has contacts.
  void keep_on_parabola(size_t i, T h);
  /// With joints: moves the bodies for a substep of h with their current velocities.
  void move_jointed(T h);
  /// The same rotation of body i in move_jointed without series, after one by `before` (scaled) in this step.
  void turn_exactly(size_t i, const Vec3& before, T h);
  /// Bodies on which only springs act begin and end a step with half of the spring impulse of a substep.
  void choose_sprung(const State& s, const JointList& joints, std::span<Contact* const> contacts);
  void kick(T times);
  /// In a first step: the motion that bodies on something that moves have where they rest on it.
  void find_lifted(const State& s, std::span<Contact* const> contacts, std::span<const BodyNow> now,
                   double step);
  /// Adds that motion to start_.
  void lift(T times);
  /// Marks in parts_ the bodies of islands in which all bodies rest on one another under the impulses found:
  /// only their springs may start under load, because loaded springs would throw up what topples.
  void find_resting();
  /// Contacts of bodies at rest can only take from what forces add. Islands for which the sweeps have found
  /// more (light bodies under heavy ones that topple) start without loads.
  void drop_loads_that_drive();
  /// Starts the first step from the impulses and offsets that the gravity loads require.
  void find_loads(const State& s, std::span<const BodyKind> kinds, std::span<Contact* const> contacts,
                  std::span<const BodyNow> now, const SolverSettings& settings, double h);
  /// Load-bearing contacts, from the highest body down, and the gravity loads on them.
  void list_bearings(std::span<Contact* const> contacts, std::span<const BodyNow> now, const Vec3& up);
  void hand_down_loads(std::span<Contact* const> contacts, std::span<const BodyNow> now);
  /// Applies bounces to contacts that close within a substep; false if there are none.
  bool hit(const ImpactPass<T>& pass, int substeps_left);
  /// Marks the lanes of islands with a deep contact, and stores their impulses.
  void start_parting(const ContactPass<T>& pass);
  /// Lets heavy bodies of islands that part move as if they were not much heavier than the lightest; false
  /// where none is.
  bool lighten();
  enum class Masses : uint8_t { own, light };
  /// Velocities of lightened bodies in the scale of these masses; contacts with them.
  void weigh_bodies(Masses masses);
  void weigh_contacts(Masses masses);
  void store_impulses(std::span<Contact* const> contacts, const PenetrationOffsetRule& rule);
  /// Marks the bodies that motors turn.
  void find_driven(const State& s, const JointList& joints);
  /// Lists the balls on surfaces that turn.
  void find_carried();
  void store_bodies(State& s);
  template <class Body>
  void each_body(Body&& body) {
    team_.for_blocks(body_.size(), kBodiesPerBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) body(i);
    });
  }
  /// Body `upper` rests on `lower` (kNoBody: on something fixed) through this contact.
  struct Bearing {
    uint32_t upper, lower, group;
    int lane;
    uint32_t contact;
    double lean, height;  ///< cosine between normal and vertical; m, of the upper body
  };
  template <class U>
  using Aligned = std::vector<U, CacheLineAllocator<U>>;
  std::vector<uint32_t> slot_, body_;
  std::vector<uint32_t> island_;          // per moving body, where some overlap deeply
  std::vector<uint8_t> parts_, pressed_;  // of an island, by its lowest body; also lightest_
  std::vector<double> lightest_;          // kg
  std::vector<T> lighter_;                // root of the ratio of a body's masses, and of `end`
  std::vector<ScaledBody> scaled_;
  std::vector<Vec3> moments_;
  /// For joints that follow the rotation of their bodies: roots and ratios (free_rotation.h) of the moments,
  /// half of the change of the (scaled) spin in a substep, whether its axis can change, and whether it
  /// changes so much that the mean spin is not enough.
  struct Turning {
    Vec3 root, ratios, half;
    bool asymmetric, bends;
  };
  std::vector<Turning> turning_;
  std::vector<Vec3> twist_;  ///< change of spin per substep by torques, about principal axes; empty: none
  Aligned<Record8<T>> velocity_, displacement_, moved_, cross_, change_, warm_, start_, toi_correction_,
      damping_;
  Aligned<Record8<T>> lifted_;  // in a first step, empty where nothing that moves holds anything
  std::vector<T> last_hit_;     // s
  Aligned<Record8<T>> flight_;  // velocities before forces act, where something may bounce
  Aligned<ContactGroup<T>> groups_;
  JointSolver<T> joints_;
  BallSolver<T> balls_;
  ThreadTeam team_;
  LaneGroups contact_lanes_;
  LaneColouring colouring_;
  std::vector<ConstraintEnds> ends_;
  std::vector<uint32_t> listed_;
  std::vector<uint8_t> many_;  // contacts with more than two points
  std::vector<Bearing> bearings_;
  uint32_t flags_ = 0;                  // of any group
  std::vector<uint8_t> driven_;         // per index, empty without motors: a motor turns the body
  std::vector<uint8_t> carried_;        // per index, empty without surfaces that turn
  std::vector<uint8_t> held_, sprung_;  // per index: something else acts on the body; only springs act on it
  bool damped_ = false, springs_ = false, jointed_ = false;
};

}  // namespace truestep::rigid3d
