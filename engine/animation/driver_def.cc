#include "engine/animation/driver_def.h"

#include <algorithm>

namespace truestep::animation {

namespace {

constexpr Count kKeys{0, 1'000'000};
const std::vector<std::string> kInterpolations{"step",   "linear",  "catmull_rom", "hermite",
                                               "bezier", "natural", "monotone"};
const std::vector<std::string> kExtends{"clamp", "loop", "ping_pong"};

void check_times(const std::vector<double>& times, const DefTable::Report& report) {
  for (size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    return report("/times/" + std::to_string(i), "times of keys must ascend");
  }
}
void check_count(size_t have, size_t want, const char* pointer, const std::string& what,
                 const DefTable::Report& report) {
  if (have != want) report(pointer, "needs " + what + ", " + std::to_string(want) + " numbers in all");
}

}  // namespace

Quat euler_rotation(EulerOrder order, const Vec3& a) {
  static constexpr int kAxes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const Quat q[3] = {turn_about({1, 0, 0}, a.x), turn_about({0, 1, 0}, a.y), turn_about({0, 0, 1}, a.z)};
  const int* axes = kAxes[static_cast<size_t>(order)];
  return q[axes[0]] * q[axes[1]] * q[axes[2]];
}

const DefTable& control_table() {
  using D = ControlDef;
  static const DefTable t =
      TableOf<D>("a named number, by an expression or through keys")
          .text("name", &D::name, "letters, digits and _")
          .required()
          .expression("value", &D::value, "of t (s) and the controls and paths before it; instead of keys")
          .numbers("times", &D::times, "s", any(), kKeys, "of the keys, ascending")
          .numbers("values", &D::values, "1", any(), kKeys, "one per key")
          .numbers("slopes_in", &D::slopes_in, "1/s", any(), kKeys,
                   "before each key, for hermite and bezier; absent: those of catmull_rom")
          .numbers("slopes_out", &D::slopes_out, "1/s", any(), kKeys, "after each key; absent: slopes_in")
          .numbers("handles", &D::handles, "1", between(0, 1), kKeys,
                   "two per key, for bezier: how far the handles before and after it reach, as shares of the "
                   "interval; absent: 1/3")
          .choice("interpolation", &D::interpolation, kInterpolations, "between keys")
          .choice("extend", &D::extend, kExtends, "before the first and after the last key")
          .check([](const D& d, const DefTable::Report& report) {
            const size_t n = d.times.size();
            if (d.value.empty() == d.times.empty()) report("", "a control has a value or keys, one of them");
            check_times(d.times, report);
            check_count(d.values.size(), n, "/values", "one per key", report);
            if (!d.slopes_in.empty()) check_count(d.slopes_in.size(), n, "/slopes_in", "one per key", report);
            if (!d.slopes_out.empty())
              check_count(d.slopes_out.size(), n, "/slopes_out", "one per key", report);
            if (!d.handles.empty()) check_count(d.handles.size(), 2 * n, "/handles", "two per key", report);
          })
          .build();
  return t;
}

const DefTable& path_table() {
  using D = PathDef;
  static const DefTable t =
      TableOf<D>("places at times, and a curve through them")
          .text("name", &D::name, "letters, digits and _")
          .required()
          .numbers("times", &D::times, "s", any(), {1, kKeys.max}, "of the keys, ascending")
          .required()
          .vectors("points", &D::points, "m", any(), {1, kKeys.max}, "one per key")
          .required()
          .choice("interpolation", &D::interpolation, kInterpolations, "between keys")
          .choice("extend", &D::extend, kExtends, "before the first and after the last key")
          .boolean("even_speed", &D::even_speed,
                   "the curve is run through at one speed from the first key's time to the last one's")
          .check([](const D& d, const DefTable::Report& report) {
            check_times(d.times, report);
            if (d.points.size() != d.times.size()) report("/points", "as many points as times");
          })
          .build();
  return t;
}

const DefTable& vector_table() {
  using D = VectorDef;
  static const DefTable t =
      TableOf<D>("numbers that go from key to key together, each by itself interpolated")
          .text("name", &D::name, "letters, digits and _")
          .required()
          .numbers("times", &D::times, "s", any(), {1, kKeys.max}, "of the keys, ascending")
          .required()
          .numbers("values", &D::values, "1", any(), {1, kKeys.max},
                   "all numbers of the first key, then those of the next; as many per key")
          .required()
          .numbers("slopes_in", &D::slopes_in, "1/s", any(), kKeys,
                   "as many as values, before each key, for hermite and bezier; absent: those of catmull_rom")
          .numbers("slopes_out", &D::slopes_out, "1/s", any(), kKeys, "after each key; absent: slopes_in")
          .numbers("handles", &D::handles, "1", between(0, 1), kKeys,
                   "two per key, for bezier, as those of controls; absent: 1/3")
          .choice("interpolation", &D::interpolation, kInterpolations, "between keys")
          .choice("extend", &D::extend, kExtends, "before the first and after the last key")
          .check([](const D& d, const DefTable::Report& report) {
            check_times(d.times, report);
            const size_t n = d.times.size();
            if (n > 0 && d.values.size() % n != 0) {
              report("/values", std::to_string(n) + " keys with as many numbers each: a multiple of " +
                                    std::to_string(n));
            }
            if (n > 0 && d.values.size() / n > 1000) report("/values", "1000 numbers a key at most");
            if (!d.slopes_in.empty())
              check_count(d.slopes_in.size(), d.values.size(), "/slopes_in", "one per value", report);
            if (!d.slopes_out.empty())
              check_count(d.slopes_out.size(), d.values.size(), "/slopes_out", "one per value", report);
            if (!d.handles.empty()) check_count(d.handles.size(), 2 * n, "/handles", "two per key", report);
          })
          .build();
  return t;
}

const DefTable& turn_table() {
  using D = TurnDef;
  static const DefTable t =
      TableOf<D>("orientations at times")
          .text("name", &D::name, "what joints and bodies call it")
          .required()
          .numbers("times", &D::times, "s", any(), {1, kKeys.max}, "of the keys, ascending")
          .required()
          .numbers("quaternions", &D::quaternions, "1", any(), {4, 4 * kKeys.max},
                   "w, x, y, z per key, of any length but zero")
          .required()
          .choice("interpolation", &D::interpolation, {"step", "nlerp", "slerp", "squad"}, "between keys")
          .choice("extend", &D::extend, kExtends, "before the first and after the last key")
          .check([](const D& d, const DefTable::Report& report) {
            check_times(d.times, report);
            check_count(d.quaternions.size(), 4 * d.times.size(), "/quaternions", "four per key", report);
            for (size_t i = 0; 4 * i + 3 < d.quaternions.size(); ++i) {
              const double* q = &d.quaternions[4 * i];
              if (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] > 0) continue;
              report("/quaternions/" + std::to_string(4 * i), "a quaternion of zeros is no orientation");
            }
          })
          .build();
  return t;
}

}  // namespace truestep::animation
