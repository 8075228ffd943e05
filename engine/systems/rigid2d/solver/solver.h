// One step of the velocity solver: substeps with soft constraints (TGS-soft: Macklin et al. 2019, "Small
// steps in physics simulation"; Catto 2024, "Solver2D"). Per substep h:
//   v += h (g + F/m);  warm start;  solve with bias;  x += h v;  solve without bias;  bounces at the end.
// A body on which no impulse and no joint acts moves by the mean of its velocities before and after: along
// its parabola.
// Bodies are rows of eight numbers (v, w, 1/m, dx, dangle, 1/I) relative to the start of the step;
// constraints are packed by colour, one per SIMD lane. Poses outside of the solver stay f64.
#pragma once
#include <array>
#include <atomic>
#include <cmath>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/parallel.h"
#include "engine/core/system.h"
#include "engine/kernels/rigid/penetration_offset.h"
#include "engine/kernels/rigid/soft_constraint.h"
#include "engine/math/wide.h"
#include "engine/rigid/colours.h"
#include "engine/rigid/constraint_colouring.h"
#include "engine/systems/rigid2d/pairs.h"
#include "engine/systems/rigid2d/solver/solver_joint.h"

namespace truestep::rigid2d {

inline constexpr size_t kBodiesPerTask = 1024, kPacksPerTask = 64;

/// Bodies with more contacts get the softness of this many.
inline constexpr size_t kCrowd = 8;

struct SolverSettings {
  int steps = 4;
  double h = 0;  ///< s, of a substep
  /// Indexed by the number of contacts of the busier body.
  std::array<SoftConstraint<double>, kCrowd + 1> contact, contact_fixed;
  SoftConstraint<double> joint;
  PenetrationOffsetRule padding;
  double push_out_speed = 3, restitution_speed = 0;
  int push_sweeps = 1;  ///< in substeps where some overlap deeply
};

/// User forces in a step: forces on bodies, and springs from points to targets.
struct Hands {
  struct Force {
    uint32_t body = 0;
    Vec2 force;         ///< N
    double torque = 0;  ///< N m
  };
  struct Drag {
    Joint joint;  ///< a mouse joint
    Vec2 impulse;
  };
  std::vector<Force> forces;
  std::vector<Drag> drags;
};

/// Contacts in SIMD lanes; unused lanes have zero masses.
template <class T>
struct ContactPack {
  using W = Wide<T>;
  struct Point {
    W ax, ay, bx, by;  // anchors about the centres at the start of the step
    W separation;      // at the start of the step, m
    W normal_mass, tangent_mass;
    W normal, tangent;  // impulses
  };
  uint32_t a[W::kLanes], b[W::kLanes];  // rows
  W nx, ny, friction, surface_speed, restitution;
  W bias_rate, mass_scale, impulse_scale;
  W rolling, rolling_mass, rolling_impulse;
  W round_a, round_b;                  // radii of the shapes' rounding, m
  W stiffness0, stiffness1, coupling;  // K of the two normals, 1/kg
  W held;                              // the coupling, slightly reduced where K has no inverse
  Point point[2];
  uint32_t rolls, bounces, crowded, turns;
  // Written only in substeps with deep overlaps.
  struct Before {
    W taken;  // 1 in lanes whose push is taken back
    W normal[2], tangent[2], rolling;
  } before;
};

/// What the surfaces of a pack that `turns` do beyond the motion of the bodies' rows (carried_contact.h):
/// speed (m/s, m/s^2) along tangent and normal, and the speed at which separations, with arms of the middle
/// of the step, miss those of the arms at its start.
template <class T>
struct CarriedPack {
  Wide<T> along, along_rate, lift, lift_rate, missed;
};

/// Joints that only hold two points together, in SIMD lanes.
template <class T>
struct HingePack {
  using W = Wide<T>;
  uint32_t a[W::kLanes], b[W::kLanes];
  uint32_t joint[W::kLanes];
  W ax, ay, bx, by;  // anchors about the centres at the start of the step
  W ex, ey;          // from anchor to anchor at the start of the step
  W ix, iy;          // impulse
};

template <class T>
using Aligned = std::vector<T, CacheLineAllocator<T>>;

template <class T>
class Solver {
 public:
  /// Moves the bodies of `state` by a step of `settings.steps` substeps and stores the impulses of joints
  /// and drags; contact impulses are stored by store_contacts.
  void solve(const Model& model, State& state, const Pairs& pairs, Hands& hands,
             const SolverSettings& settings, const ThreadArena& arena);
  /// Stores the rows of `contact` for touching pairs, and those carried along.
  void store_contacts(const Model& model, const Pairs& pairs, const PenetrationOffsetRule& rule,
                      State& state);

