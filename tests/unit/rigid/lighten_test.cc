// Contacts of lightened bodies (contact_rows3.h) are those of bodies of that mass, and those of before once
// the masses are restored.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/kernels/rigid/contact_rows3.h"

namespace truestep {
namespace {

/// A contact with four points between bodies whose roots of inverse masses and inertias are multiplied.
template <class T>
ContactGroup<T> contact_of(T times_a, T times_b) {
  using W = Wide<T>;
  ContactLanes<T> in{};
  const T normal[3] = {T(0.36), T(0.8), T(0.48)}, offset[3] = {T(0.2), T(1.1), T(0.3)};
  for (int k = 0; k < 3; ++k) in.normal[k] = W(normal[k]), in.offset[k] = W(offset[k]);
  for (int p = 0; p < 4; ++p) {
    in.arm[p][0] = W(T(p % 2) - T(0.4)), in.arm[p][1] = W(T(0.5)), in.arm[p][2] = W(T(p / 2) - T(0.6));
    in.active[p] = W(1), in.separation[p] = W(T(-0.01)), in.impulse[p] = W(T(0.1) * T(p + 1));
  }
  in.root_a = W(T(0.7) * times_a), in.root_b = W(T(0.1) * times_b);
  for (int e = 0; e < 9; ++e) {
    in.turn_a[e] = W((e % 4 == 0 ? T(1.3) : T(0.1)) * times_a);
    in.turn_b[e] = W((e % 4 == 0 ? T(0.2) : T(-0.03)) * times_b);
  }
  in.friction = W(T(0.5)), in.rolling = W(T(0.01));
  ContactGroup<T> g{};
  g.points = 4, g.flags = ContactGroup<T>::kRolls;
  prepare_contacts(g, in);
  return g;
}

template <class T>
bool same_masses(const ContactGroup<T>& g, const ContactGroup<T>& h) {
  const auto same = [](const Wide<T>* a, const Wide<T>* b, int n) {
    for (int i = 0; i < n; ++i) {
      for (int lane = 0; lane < Wide<T>::kLanes; ++lane) {
        if (a[i][lane] != b[i][lane]) return false;
      }
    }
    return true;
  };
  return same(g.k, h.k, 21) && same(g.point_inverse, h.point_inverse, 4) &&
         same(g.slide_inverse, h.slide_inverse, 3) && same(&g.twist_inverse, &h.twist_inverse, 1) &&
         same(g.roll_k, h.roll_k, 3) && same(&g.root_a, &h.root_a, 1) && same(&g.root_b, &h.root_b, 1) &&
         same(g.body_b.axis[1], h.body_b.axis[1], 3);
}

template <class T>
void check() {
  using W = Wide<T>;
  const ContactGroup<T> before = contact_of<T>(1, 1);
  ContactGroup<T> g = before;
  lighten(g, W(2), W(8));
  EXPECT_TRUE(same_masses(g, contact_of<T>(2, 8)));
  EXPECT_FALSE(same_masses(g, before)) << "control";
  lighten(g, W(T(0.5)), W(T(0.125)));
  EXPECT_TRUE(same_masses(g, before));
}

TEST(Lighten, GivesTheContactsOfBodiesOfThatMassAndBack) {
  check<float>();
  check<double>();
}

}  // namespace
}  // namespace truestep
