#include "engine/sinks/motion/motion_export.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/core/ports/morph_port.h"
#include "engine/core/ports/rig_port.h"
#include "engine/geometry/read/bvh.h"
#include "engine/math/trig.h"

namespace truestep {

using animation::conjugate;
using animation::nearer;
using animation::rotate;

MotionExport::MotionExport(const System& system, std::string name, double rate)
    : system_(system), name_(std::move(name)), rate_(rate) {
  if (!suits(system)) {
    throw Error("unsuitable_system", "\"" + name_ + "\" has neither joints nor blended shapes",
                {"/system", "unsuitable_system", "the system has neither joints nor blended shapes", name_,
                 "a skeleton or blend_shapes", "", ""});
  }
}

bool MotionExport::suits(const System& system) {
  return system.ports().rig || system.ports().morph;
}

size_t MotionExport::rows(const System& system) {
  if (const auto rig = rig_of(system)) return rig->joints.size();
  return 1 + system.ports().morph->morph().targets.size();
}

void MotionExport::add(const State& state, double t) {
  ++frames_;
  if (const auto rig = rig_of(system_)) {
    const size_t n = rig->joints.size();
    const auto x = state.f64(rig->position), q = state.f64(rig->orientation);
    const auto pose = [&](size_t j) {
      return Pose{load3(x.data(), j), {q[4 * j], q[4 * j + 1], q[4 * j + 2], q[4 * j + 3]}};
    };
    for (size_t j = 0; j < n; ++j) {
      const int32_t p = rig->joints[j].parent;
      const Pose here = pose(j), above = p < 0 ? Pose{} : pose(static_cast<size_t>(p));
      const Quat back = conjugate(above.orientation);
      Pose local{rotate(back, here.position - above.position), normalized(back * here.orientation)};
      // Keeps the sign from frame to frame, so that interpolation takes the short way.
      if (frames_ > 1) local.orientation = nearer(locals_[locals_.size() - n].orientation, local.orientation);
      locals_.push_back(local);
    }
    return;
  }
  const Morphed& morphed = *system_.ports().morph;
  const size_t first = weights_.size();
  weights_.resize(first + morphed.morph().targets.size());
  locals_.push_back(morphed.morph_at(state, t, std::span(weights_).subspan(first)));
}

namespace {

/// Angles (degrees) of q = Rz(a) Rx(b) Ry(c); at b = +-90 degrees c is 0.
void zxy_angles(const Quat& q, double* out) {
  constexpr double kDegrees = 57.29577951308232;
  const Rotation r = rotation(q);
  const Vec3 x = r.apply({1, 0, 0}), y = r.apply({0, 1, 0}), z = r.apply({0, 0, 1});
  // R = Rz Rx Ry: row z is (-cb sc, sb, cb cc), column y is (-sa cb, ca cb, sb).
  const double sine = std::clamp(y.z, -1.0, 1.0), cosine = std::sqrt(x.z * x.z + z.z * z.z);
  out[1] = kDegrees * trig::atan2(sine, cosine);
  if (cosine > 1e-9) {
    out[0] = kDegrees * trig::atan2(-y.x, y.y);
    out[2] = kDegrees * trig::atan2(-x.z, z.z);
  } else {
    out[0] = kDegrees * trig::atan2(x.y, x.x), out[2] = 0;
  }
}

}  // namespace

std::string MotionExport::bvh() const {
  const auto rig = rig_of(system_);
  if (!rig)
    throw Error("unsuitable_system", "\"" + name_ + "\" has no joints, and BVH files contain only joints");
  const size_t n = rig->joints.size();
  BvhMotion m;
  m.frames = frames_, m.frame_time = 1 / rate_;
  size_t roots = 0;
  for (const auto& j : rig->joints) roots += j.parent < 0;
  if (roots != 1)
    throw Error("unsuitable_system",
                "BVH files contain skeletons with one root; this one has " + std::to_string(roots));
  std::vector<uint8_t> has_child(n, 0);
  for (const auto& j : rig->joints) {
    if (j.parent >= 0) has_child[static_cast<size_t>(j.parent)] = 1;
  }
  for (size_t j = 0; j < n; ++j) {
    BvhJoint b;
    b.name = rig->names[j];
    for (char& c : b.name) {
      if (c == ' ' || c == '\t' || c == '{' || c == '}' || c == '\n') c = '_';
    }
    b.parent = rig->joints[j].parent;
    b.offset = b.parent < 0 ? Vec3{} : rig->joints[j].rest.position;
    using enum BvhChannel;
    bool moves = b.parent < 0;
    for (size_t f = 0; f < frames_ && !moves; ++f)
      moves = norm(locals_[f * n + j].position - b.offset) > 1e-9;
    if (moves) b.channels = {x_position, y_position, z_position};
    for (const BvhChannel c : {z_rotation, x_rotation, y_rotation}) b.channels.push_back(c);
    b.first_channel = m.channels, m.channels += b.channels.size();
    if (!has_child[j]) {
      b.end = Vec3{};
      for (size_t k = 0; k < rig->joint_of_bone.size(); ++k) {
        if (rig->joint_of_bone[k] == j) b.end = rig->bone_in_joint[k].position * 2.0;
      }
    }
    m.joints.push_back(std::move(b));
  }
  for (size_t f = 0; f < frames_; ++f) {
    for (size_t j = 0; j < n; ++j) {
      const Pose& p = locals_[f * n + j];
      if (m.joints[j].channels.size() == 6)
        m.values.insert(m.values.end(), {p.position.x, p.position.y, p.position.z});
      double angles[3];
      zxy_angles(p.orientation, angles);
      m.values.insert(m.values.end(), angles, angles + 3);
    }
  }
  return write_bvh(m);
}

}  // namespace truestep