  /// Motion of a body in this step (m, rad).
  struct Moved {
    Vec2 shift;
    double angle = 0;
  };
  Moved moved(uint32_t body) const {
    const T* r = rows_.data() + 8 * static_cast<size_t>(slot_[body]);
    return {{r[4], r[5]}, r[6]};
  }
  /// Bodies that moved under constraints or on their own, ascending.
  const std::vector<uint32_t>& movers() const { return movers_; }

 private:
  void place_bodies(const Model& model, const State& state, const Pairs& pairs, const Hands& hands,
                    const SolverSettings& settings);
  void pack_contacts(const Model& model, const State& state, const Pairs& pairs,
                     const SolverSettings& settings, const ThreadArena& arena);
  /// Marks the rows of bodies that motors turn; returns whether any body carries others round.
  bool find_driven(const Model& model, const State& state);
  /// rad/s at which one of two rows carries the other round: it is moved from outside, or turned by a motor.
  double carries(uint32_t a, uint32_t b, double spin_a, double spin_b) const;
  /// Where a contact of two bodies was found: the centre of b from that of a at the start of the step and
  /// `then`, `ahead` s later.
  struct Place {
    uint32_t a = 0, b = 0;
    Vec2 apart, then;
    double ahead = 0;
  };
  /// Gives a lane what its surfaces' velocity exceeds that of the solver's rows by.
  void carry(const ContactPack<T>& pack, int lane, const Model& model, const State& state, const Place& at,
             double h, CarriedPack<T>& out) const;
  void fill(ContactPack<T>& pack, const uint32_t* hits, int count, const Model& model, const State& state,
            const Pairs& pairs, const SolverSettings& settings);
  void pack_joints(const Model& model, const State& state, const Pairs& pairs, const Hands& hands,
                   const SolverSettings& settings);
  JointRow<T> row_of(const Joint& joint, const Pairs& pairs, const SolverSettings& settings,
                     const State& state) const;
  /// Initial impulses and offsets of contacts if none continues another.
  void start_contacts(const Model& model, const Pairs& pairs, const SolverSettings& settings,
                      const ThreadArena& arena);
  /// Contacts through which bodies at rest support others, the highest first.
  void list_bearings(const Pairs& pairs, double h);
  /// Marks in parts_ the bodies of islands in which every load lies above its support.
  void find_balance();
  /// Adds the loads of arches, wedges and leaning bodies to those that find_balance passed down. Marks in
  /// parts_ the bodies of islands that were not held without them and are now; others keep their loads.
  void sweep_loads(const SolverSettings& settings, const ThreadArena& arena);
  /// Marks the rows of islands in which the velocities in start_, what contacts leave of a substep's
  /// forces, are small; returns the sum of their squares over the bodies on which contacts act, as a fraction
  /// of what forces add.
  double find_held(std::vector<uint8_t>& held);
  /// m by which a point yields under an impulse per substep.
  double yields(const ContactPack<T>& c, int lane, int point, double load) const;
  /// Adds penetration offsets (m) to the points of a contact.
  void begin_with(uint32_t pack, int lane, const double offset[2]);
  /// Applies bounces to contacts that close within a substep.
  void hit_contacts(const SolverSettings& settings, const ThreadArena& arena);
  /// Bodies on which only springs act begin and end a step with half of the spring impulse of a substep
  /// (oscillator_step).
  void choose_sprung(const Pairs& pairs, double h);
  void kick(JointPass pass, T h);
  void find_islands();
  /// Marks the lanes of islands with a deep contact, finds crowds, and stores impulses and
  /// velocities.
  void start_parting(const Model& model, T push_out_speed);
  /// Lets heavy bodies of islands that part move as if they were not much heavier than the lightest; false
  /// where none is.
  bool lighten(const Model& model);
  void restore_masses();
  /// Effective masses of the contacts that part, from the masses in the rows.
  void weigh_contacts();
  /// `elapsed`: s since the start of the step.
  void substep(const Model& model, const SolverSettings& settings, T elapsed, const ThreadArena& arena);
  /// Forces and damping of a substep on a velocity vx vy w.
  static void act(const T* push, T* v) {
    v[0] = (v[0] + push[0]) * push[3], v[1] = (v[1] + push[1]) * push[3], v[2] = (v[2] + push[2]) * push[4];
  }
  /// Puts bodies without joints that no impulse reached where their parabola ends.
  void end_free_flights(const Model& model, const State& state, const SolverSettings& settings,
                        const ThreadArena& arena);
  void store_bodies(State& state, double dt, const ThreadArena& arena) const;
  void store_joints(const Model& model, State& state, Hands& hands, const SolverSettings& settings) const;

