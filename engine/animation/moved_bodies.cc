#include "engine/animation/moved_bodies.h"

#include <algorithm>

namespace truestep::animation {

MovedBodies MovedBodies::add(State& s, const std::string& prefix, size_t rows) {
  MovedBodies c;
  c.position = s.add({prefix + "position", "m", Scalar::f64, 3, Role::position}, rows);
  c.velocity = s.add({prefix + "velocity", "m/s", Scalar::f64, 3, Role::velocity}, rows);
  c.orientation = s.add({prefix + "orientation", "1", Scalar::f64, 4}, rows);
  c.angular_velocity = s.add({prefix + "angular_velocity", "rad/s", Scalar::f64, 3}, rows);
  c.form = s.add({prefix + "form", "1", Scalar::u32}, rows);
  c.id = s.add({prefix + "id", "1", Scalar::u64}, rows);
  for (size_t k = 0; k < rows; ++k) {
    s.f64(c.orientation)[4 * k] = 1;
    s.span<uint32_t>(c.form)[k] = static_cast<uint32_t>(k);
    s.span<uint64_t>(c.id)[k] = k;
  }
  return c;
}

void MovedBodies::place(State& s, size_t row, const Pose& to, double h) const {
  const Pose before = pose(s, row);
  if (h > 0) {
    store3(s.f64(velocity).data(), row, (to.position - before.position) / h);
    store3(s.f64(angular_velocity).data(), row,
           free_rotation::rotation_vector(to.orientation * conjugate(before.orientation)) / h);
  }
  store3(s.f64(position).data(), row, to.position);
  const Quat q = normalized(to.orientation);
  std::ranges::copy(std::array{q.w, q.x, q.y, q.z},
                    s.f64(orientation).begin() + static_cast<std::ptrdiff_t>(4 * row));
}

void place_points(std::span<double> x, std::span<double> v, std::span<const double> x1, double h) {
  if (h > 0) {
    for (size_t k = 0; k < x.size(); ++k) v[k] = (x1[k] - x[k]) / h;
  }
  std::ranges::copy(x1, x.begin());
}

}  // namespace truestep::animation
