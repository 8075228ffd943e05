#include "engine/systems/sph/bodies.h"

namespace truestep::sph {

template <int D, class T>
void BodiesIn<D, T>::set(std::span<ImmersedBody> bodies, const Setting& setting) {
  bodies_ = D == 3 ? bodies : std::span<ImmersedBody>(), setting_ = &setting;
  touching_.resize(bodies_.size()), answer_.resize(bodies_.size()), map_of_.resize(bodies_.size());
  image_.assign(bodies_.size(), 0), image_arm_.assign(bodies_.size(), Vec3{});
  for (size_t k = 0; k < bodies_.size(); ++k) map_of_[k] = map(bodies_[k].solid);
}

template <int D, class T>
double BodiesIn<D, T>::fastest() const {
  double out = 0;
  for (const ImmersedBody& b : bodies_)
    out = std::max(out, norm(b.velocity) + norm(b.spin) * bounding_radius(*b.solid));
  return out;
}

template <int D, class T>
void BodiesIn<D, T>::pull(Fluid<D, T>& f, const Vec3& gravity, double h) {
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

template <int D, class T>
void BodiesIn<D, T>::touch(Fluid<D, T>& f, const ThreadArena& arena) {
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

template <int D, class T>
void BodiesIn<D, T>::follow(Fluid<D, T>& f, double h) {
  for (size_t k = 0; k < bodies_.size(); ++k) {
    const Vec3 by = answer_[k].velocity * h;
    change(f, k, push_[k] * h - by * image_[k], about_[k] * h - cross(image_arm_[k], by), by);
  }
}

template <int D, class T>
void BodiesIn<D, T>::shift(double h) {
  for (size_t k = 0; k < bodies_.size(); ++k) {
    bodies_[k].give(push_[k] / h, about_[k] / h);
    bodies_[k].place += answer_[k].velocity;
    bodies_[k].orientation = normalized(free_rotation::turn(answer_[k].spin) * bodies_[k].orientation);
  }
}

template <int D, class T>
void BodiesIn<D, T>::lean(Fluid<D, T>& f, const Vec3& gravity, double h) {
  for (Touch& t : touches_) {
    const double rests = double{f.rests[t.slot]};
    exchange(f, t, leaning(t.slope, t.normal, t.distance, gravity) * (h * rests));
    t.part *= rests;
    const double mass = setting_->mass * t.part;
    image_[t.body] += mass, image_arm_[t.body] += t.arm * mass;
  }
}

template <int D, class T>
void BodiesIn<D, T>::hold(Fluid<D, T>& f, double h) {
  const double nu = setting_->def.viscosity * h, least = kLeastGap * setting_->def.spacing;
  for (const Touch& t : touches_) {
    const T* v = f.v.data() + 4 * t.slot;
    const Vec3 slip = bodies_[t.body].velocity_at(t.arm) - Vec3{double{v[0]}, double{v[1]}, double{v[2]}};
    const Vec3 along = slip - t.normal * dot(slip, t.normal);
    exchange(f, t, along * (nu * t.full * setting_->wall.friction(t.distance, least)));
  }
}

template <int D, class T>
size_t BodiesIn<D, T>::map(const Solid* solid) {
  for (size_t k = 0; k < maps_.size(); ++k) {
    if (maps_[k].solid == solid) return k;
  }
  maps_.push_back({solid, VolumeMap(*solid, setting_->kernel())});
  return maps_.size() - 1;
}

template <int D, class T>
void BodiesIn<D, T>::change(Fluid<D, T>& f, size_t k, const Vec3& impulse, const Vec3& twist,
                            const Vec3& by) {
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

template <int D, class T>
void BodiesIn<D, T>::exchange(Fluid<D, T>& f, const Touch& t, const Vec3& by) {
  const double on[3] = {by.x, by.y, by.z};
  for (size_t a = 0; a < D; ++a) f.v[4 * t.slot + a] += static_cast<T>(on[a]);
  const Vec3 back = by * -setting_->mass;
  bodies_[t.body].give(back, cross(t.arm, back));
}

template <int D, class T>
void BodiesIn<D, T>::find(const Fluid<D, T>& f, size_t k) {
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

template <int D, class T>
void BodiesIn<D, T>::find_beside(const Fluid<D, T>& f, size_t k, const Box& box, const Transform& frame) {
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

template <int D, class T>
void BodiesIn<D, T>::merge(Fluid<D, T>& f) {
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

template <int D, class T>
void BodiesIn<D, T>::weigh() {
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

template <int D, class T>
void BodiesIn<D, T>::carry(Fluid<D, T>& f, size_t k, const ImmersedBody::Answer& by) const {
  for (const Touch& t : touching_from(k)) f.drive[t.slot] -= static_cast<T>(dot(t.slope, by.at(t.arm)));
}

template class BodiesIn<2, float>;
template class BodiesIn<3, float>;
template class BodiesIn<2, double>;
template class BodiesIn<3, double>;

}  // namespace truestep::sph
