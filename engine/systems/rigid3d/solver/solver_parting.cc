// Bodies that overlap deeply: their islands, whose pushes are taken back, and the masses with which they are
// pushed apart. Pushes that are taken back move bodies without giving them velocities: no momentum depends on
// these masses.
#include <algorithm>
#include <cmath>

#include "engine/rigid/islands.h"
#include "engine/systems/rigid3d/solver/solver.h"

namespace truestep::rigid3d {

namespace {
/// Mass that a body may have while it is pushed out of others, as a multiple of the lightest of its island: a
/// sweep lifts a heavy body through a light one by the ratio of their masses only.
constexpr double kMostHeavier = 4;
/// Weights of its lighter body that a deep contact must bear for that. A light body that bears less is not
/// held by others, and moves out itself.
constexpr double kPressed = 2;
}  // namespace

template <class T>
void ContactSolver<T>::start_parting(const ContactPass<T>& pass) {
  const auto lanes = [&](auto&& visit) {
    for (size_t g = 0; g < contact_lanes_.count; ++g) {
      for (int lane = 0; lane < W::kLanes; ++lane) visit(groups_[g], lane);
    }
  };
  start_islands(island_);
  lanes([&](ContactGroup<T>& g, int lane) {
    if (g.a[lane] < island_.size() && g.b[lane] < island_.size()) {
      link_islands(island_, g.a[lane], g.b[lane]);
    }
  });
  const auto island = [&](const ContactGroup<T>& g, int lane) {
    const uint32_t body = std::min(g.a[lane], g.b[lane]);
    return body < island_.size() ? island_of(island_, body) : kNoBody;
  };
  std::fill(parts_.begin(), parts_.end(), uint8_t{0});
  pressed_.assign(parts_.size(), 0);
  const auto weight = [&](uint32_t body) {
    if (body >= body_.size()) return HUGE_VAL;
    const T* change = change_[body].x;
    return norm(Vec3{double(change[0]), double(change[1]), double(change[2])}) / scaled_[body].root;
  };
  for (size_t k = 0; k < contact_lanes_.count; ++k) {
    const ContactGroup<T>& g = groups_[k];
    const W left = depth_left(g, pass);
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t i = island(g, lane);
      if (i == kNoBody || !(left[lane] < 0)) continue;
      double load = 0;
      for (int p = 0; p < g.points; ++p) load += g.place[p].impulse[lane];
      parts_[i] = 1;
      if (load > kPressed * std::min(weight(g.a[lane]), weight(g.b[lane]))) pressed_[i] = 1;
    }
  }
  lanes([&](ContactGroup<T>& g, int lane) {
    const uint32_t i = island(g, lane);
    g.before.taken.set(lane, i != kNoBody && parts_[i] ? T(1) : T(0));
    if (lane == 0) remember_impulses(g);
  });
}

template <class T>
bool ContactSolver<T>::lighten() {
  if (std::none_of(pressed_.begin(), pressed_.end(), [](uint8_t p) { return p != 0; })) return false;
  const size_t n = body_.size();
  lightest_.assign(n, HUGE_VAL), lighter_.assign(n + 1, T(1));
  const auto mass = [&](size_t k) { return 1 / (scaled_[k].root * scaled_[k].root); };
  for (uint32_t k = 0; k < n; ++k) {
    const uint32_t i = island_of(island_, k);
    lightest_[i] = std::min(lightest_[i], mass(k));
  }
  bool any = false;
  for (uint32_t k = 0; k < n; ++k) {
    const uint32_t i = island_of(island_, k);
    if (!pressed_[i]) continue;
    const double times = mass(k) / (kMostHeavier * lightest_[i]);
    // A power of two: no other bit of a velocity changes.
    while (double(lighter_[k] * lighter_[k]) < times) lighter_[k] *= 2, any = true;
  }
  if (any) weigh_bodies(Masses::light), weigh_contacts(Masses::light);
  return any;
}

template <class T>
void ContactSolver<T>::weigh_bodies(Masses masses) {
  for (size_t k = 0; k < body_.size(); ++k) {
    if (lighter_[k] == 1) continue;
    const T times = masses == Masses::light ? 1 / lighter_[k] : lighter_[k];
    for (Record8<T>* r : {&velocity_[k], &start_[k]}) {
      for (T& x : r->x) x *= times;
    }
  }
}

template <class T>
void ContactSolver<T>::weigh_contacts(Masses masses) {
  for (size_t g = 0; g < contact_lanes_.count; ++g) {
    W a(1), b(1);
    bool any = false;
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const T fa = lighter_[groups_[g].a[lane]], fb = lighter_[groups_[g].b[lane]];
      any |= fa != 1 || fb != 1;
      a.set(lane, masses == Masses::light ? fa : 1 / fa), b.set(lane, masses == Masses::light ? fb : 1 / fb);
    }
    if (any) truestep::lighten(groups_[g], a, b);
  }
}

template void ContactSolver<float>::start_parting(const ContactPass<float>&);
template bool ContactSolver<float>::lighten();
template void ContactSolver<float>::weigh_bodies(Masses);
template void ContactSolver<float>::weigh_contacts(Masses);
template void ContactSolver<double>::start_parting(const ContactPass<double>&);
template bool ContactSolver<double>::lighten();
template void ContactSolver<double>::weigh_bodies(Masses);
template void ContactSolver<double>::weigh_contacts(Masses);

}  // namespace truestep::rigid3d
