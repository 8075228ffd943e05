#include "engine/systems/xpbd/rods/rod_set.h"

#include <algorithm>

#include "engine/math/trig.h"

namespace truestep::xpbd {

namespace {

constexpr double kPi = 3.14159265358979323846;

/// Frame with d3 along `direction` and d2 as close to `up` as possible.
Quat frame_of(const Vec3& direction, const Vec3& up) {
  const Vec3 d3 = normalized(direction);
  Vec3 d2 = up - d3 * dot(d3, up);
  if (!(norm(d2) > 1e-6 * norm(up))) {
    const Vec3 other = std::abs(d3.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
    d2 = other - d3 * dot(d3, other);
  }
  d2 = normalized(d2);
  // First e3 to d3, then about d3.
  const Quat q = rotation_between({0, 0, 1}, d3);
  const Vec3 e2 = rotation(q).apply({0, 1, 0});
  if (dot(e2, d2) < -1 + 1e-9) return normalized(Quat{0, d3.x, d3.y, d3.z} * q);
  return normalized(rotation_between(e2, d2) * q);
}

/// q turned by `angle` (rad) about its own d3.
Quat twisted(const Quat& q, double angle) {
  const auto [s, c] = trig::sincos(0.5 * angle);
  return normalized(q * Quat{c, 0, 0, s});
}

}  // namespace

Section section_of(const RodDef& rod, double thickness) {
  Section s;
  if (rod.width) {
    const double w = *rod.width, h = *rod.height, a = std::max(w, h), b = std::min(w, h), r = b / a;
    s = {w * h, 5.0 / 6 * w * h, w * h * h * h / 12, h * w * w * w / 12,
         a * b * b * b * (1.0 / 3 - 0.21 * r * (1 - r * r * r * r / 12))};
  } else {
    const double d2 = thickness * thickness, bend = kPi / 64 * d2 * d2;
    s = {kPi / 4 * d2, 0.9 * kPi / 4 * d2, bend, bend, 2 * bend};
  }
  if (rod.torsion_constant) s.torsion = *rod.torsion_constant;
  return s;
}

RodSet build_rods(const XpbdDef& def, const std::vector<Vec3>& x, size_t links, double link_mass) {
  const RodDef& rod = *def.rod;
  RodSet out;
  out.links = links, out.rods = x.size() / (links + 1);
  out.section = section_of(rod, def.thickness);
  out.youngs_modulus = rod.youngs_modulus;
  out.shear_modulus = rod.shear_modulus.value_or(0.5 * rod.youngs_modulus / (1 + rod.poisson_ratio));
  out.damping_time = rod.damping_time, out.twist_rate = rod.twist_rate;
  out.clamped_first = def.hair.has_value();
  for (const std::string& name : rod.clamped) {
    out.clamped_first |= name == "first" || name == "ends";
    out.clamped_last |= name == "last" || name == "ends";
  }
  const Section& a = out.section;
  const Vec3 inertia = Vec3{a.bend1, a.bend2, a.bend1 + a.bend2} * (link_mass / a.area);
  for (size_t r = 0; r < out.rods; ++r) {
    const Vec3* p = x.data() + out.first_point(r);
    double whole = 0;
    for (size_t j = 0; j < links; ++j) {
      out.length.push_back(def.rest_scale * norm(p[j + 1] - p[j])), out.inertia.push_back(inertia);
      whole += out.length.back();
    }
    // Twist-free frames: each is the one before, turned by the smallest rotation that aligns it with its
    // link.
    std::vector<Quat> q(links + 2);
    q[1] = frame_of(p[1] - p[0], rod.up);
    for (size_t j = 1; j < links; ++j) {
      const Vec3 from = rotation(q[j]).apply({0, 0, 1}), to = normalized(p[j + 1] - p[j], from);
      q[j + 1] = normalized(rotation_between(from, to) * q[j]);
    }
    // The wall frames continue the bend of the first and last joint.
    q[0] = q[1], q[links + 1] = q[links];
    if (links > 1) {
      const Quat first = turn_between(q[1], q[2]), last = turn_between(q[links - 1], q[links]);
      const Quat back = nlerp({}, {first.w, -first.x, -first.y, -first.z}, 0.5);
      q[0] = normalized(q[1] * back), q[links + 1] = normalized(q[links] * nlerp({}, last, 0.5));
    }
    for (size_t j = 0; j <= links; ++j) {
      const bool shaped = rod.natural == RodDef::Natural::as_shaped;
      out.rest.push_back(shaped ? bend_and_twist(q[j], q[j + 1], out.joint_length(r, j)) : Vec3{});
    }
    double along = 0;
    for (size_t j = 0; j <= links + 1; ++j) {
      const double l = j >= 1 && j <= links ? out.length[r * links + j - 1] : 0;
      out.frames.push_back(twisted(q[j], rod.twist * (along + 0.5 * l) / whole));
      along += l;
    }
  }
  return out;
}

}  // namespace truestep::xpbd
