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
  void set(std::span<ImmersedBody> bodies, const Setting& setting) {
    bodies_ = D == 3 ? bodies : std::span<ImmersedBody>(), setting_ = &setting;
    touching_.resize(bodies_.size()), answer_.resize(bodies_.size()), map_of_.resize(bodies_.size());
    image_.assign(bodies_.size(), 0), image_arm_.assign(bodies_.size(), Vec3{});
    for (size_t k = 0; k < bodies_.size(); ++k) map_of_[k] = map(bodies_[k].solid);
  }
  bool any() const { return !bodies_.empty(); }

  /// m/s, of the fastest point of any body.
  double fastest() const {
    double out = 0;
    for (const ImmersedBody& b : bodies_)
      out = std::max(out, norm(b.velocity) + norm(b.spin) * bounding_radius(*b.solid));
    return out;
  }
  /// Accelerates the bodies for h s by everything but the fluid; by their weight alone where the rest is
  /// unknown or an impact.
  void pull(Fluid<D, T>& f, const Vec3& gravity, double h) {
    for (size_t k = 0; k < bodies_.size(); ++k) {
      ImmersedBody& b = bodies_[k];
      const double image = image_[k];
      if (!(b.mass > 0)) {
        b.give(gravity * (h * image), cross(image_arm_[k], gravity * h));
        continue;
      }
      const bool steady = b.pull && norm2(*b.pull) <= kSteady * norm2(gravity);
      const Vec3 alone = (steady ? *b.pull : gravity) * h;
      const Vec3 by = (alone * b.mass + gravity * (h * image)) / (b.mass + image);
      b.velocity += alone;
      change(f, k, (by - alone) * b.mass, cross(image_arm_[k], gravity * h - by), by);
      carry(f, k, {alone, {}});
    }
  }
  void advance(double h) {
    for (ImmersedBody& b : bodies_) b.advance(h);
  }

  /// Finds the particles near bodies and adds the bodies to their walls, whose shares must be set.
  void touch(Fluid<D, T>& f, const ThreadArena& arena) {
    for (const Touch& t : touches_) slot_of(recoil_, t) = 0, slot_of(give_, t) = 0;
    recoil_.resize(f.n), give_.resize(f.n);
    arena.for_blocks(bodies_.size(), 1, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) find(f, k);
    });
    size_t count = 0;
    for (const auto& list : touching_) count += list.size();
    touches_.clear();
    // An emptied vector would grow to what it is given, again with every particle more.
    if (count > touches_.capacity()) touches_.reserve(count + count / 2);
    for (const auto& list : touching_) touches_.insert(touches_.end(), list.begin(), list.end());
    merge(f);
    weigh();
  }

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
  void follow(Fluid<D, T>& f, double h) {
    for (size_t k = 0; k < bodies_.size(); ++k) {
      const Vec3 by = answer_[k].velocity * h;
      change(f, k, push_[k] * h - by * image_[k], about_[k] * h - cross(image_arm_[k], by), by);
    }
  }
  /// The last response was in displacements, not accelerations: moves the bodies by it in h s.
  void shift(double h) {
    for (size_t k = 0; k < bodies_.size(); ++k) {
      bodies_[k].give(push_[k] / h, about_[k] / h);
      bodies_[k].place += answer_[k].velocity;
      bodies_[k].orientation = normalized(free_rotation::turn(answer_[k].spin) * bodies_[k].orientation);
    }
  }
  /// The weight of the fluid on bodies and their reaction (walls.h) for h s. The fluid's mirror image in a
  /// body moves with the body: it adds to the body's mass.
  void lean(Fluid<D, T>& f, const Vec3& gravity, double h) {
    for (Touch& t : touches_) {
      const double rests = double{f.rests[t.slot]};
      exchange(f, t, leaning(t.slope, t.normal, t.distance, gravity) * (h * rests));
      t.part *= rests;
      const double mass = setting_->mass * t.part;
      image_[t.body] += mass, image_arm_[t.body] += t.arm * mass;
    }
  }
  /// Viscous drag between particles and bodies for h s.
  void hold(Fluid<D, T>& f, double h) {
    const double nu = setting_->def.viscosity * h, least = kLeastGap * setting_->def.spacing;
    for (const Touch& t : touches_) {
      const T* v = f.v.data() + 4 * t.slot;
      const Vec3 slip = bodies_[t.body].velocity_at(t.arm) - Vec3{double{v[0]}, double{v[1]}, double{v[2]}};
      const Vec3 along = slip - t.normal * dot(slip, t.normal);
      exchange(f, t, along * (nu * t.full * setting_->wall.friction(t.distance, least)));
    }
  }

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

  size_t map(const Solid* solid) {
    for (size_t k = 0; k < maps_.size(); ++k) {
      if (maps_[k].solid == solid) return k;
    }
    maps_.push_back({solid, VolumeMap(*solid, setting_->kernel())});
    return maps_.size() - 1;
  }

  /// Gives a body an impulse and an angular impulse, and its change of velocity `by` to its image.
  void change(Fluid<D, T>& f, size_t k, const Vec3& impulse, const Vec3& twist, const Vec3& by) {
    ImmersedBody& b = bodies_[k];
    const ImmersedBody::Answer before{b.velocity, b.spin};
    b.give(impulse, twist);
    carry(f, k, {b.velocity - before.velocity, b.spin - before.spin});
    if (!(image_[k] > 0)) return;
    const double on[3] = {by.x, by.y, by.z};
    for (const Touch& t : touching_from(k)) {
      for (size_t a = 0; a < D; ++a) f.v[4 * t.slot + a] += static_cast<T>(t.part * on[a]);
    }
  }
  /// Adds to a particle's velocity and takes the momentum from the body.
  void exchange(Fluid<D, T>& f, const Touch& t, const Vec3& by) {
    const double on[3] = {by.x, by.y, by.z};
    for (size_t a = 0; a < D; ++a) f.v[4 * t.slot + a] += static_cast<T>(on[a]);
    const Vec3 back = by * -setting_->mass;
    bodies_[t.body].give(back, cross(t.arm, back));
  }

  /// m, within which a body's particles are looked for: they may have moved a little since they were sorted.
  double margin_of_sorting() const { return setting_->support + 0.5 * setting_->def.spacing; }

  void find(const Fluid<D, T>& f, size_t k) {
    auto& list = touching_[k];
    list.clear();
    const ImmersedBody& b = bodies_[k];
    const Transform frame = b.frame();
    const double margin = margin_of_sorting();
    const Box box = bounds(*b.solid, frame);
    const Images images = images_of(setting_->def, box);
    if (!images.any()) return find_beside(f, k, box, frame);
    const Vec3 middle = (box.low + box.high) * 0.5,
               half = (box.high - box.low) * 0.5 + Vec3{margin, margin, margin};
    const SphDef& d = setting_->def;
    const Vec3 room = (d.high - d.low) * 0.5;
    images.each(d.low + room - middle, room + half, [&](const Vec3& shift) {
      find_beside(f, k, Box{box.low + shift, box.high + shift}, Transform{frame.rotation, b.place + shift});
    });
  }
  /// The particles near an image of body k with these bounds and this place.
  void find_beside(const Fluid<D, T>& f, size_t k, const Box& box, const Transform& frame) {
    auto& list = touching_[k];
    const ImmersedBody& b = bodies_[k];
    const VolumeMap& map = maps_[map_of_[k]].map;
    const double reach = setting_->support, margin = margin_of_sorting();
    const double lows[3] = {box.low.x, box.low.y, box.low.z}, highs[3] = {box.high.x, box.high.y, box.high.z};
    int low[3] = {}, high[3] = {};
    for (int a = 0; a < D; ++a) {
      low[a] = f.cells.along(lows[a] - margin, a), high[a] = f.cells.along(highs[a] + margin, a);
    }
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        int c[3] = {low[0], y, z};
        const size_t first = f.order.start(f.cells.of(c));
        c[0] = high[0];
        const size_t last = f.order.start(f.cells.of(c) + 1);
        for (size_t i = first; i < last; ++i) {
          const Vec3 x{double{f.x[0][i]}, double{f.x[1][i]}, D == 3 ? double{f.x[2][i]} : 0};
          const Vec3 local = frame.inverse_point(x);
          const auto near = point_distance(*b.solid, local, reach, map.sides());
          if (!near) continue;
          const HalfSpace::At flat = setting_->wall.at(near->distance);
          const VolumeMap::At shape = map.at(local, near->normal);
          const Vec3 n = frame.direction(near->normal);
          list.push_back({static_cast<uint32_t>(i), static_cast<uint32_t>(k), flat.share * shape.share,
                          near->distance, 0, std::max(-dot(shape.slope, near->normal), 0.0),
                          frame.direction(shape.slope) * flat.slope, x - n * near->distance - frame.position,
                          n});
        }
      }
    }
  }

  /// Combines shares as in walls.h and scales each slope by what all other walls leave of the kernel.
  void merge(Fluid<D, T>& f) {
    for (const Touch& t : touches_) slot_of(recoil_, t) += static_cast<T>(t.share);
    for (Touch& t : touches_)
      t.part = t.share / std::max(double{f.wall[4 * t.slot + 3]} + double{slot_of(recoil_, t)}, 1e-9);
    for (const Touch& t : touches_) {
      T* w = f.wall.data() + 4 * t.slot;
      const T rest = static_cast<T>(1 - t.share);
      for (size_t a = 0; a < 3; ++a) w[a] *= rest;
      f.drive[t.slot] *= rest;
      w[3] = 1 - (1 - w[3]) * rest;
    }
    for (Touch& t : touches_) {
      T* w = f.wall.data() + 4 * t.slot;
      t.slope = t.slope * ((1 - double{w[3]}) / std::max(1 - t.share, 1e-6));
      t.part *= double{w[3]};
      slot_of(recoil_, t) = 0;
    }
    for (const Touch& t : touches_) {
      T* w = f.wall.data() + 4 * t.slot;
      w[0] += static_cast<T>(t.slope.x), w[1] += static_cast<T>(t.slope.y);
      w[2] += static_cast<T>(t.slope.z);
      f.drive[t.slot] -= static_cast<T>(dot(t.slope, bodies_[t.body].velocity_at(t.arm)));
    }
  }

  /// Bounds the eigenvalues by row sums: for each touch of a body, the strengths with which it couples to
  /// itself and to all others.
  void weigh() {
    push_.resize(bodies_.size()), about_.resize(bodies_.size());
    image_.assign(bodies_.size(), 0), image_arm_.assign(bodies_.size(), Vec3{});
    for (size_t k = 0, at = 0; k < bodies_.size(); ++k) {
      const ImmersedBody& b = bodies_[k];
      const size_t end = at + touching_[k].size();
      if (!(b.mass > 0)) {
        at = end;
        continue;
      }
      double pushes = 0, turns = 0;
      for (size_t j = at; j < end; ++j) {
        pushes += norm(touches_[j].slope), turns += norm(cross(touches_[j].arm, touches_[j].slope));
      }
      const double least = std::min({b.moments.x, b.moments.y, b.moments.z});
      for (; at < end; ++at) {
        const Touch& t = touches_[at];
        slot_of(give_, t) += static_cast<T>(
            setting_->mass * (norm(t.slope) * pushes / b.mass + norm(cross(t.arm, t.slope)) * turns / least));
      }
    }
  }

  /// Changes the rates of density after a change of a body's velocity.
  void carry(Fluid<D, T>& f, size_t k, const ImmersedBody::Answer& by) const {
    for (const Touch& t : touching_from(k)) f.drive[t.slot] -= static_cast<T>(dot(t.slope, by.at(t.arm)));
  }
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