  std::vector<uint32_t> slot_;    // row of every body
  std::vector<uint32_t> movers_;  // body of row i, the dynamic ones first, then kinematic ones
  uint32_t moved_ = 0;            // rows below it take impulses
  Aligned<T> rows_;
  Aligned<T> push_;            // per row: change of vx vy w per substep, damping factors
  Aligned<T> toi_correction_;  // per row: shift, angle and time of bodies that hit within the substep
  Aligned<T> flight_;          // per row, where some bounce: vx vy w as forces leave them, and before
  bool bounces_ = false;
  std::atomic<bool> deep_ = false;  // some contact overlaps deeply
  Aligned<T> start_;                // rows before the pushes, where some contact overlaps deeply
  std::vector<uint32_t> island_;    // roots of the rows' islands, computed when a step needs them
  bool knows_islands_ = false, crowded_ = false;
  std::vector<uint8_t> parts_, inside_;      // inside_: of every row, pairs in which it is inside the other
  std::vector<double> pressed_;              // N s, of every island: the largest load of a deep contact
  std::vector<double> lightest_, heaviest_;  // kg and N s, of every island: masses, and weights in a substep
  std::vector<std::array<T, 2>> masses_;  // inverse mass and inertia of every row, while some are lightened
  Aligned<ContactPack<T>> contacts_;
  Aligned<CarriedPack<T>> carried_;  // of every pack, empty where nothing turns and carries
  Aligned<HingePack<T>> hinges_;
  std::vector<uint32_t> contact_colours_, hinge_colours_;  // first pack of every colour, and the end
  std::vector<JointRow<T>> joints_;                        // the drags come last
  size_t drags_ = 0;
  std::vector<uint8_t> driven_;         // rows, empty without motors: a motor turns the body
  std::vector<uint8_t> held_, sprung_;  // rows: something else acts on the body; only springs act on it
  std::vector<double> spring_rates_;    // rows: 1/s, sum over the springs of a body
  bool springs_ = false;
  // Scratch of the packing.
  std::vector<ConstraintEnds> ends_;
  std::vector<uint64_t> used_;
  std::vector<uint8_t> colour_;
  std::vector<uint32_t> order_, place_, hinge_list_;
  std::vector<uint32_t> old_id_, crowd_;  // crowd_: contacts of every row
  std::vector<float> old_impulse_, old_offset_;
  struct Bearing {
    uint32_t upper = 0, lower = 0, pack = 0;  // rows
    int lane = 0;
    double lean = 0, height = 0;
  };
  /// Load of a row at the start: N s of a substep with its moment about the centre along the horizontal,
  /// the horizontal range in which it is supported, and the sum of cos^2 over its supports.
  struct Seat {
    double load = 0, moment = 0, low = HUGE_VAL, high = -HUGE_VAL, share = 0;
    uint32_t bearings = 0;
  };
  /// Horizontal position of a bearing's point, relative to the centre of one of its bodies.
  double across(const Bearing& b, uint32_t body, int i) const;
  /// Fractions of a bearing's load on its two points.
  std::array<double, 2> parts_of(const Bearing& b) const;
  std::vector<Bearing> bearings_;
  std::vector<Seat> seats_;
  std::vector<std::array<double, 2>> loads_;  // of the bearings' points
  std::vector<uint8_t> balanced_, held_before_, held_now_;
};

}  // namespace truestep::rigid2d
