// What a user does to rows of a state for longer than a step: pushes, forces that act for a time, and drags,
// springs from a row to a point in space. They live in columns of the state, one row each, so that they
// survive steps, snapshots and restores. On a body, the point where they act is kept in the body's frame.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/core/state/state.h"
#include "engine/core/state/state_check.h"
#include "engine/math/vec3.h"

namespace truestep {

class UserForces {
 public:
  static constexpr State::Column kNone = ~State::Column{0};

  /// Columns of a system. `who` is u32 or u64: a row, or an id when rows move. `at` has as many components as
  /// the system's space, two or three. `impulse` is what a solver remembers about a drag.
  struct PushColumns {
    State::Column who, force, remaining, at = kNone;
  };
  struct DragColumns {
    State::Column who, target, stiffness, at = kNone, impulse = kNone;
  };

  struct Push {
    uint64_t who;
    Vec3 force;  ///< N
    Vec3 at;     ///< m, about the centre of mass in the body's frame
  };
  struct Drag {
    uint64_t who;
    Vec3 target;       ///< m
    double stiffness;  ///< N/m
    Vec3 at;           ///< m, as for a push
  };

  constexpr UserForces(const PushColumns& push, const DragColumns& drag) : push_(push), drag_(drag) {}
  /// Of a system without drags: none may be set or released.
  explicit constexpr UserForces(const PushColumns& push)
      : push_(push), drag_{.who = kNone, .target = kNone, .stiffness = kNone} {}

  void add_push(State& s, const Push& p, double duration) const;
  /// One drag per row: a new one replaces it, and without `at` keeps the point grabbed first.
  void set_drag(State& s, uint64_t who, const Vec3& target, double stiffness, std::optional<Vec3> at) const;
  /// Ends the drag of one row, or all.
  void release(State& s, std::optional<uint64_t> who) const;
  /// Ends whatever acts on a row that is removed.
  void forget(State& s, uint64_t who) const;
  /// Called after a step of h (s). A push ends with the step in which its time is used up; half a step of
  /// tolerance hides the rounding of counting down.
  void count_down(State& s, double h) const;
  /// The same; `there` says whether a row still exists.
  template <class There>
  void count_down(State& s, double h, const There& there) const {
    count_down(s, h);
    for (size_t k = 0; k < pushes(s);) {
      const uint64_t who = push(s, k).who;
      if (there(who)) {
        ++k;
      } else {
        forget(s, who);
      }
    }
  }

  /// For a state from outside: columns of a push belong together, and `who` is below `rows`.
  void check_pushes(StateCheck& check, uint64_t rows) const;

  bool any(const State& s) const { return pushes(s) + drags(s) > 0; }
  size_t pushes(const State& s) const { return s.rows(push_.who); }
  size_t drags(const State& s) const { return drag_.who == kNone ? 0 : s.rows(drag_.who); }
  Push push(const State& s, size_t k) const;
  Drag drag(const State& s, size_t k) const;

 private:
  PushColumns push_;
  DragColumns drag_;
};

}  // namespace truestep
