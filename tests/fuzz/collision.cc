// Two convex solids of any size at any poses, from the bytes: the contact is sane, it exists exactly when GJK
// finds the solids near enough, and the time of impact of a sweep leaves a gap.
#include <cmath>
#include <cstring>

#include "engine/base/errors.h"
#include "engine/collision/pairs/collide.h"
#include "engine/collision/pairs/distance/gjk.h"
#include "engine/collision/queries/time_of_impact.h"
#include "engine/kernels/rigid/free_rotation.h"

using namespace truestep;

namespace {

void need(bool true_here) {
  if (!true_here) __builtin_trap();
}

/// Numbers from the bytes, zeros after their end.
class Bytes {
 public:
  Bytes(const uint8_t* data, size_t size) : data_(data), left_(size) {}
  uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  /// -1 to 1 in steps of 1/32767.
  double unit() {
    const auto high = byte(), low = byte();
    return static_cast<double>(static_cast<int16_t>(high << 8 | low)) / 32768.0;
  }
  /// 0.01 to 10, geometric.
  double size() { return 0.01 * std::pow(10, 3 * 0.5 * (1 + unit())); }
  Vec3 vector() {
    const double x = unit(), y = unit();
    return {x, y, unit()};
  }

 private:
  const uint8_t* data_;
  size_t left_;
};

Solid solid(Bytes& in) {
  switch (in.byte() % 5) {
    case 0:
      return sphere_solid(in.size());
    case 1: {
      const double r = in.size();
      return capsule_solid(r, in.size());
    }
    case 2: {
      const double x = in.size(), y = in.size();
      return box_solid({x, y, in.size()});
    }
    case 3: {
      const double r = in.size();
      return cylinder_solid(r, in.size());
    }
    default: {
      std::vector<Vec3> points(4 + in.byte() % 12);
      const double size = in.size();
      for (Vec3& p : points) p = in.vector() * size;
      return hull_solid(points);
    }
  }
}

double gap(const Solid& a, const Transform& ta, const Solid& b, const Transform& tb) {
  const Convex ca = view(a), cb = view(b);
  return core_distance(ca, cb, relative(ta, tb), ta.inverse_direction(tb.position - ta.position)).distance -
         ca.radius() - cb.radius();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Bytes in(data, size);
  Solid a, b;
  try {
    a = solid(in), b = solid(in);
  } catch (const Error&) {
    return 0;  // points without a volume
  }
  const double scale = bounding_radius(a) + bounding_radius(b);
  const auto pose = [&](const Vec3& at) { return Pose{at * scale, free_rotation::turn(in.vector() * 3.0)}; };
  const Pose pa = pose({}), pb = pose(in.vector());
  const Transform ta = transform_of(pa), tb = transform_of(pb);
  const double margin = 0.1 * scale * std::abs(in.unit());

  Manifold m;
  const bool met = collide(a, ta, b, tb, margin, m);
  const double d = gap(a, ta, b, tb), slack = 1e-3 * scale;
  if (met) {
    need(m.count >= 1 && m.count <= Manifold::kMost);
    need(std::abs(norm(m.normal) - 1) < 1e-9);
    for (int p = 0; p < m.count; ++p) {
      need(m.points[p].separation <= margin + slack && std::isfinite(m.points[p].separation));
      need(norm(m.points[p].position - pa.position) <= 2 * scale + margin);
    }
    need(d <= margin + slack);
    if (d > slack) need(std::abs(-m.deepest() - d) <= slack);
  } else {
    need(d >= margin - slack);
  }

  const auto sweep = [&](const Pose& from) {
    return Sweep{from, in.vector() * (3 * scale), in.vector() * 2.0};
  };
  const Sweep sa = sweep(pa), sb = sweep(pb);
  const double touch = 0.01 * scale;
  if (const auto hit = time_of_impact(a, sa, b, sb, touch)) {
    need(hit->t >= 0 && hit->t <= 1 && std::abs(norm(hit->normal) - 1) < 1e-9);
    if (hit->t > 0) need(gap(a, sa.at(hit->t), b, sb.at(hit->t)) > 0.5 * touch - 1e-6 * scale);
  } else {
    need(gap(a, sa.at(1), b, sb.at(1)) > 0.5 * touch - 1e-6 * scale);
  }
  return 0;
}
