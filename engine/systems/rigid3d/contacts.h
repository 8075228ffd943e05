// Contacts of a step: broad phase over the swept boxes of bodies, narrow phase, impulses of the last step
// matched by features, and the rows of the state that carry them to the next step.
#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "engine/collision/collision.h"
#include "engine/collision/pairs/foreseen_manifold.h"
#include "engine/collision/pairs/seam.h"
#include "engine/core/system.h"
#include "engine/systems/rigid3d/rigid3d_state.h"

namespace truestep::rigid3d {

struct Contact {
  uint32_t a = 0, b = 0;  ///< rows, a < b
  Manifold manifold;      ///< of the poses at which it was found, about the centre of a as it is now
  Vec3 apart;             ///< m by which b has moved relative to a in those poses
  double ahead = 0;       ///< s until those poses
  double impulse[Manifold::kMost] = {};  ///< N s, of one substep
  double penetration_offset = 0;         ///< m between the surfaces without load
  double uneven[Manifold::kMost] = {};   ///< m by which a point's offset exceeds that
  Vec3 slide;                            ///< N s, on b along the plane
  double twist = 0;                      ///< N m s, about the normal
  Vec3 roll;                             ///< N m s
};

/// Data of a body during a step, in addition to the state.
struct BodyNow {
  Transform at;
  double margin = 0;      ///< m, distance at which contacts of a slow body begin
  double turn_speed = 0;  ///< m/s of its outermost point due to rotation
  bool moves = false;     ///< by more than single precision leaves of rest
  bool far = false;       ///< farther in the step than half of the thinnest body
  /// Led bodies are fixed or kinematic, as they move.
  enum class Part : uint8_t { fixed, kinematic, resting, active } part = Part::fixed;
  bool gives_way() const { return part == Part::resting || part == Part::active; }
};

class ContactList {
 public:
  /// Finds all contacts of moving bodies and wakes what they touch. Points count if they are at most a step's
  /// motion apart. Bodies held together by a joint do not touch unless the joint says so. Loaded contacts are
  /// found as they will be `ahead` (s) later.
  void find(State& s, const BodyList& list, std::span<const Joint> joints, const StepInput& in, double ahead);
  /// Ascending by bodies.
  std::span<Contact* const> all() const { return contacts_; }
  std::span<const BodyNow> bodies() const { return bodies_; }
  /// Writes the rows that the next step starts from: these contacts, and the unchanged contacts of resting
  /// bodies.
  void store(State& s);
  /// True if the two bodies touch at a seam of the ground only, or also there.
  bool at_seam(uint32_t a, uint32_t b) const {
    const auto [low, high] = std::minmax(a, b);
    return std::binary_search(seams_.begin(), seams_.end(), uint64_t{low} << 32 | high);
  }
  /// True if body i, which stands on a piece of ground, would meet the ground j at a seam of both.
  bool meets_seam(const State& s, std::span<const BodyKind> kinds, uint32_t i, uint32_t j,
                  const Impact& hit) const;
  const BroadPhase& broad_phase() const { return broad_; }
  /// True if a joint keeps the two bodies from touching.
  bool joined(uint32_t a, uint32_t b) const {
    const auto [low, high] = std::minmax(a, b);
    return std::binary_search(joined_.begin(), joined_.end(), uint64_t{low} << 32 | high);
  }

 private:
  void find_joined(const State& s, std::span<const Joint> joints);
  void update_bounds(const State& s, std::span<const BodyKind> kinds, const StepInput& in, double ahead,
                     double thinnest);
  void narrow_phase(const State& s, std::span<const BodyKind> kinds, const StepInput& in, double ahead);
  /// True where the contact passes a one-way platform: it holds a body that comes from outside and moves
  /// towards it, and keeps holding that body. `margin`: m, of bodies that do not move.
  bool passes(const State& s, std::span<const BodyKind> kinds, const BodyPair& pair, const Manifold& found,
              double margin) const;
  /// Removes the contacts with edges that are covered by the piece of ground beside them.
  void leave_out_seams(const State& s, std::span<const BodyKind> kinds);
  /// Marks the pairs that move and bore a load in the last step.
  void find_bearing(const State& s);
  /// Unmarks those of bodies over several pieces of ground: seams are judged by contacts of one moment.
  void look_at_seams_now(const State& s, std::span<const BodyKind> kinds);
  /// Two bodies as they will be `ahead` (s) later; 0: they hardly move relative to one another.
  struct Outlook {
    double ahead = 0;
    SpaceMotion of_a, of_b;
    Transform a, b;
  };
  void look_ahead(const State& s, std::span<const BodyKind> kinds, const BodyPair& pair, double ahead,
                  Outlook& out) const;
  /// The same for two bodies that meet within h (s); false if they do not, or need not be looked at.
  bool meet(const State& s, std::span<const BodyKind> kinds, const BodyPair& pair, double h,
            Outlook& out) const;
  static void bring_back(Contact& c, const Outlook& o);
  bool wake(State& s, std::span<const BodyKind> kinds);
  /// Columns of the last step's contacts.
  struct Rows {
    explicit Rows(const State& s);
    std::span<const uint32_t> bodies, ids;
    const double *impulse, *normal, *friction, *roll, *offset, *uneven;
  };
  void match(const State& s);
  void match_pair(const Rows& old, std::span<Contact* const> contacts, size_t first, size_t end);

  struct Row {
    uint32_t bodies[2], ids[5];
    double normal[3], impulse[4], uneven[4], friction[4], roll[3], depth, penetration_offset;
  };
  BroadPhase broad_;
  std::vector<BodyNow> bodies_;
  std::vector<Box> boxes_;
  std::vector<Mobility> mobility_;
  std::vector<BodyPair> pairs_;
  /// rad, or sizes of the smaller body, from which on contacts are found ahead: less motion than that is what
  /// single precision leaves of rest.
  static constexpr double kSeenMotion = 1e-6;
  std::vector<uint8_t> bears_;    // per pair; empty if nothing moves
  bool moves_ = false;            // any body
  bool seams_possible_ = false;   // the ground has several pieces
  std::vector<uint8_t> pieces_;   // of ground in reach, per body
  std::vector<uint64_t> joined_;  // pairs that do not touch, ascending; as listed, now and before
  std::vector<uint64_t> joined_now_, joined_before_;
  std::vector<std::vector<Contact>> blocks_;
  std::vector<std::vector<Manifold>> manifolds_;
  std::vector<Contact*> contacts_;
  std::vector<Row> rows_;
  std::vector<std::pair<uint32_t, uint32_t>> on_ground_;  // bodies that touch fixed ones, and the contacts
  std::vector<uint64_t> seams_;                           // pairs of bodies, ascending
  std::vector<std::pair<Floor, size_t>> floors_;          // under a body, and their contacts
  std::vector<uint8_t> claimed_;  // rows of the previous step that a contact continues
};

}  // namespace truestep::rigid3d
