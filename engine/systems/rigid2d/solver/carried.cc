// Contacts on bodies that turn and carry others (engine/kernels/rigid/carried_contact.h). The place of a
// contact on a disk lies where its normal points, and goes round with the face that gives the normal, or with
// the line between the centres of two disks.
#include <algorithm>

#include "engine/kernels/rigid/carried_contact.h"
#include "engine/systems/rigid2d/solver/solver.h"

namespace truestep::rigid2d {
namespace {

Vec3 in_space(Vec2 p) {
  return {p.x, p.y, 0};
}

}  // namespace

template <class T>
bool Solver<T>::find_driven(const Model& model, const State& state) {
  driven_.clear();
  const auto broken = state.span<uint32_t>(columns::joint_broken);
  for (const uint32_t i : model.motors) {
    const Joint& d = model.joints[i];
    const bool turns = d.kind == JointKind::revolute || d.kind == JointKind::wheel;
    if (!turns || broken[i]) continue;
    driven_.resize(movers_.size() + 1);
    for (const uint32_t body : {d.a, d.b}) {
      if (slot_[body] < moved_) driven_[slot_[body]] = 1;
    }
  }
  const auto w = state.f64(columns::angular_velocity);
  return !driven_.empty() ||
         std::any_of(movers_.begin() + moved_, movers_.end(), [&](uint32_t body) { return w[body] != 0; });
}

template <class T>
double Solver<T>::carries(uint32_t a, uint32_t b, double spin_a, double spin_b) const {
  const auto outside = [&](uint32_t row) { return row >= moved_ && row < movers_.size(); };
  if (outside(a) && spin_a != 0) return spin_a;
  if (outside(b) && spin_b != 0) return spin_b;
  if (driven_.empty() || a >= moved_ || b >= moved_) return 0;
  return driven_[a] ? spin_a : driven_[b] ? spin_b : 0;
}

template <class T>
void Solver<T>::carry(const ContactPack<T>& c, int lane, const Model& model, const State& state,
                      const Place& at, double h, CarriedPack<T>& out) const {
  const double *v = state.f64(columns::velocity).data(), *w = state.f64(columns::angular_velocity).data();
  const auto disk = [&](uint32_t body) {
    return model.light[body].reach - model.light[body].inner <= 1e-9 * model.light[body].reach;
  };
  const auto velocity = [&](uint32_t body) { return Vec2{v[3 * body], v[3 * body + 1]}; };
  const double orbit =
      flat::cross(at.apart, velocity(at.b) - velocity(at.a)) / std::max(flat::dot(at.apart, at.apart), 1e-30);
  const auto side = [&](uint32_t own, uint32_t other) {
    const double turns = !disk(own) ? w[own] : disk(other) ? orbit : w[other];
    return carried::Side{.velocity = in_space(velocity(own)),
                         .spin = {0, 0, w[own]},
                         .moves = slot_[own] < moved_,
                         .round = disk(own),
                         .turns = {0, 0, turns},
                         .reach = model.light[own].reach};
  };
  // Where the load of the last step acts, or the middle of the points.
  double x = 0, y = 0, weight = 0;
  int points = 0;
  bool loaded = false;
  for (const auto& p : c.point) {
    const double load = p.normal_mass[lane] > 0 ? double(p.normal[lane]) + 1e-12 : 0;
    x += load * p.ax[lane], y += load * p.ay[lane], weight += load;
    points += p.normal_mass[lane] > 0, loaded = loaded || p.normal[lane] > 0;
  }
  if (!(weight > 0)) return;
  const Vec2 on_a{x / weight, y / weight};
  const Vec3 n{c.nx[lane], c.ny[lane], 0};
  // What has only just been hit does not lie there.
  const carried::Found found{in_space(on_a), in_space(on_a - at.then), in_space(at.apart), at.ahead,
                             loaded && points > 1 ? n : Vec3{}};
  const carried::Carried got = carried::velocity(side(at.a, at.b), side(at.b, at.a), found, h);
  const Vec3 along{-n.y, n.x, 0}, first = got.mean - got.rate * (0.5 * h);
  const auto t = [](double x) { return static_cast<T>(x); };
  out.along.set(lane, t(dot(first, along))), out.along_rate.set(lane, t(dot(got.rate, along)));
  out.lift.set(lane, t(dot(first, n))), out.lift_rate.set(lane, t(dot(got.rate, n)));
  const Vec3 from_a = in_space(on_a) * (w[at.a] * w[at.a]),
             from_b = in_space(on_a - at.then) * (w[at.b] * w[at.b]);
  out.missed.set(lane, t(at.ahead * dot(from_b - from_a, n)));
}

template bool Solver<float>::find_driven(const Model&, const State&);
template bool Solver<double>::find_driven(const Model&, const State&);
template double Solver<float>::carries(uint32_t, uint32_t, double, double) const;
template double Solver<double>::carries(uint32_t, uint32_t, double, double) const;
template void Solver<float>::carry(const ContactPack<float>&, int, const Model&, const State&, const Place&,
                                   double, CarriedPack<float>&) const;
template void Solver<double>::carry(const ContactPack<double>&, int, const Model&, const State&, const Place&,
                                    double, CarriedPack<double>&) const;

}  // namespace truestep::rigid2d
