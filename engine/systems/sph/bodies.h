// Rigid bodies in the fluid: moving walls, each treated as flat over a kernel's radius, that recoil from the
// particles which they push. In the solves a body responds to every pressure at once, so body and water form
// one system of equations. Without bodies all of this is empty.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "engine/collision/point_distance.h"
#include "engine/core/ports/medium.h"
#include "engine/systems/sph/solvers/passes.h"
#include "engine/systems/sph/volume_map.h"
#include "engine/systems/sph/walls.h"

namespace truestep::sph {

/// How many times a wall's gradient enters the force of a pressure (passes.h).
template <Answer A>
inline constexpr double kTimes = A == Answer::mirror ? 2 : 1;

template <int D, class T>
class BodiesIn {
 public:
  /// The bodies of one step.
  void set(std::span<ImmersedBody> bodies, const Setting& setting);
  bool any() const { return !bodies_.empty(); }

  /// m/s, of the fastest point of any body.
  double fastest() const;
  /// Accelerates the bodies for h s by everything but the fluid; by their weight alone where the rest is
  /// unknown or an impact.
  void pull(Fluid<D, T>& f, const Vec3& gravity, double h);
  void advance(double h) {
    for (ImmersedBody& b : bodies_) b.advance(h);
  }

  /// Finds the particles near bodies and adds the bodies to their walls, whose shares must be set.
  void touch(Fluid<D, T>& f, const ThreadArena& arena);

  /// The bodies' responses to the pressures q of a solve, and their effect on the rates of density.
  template <Answer A>
  void answer(const Aligned<T>& q) {
    constexpr double kTwice = kTimes<A>;
    for (size_t k = 0, at = 0; k < bodies_.size(); ++k) {
      push_[k] = about_[k] = {};
      for (size_t end = at + touching_[k].size(); at < end; ++at) {
        const Touch& t = touches_[at];
        const Vec3 force = t.slope * (kTwice * setting_->mass * double{q[t.slot]});
        push_[k] += force, about_[k] += cross(t.arm, force);
      }
      answer_[k] = bodies_[k].answer(push_[k], about_[k]);
      if (bodies_[k].mass > 0) answer_[k].velocity *= bodies_[k].mass / (bodies_[k].mass + image_[k]);
    }
    for (const Touch& t : touches_) slot_of(recoil_, t) = 0;
    for (const Touch& t : touches_)
      slot_of(recoil_, t) -= static_cast<T>(kTwice * dot(t.slope, answer_[t.body].at(t.arm)));
  }
  /// 1/s^2, of the last response.
  T recoil(size_t i) const { return recoil_[i]; }
  /// 1/m^2, to be added to the diagonal of a solve.
  template <Answer A>
  T give(size_t i) const {
    return static_cast<T>(kTimes<A> * kTimes<A>) * give_[i];
  }
  /// Applies the last response for h s.
  void follow(Fluid<D, T>& f, double h);
  /// The last response was in displacements, not accelerations: moves the bodies by it in h s.
  void shift(double h);
  /// The weight of the fluid on bodies and their reaction (walls.h) for h s. The fluid's mirror image in a
  /// body moves with the body: it adds to the body's mass.
  void lean(Fluid<D, T>& f, const Vec3& gravity, double h);
  /// Viscous drag between particles and bodies for h s.
  void hold(Fluid<D, T>& f, double h);

 private:
  struct Touch {
    uint32_t slot, body;
    double share, distance, part;  ///< part: that of the body in the share of all walls
    double full;                   ///< 1, the slope across its surface over that of a flat face
    Vec3 slope, arm, normal;       ///< slope: 1/m, into the body
  };
  /// In units of squared gravity: a stronger acceleration is an impact and does not last.
  static constexpr double kSteady = 2;

  static T& slot_of(Aligned<T>& a, const Touch& t) { return a[t.slot]; }

  size_t map(const Solid* solid);

  /// Gives a body an impulse and an angular impulse, and its change of velocity `by` to its image.
  void change(Fluid<D, T>& f, size_t k, const Vec3& impulse, const Vec3& twist, const Vec3& by);
  /// Adds to a particle's velocity and takes the momentum from the body.
  void exchange(Fluid<D, T>& f, const Touch& t, const Vec3& by);

  /// m, within which a body's particles are looked for: they may have moved a little since they were sorted.
  double margin_of_sorting() const { return setting_->support + 0.5 * setting_->def.spacing; }

  void find(const Fluid<D, T>& f, size_t k);
  /// The particles near an image of body k with these bounds and this place.
  void find_beside(const Fluid<D, T>& f, size_t k, const Box& box, const Transform& frame);

  /// Combines shares as in walls.h and scales each slope by what all other walls leave of the kernel.
  void merge(Fluid<D, T>& f);

  /// Bounds the eigenvalues by row sums: for each touch of a body, the strengths with which it couples to
  /// itself and to all others.
  void weigh();

  /// Changes the rates of density after a change of a body's velocity.
  void carry(Fluid<D, T>& f, size_t k, const ImmersedBody::Answer& by) const;
  std::span<const Touch> touching_from(size_t k) const {
    size_t first = 0;
    for (size_t j = 0; j < k; ++j) first += touching_[j].size();
    return std::span<const Touch>(touches_).subspan(first, touching_[k].size());
  }

  struct MapOf {
    const Solid* solid;
    VolumeMap map;
  };
  const Setting* setting_ = nullptr;
  std::vector<MapOf> maps_;
  std::vector<size_t> map_of_;  ///< by body
  std::span<ImmersedBody> bodies_;
  std::vector<std::vector<Touch>> touching_;  ///< by body, as found
  std::vector<Touch> touches_;                ///< of all bodies, in their order
  std::vector<double> image_;                 ///< kg, of the fluid's image in a body
  std::vector<Vec3> image_arm_;               ///< kg m, image times its arm
  std::vector<Vec3> push_, about_;            ///< N and N m, of the last response
  std::vector<ImmersedBody::Answer> answer_;
  Aligned<T> recoil_, give_;  ///< by slot; zero where no body is near
};

}  // namespace truestep::sph
