#include "engine/systems/skeleton/clip.h"

#include <algorithm>
#include <cmath>

namespace truestep::skeleton {

using namespace animation;

std::optional<Recording> read_recording(const MotionDef& def, const std::string& where) {
  if (def.markers) return std::nullopt;
  const auto refuse = [](const std::string& at, const char* code, const std::string& why) {
    throw Error("scene_invalid", why, {at, code, why, "", "", "", ""});
  };
  try {
    if (def.gltf.empty()) return recording_of(read_bvh(def.bvh));
    return recording_of(read_gltf(def.gltf), def.animation, def.rate);
  } catch (const BvhFault& f) {
    refuse(where + "/bvh/" + std::to_string(std::min(f.line, def.bvh.size()) - 1), "bad_bvh", f.what());
  } catch (const GltfFault& f) {
    refuse(where + "/gltf", "bad_gltf", f.what());
  }
  return std::nullopt;
}

namespace {

void take_skin(const MotionDef& motion, SkinDef& skin) {
  try {
    const RecordedSkin s = skin_of(read_gltf(motion.gltf), motion.animation);
    for (const Vec3& x : s.vertices) skin.vertices.push_back(x * motion.scale);
    for (const auto& t : s.triangles) skin.triangles.insert(skin.triangles.end(), t.begin(), t.end());
    skin.file_weights = s.weights;
  } catch (const GltfFault& f) {
    throw Error("scene_invalid", f.what(), {"/motion/gltf", "bad_gltf", f.what(), "", "", "", ""});
  }
}

}  // namespace

SkeletonDef with_file(SkeletonDef def, std::optional<Recording>& file) {
  if (!def.motion) return def;
  file = read_recording(*def.motion, "/motion");
  if (!file || !def.joints.empty()) return def;
  for (const RecordedJoint& b : file->joints) {
    JointDef j;
    j.id = b.name;
    if (b.parent >= 0) j.parent = def.joints[static_cast<size_t>(b.parent)].id;
    // The root's position comes from its channels alone.
    j.offset = b.offset * def.motion->scale;
    j.rest_rotation = free_rotation::rotation_vector(b.rest);
    if (b.end) j.end = *b.end * def.motion->scale;
    def.joints.push_back(std::move(j));
  }
  if (def.skin && def.skin->source == SkinDef::Source::motion_file) take_skin(*def.motion, *def.skin);
  return def;
}

namespace {

/// m, summed over all bones.
double size_of(const auto& joints, auto&& offset_of) {
  double sum = 0;
  for (const auto& j : joints) {
    if (j.parent >= 0) sum += norm(offset_of(j));
  }
  return sum;
}

double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

}  // namespace

Clip::Clip(const MotionDef& def, const Recording& file, const Model& model, Driver& driver,
           const std::string& where)
    : frames_(file.frames), frame_time_(file.frame_time), extend_(def.extend) {
  const double theirs = def.scale * size_of(file.joints, [](const RecordedJoint& j) { return j.offset; });
  const double ours = size_of(model.joints, [](const Joint& j) { return j.rest.position; });
  const double ratio = def.root_scale.value_or(theirs > 0 && ours > 0 ? ours / theirs : 1);
  std::vector<std::string> names;
  for (const RecordedJoint& b : file.joints) names.push_back(b.name);
  for (const NamedText& n : def.names) {
    if (std::ranges::find(names, n.name) == names.end()) {
      driver.fault({where + "/names/" + n.name, "unknown_name", "the file has no joint \"" + n.name + "\"",
                    n.name, "", "", ""});
    }
    if (!model.find(n.text)) {
      driver.fault({where + "/names/" + n.name, "unknown_name", "there is no joint \"" + n.text + "\"",
                    n.text, "", "", ""});
    }
  }
  for (size_t b = 0; b < file.joints.size(); ++b) {
    std::string to = file.joints[b].name;
    if (!def.names.empty()) {
      const auto n = std::ranges::find(def.names, to, &NamedText::name);
      if (n == def.names.end()) continue;
      to = n->text;
    }
    const auto joint = model.find(to);
    if (!joint) continue;
    const bool ball = model.joints[*joint].kind == JointKind::ball;
    if (!ball && (file.values.empty() || model.joints[*joint].kind == JointKind::fixed)) continue;
    Track t;
    t.joint = static_cast<uint32_t>(*joint);
    for (size_t f = 0; f < frames_; ++f) {
      const size_t row = f * file.joints.size() + b;
      if (ball) {
        t.turns.push_back(f > 0 ? nearer(t.turns.back(), file.turns[row]) : file.turns[row]);
      } else {
        t.values.push_back(file.values[row]);
      }
      if (file.joints[b].moves) t.shifts.push_back(file.shifts[row] * (def.scale * ratio));
    }
    tracks_.push_back(std::move(t));
  }
  if (tracks_.empty()) {
    driver.fault({where + "/names", "unknown_name",
                  "no joint of the file is mapped to a ball joint of this skeleton", "",
                  "\"names\": {\"joint of the file\": \"joint of this skeleton\"}", "", ""});
    return;
  }
  if (def.smoothing > 0) smooth(def.smoothing / frame_time_);
  if (!def.foot_lock) return;
  std::vector<uint32_t> feet;
  for (size_t k = 0; k < def.foot_lock->joints.size(); ++k) {
    const std::string& id = def.foot_lock->joints[k];
    const auto j = model.find(id);
    if (!j || model.joints[*j].parent < 0) {
      driver.fault({where + "/foot_lock/joints/" + std::to_string(k), "unknown_name",
                    "there is no joint \"" + id + "\" with bones above it", id, "", "", ""});
      continue;
    }
    feet.push_back(static_cast<uint32_t>(*j));
  }
  find_contacts(*def.foot_lock, model, feet);
}

void Clip::smooth(double width) {
  // Weights reach to three widths; beyond the ends the motion stands still or wraps around its loop.
  const auto reach = static_cast<int64_t>(std::ceil(3 * width));
  const auto n = static_cast<int64_t>(frames_);
  const auto frame = [&](int64_t f) {
    if (extend_ == Extend::loop && n > 1) return static_cast<size_t>(((f % (n - 1)) + n - 1) % (n - 1));
    return static_cast<size_t>(std::clamp<int64_t>(f, 0, n - 1));
  };
  for (Track& t : tracks_) {
    const std::vector<Quat> turns = t.turns;
    const std::vector<Vec3> shifts = t.shifts;
    const std::vector<double> values = t.values;
    for (int64_t f = 0; f < n; ++f) {
      const Quat here = turns.empty() ? Quat{} : turns[static_cast<size_t>(f)];
      double value = 0;
      Quat sum{0, 0, 0, 0};
      Vec3 place;
      double weights = 0;
      for (int64_t k = -reach; k <= reach; ++k) {
        const double x = static_cast<double>(k) / width, w = trig::exp(-0.5 * x * x);
        const Quat q = turns.empty() ? here : nearer(here, turns[frame(f + k)]);
        if (!values.empty()) value += w * values[frame(f + k)];
        sum = {sum.w + w * q.w, sum.x + w * q.x, sum.y + w * q.y, sum.z + w * q.z};
        // A loop may travel: only the deviation from the line between its first and last frame is smoothed.
        if (!shifts.empty()) {
          const auto line = [&](int64_t i) {
            return shifts.front() + (shifts.back() - shifts.front()) *
                                        (n > 1 ? static_cast<double>(i) / static_cast<double>(n - 1) : 0);
          };
          const auto at = static_cast<int64_t>(frame(f + k));
          place += (shifts[static_cast<size_t>(at)] - line(at) + line(f)) * w;
        }
        weights += w;
      }
      if (!turns.empty()) t.turns[static_cast<size_t>(f)] = normalized(sum);
      if (!values.empty()) t.values[static_cast<size_t>(f)] = value / weights;
      if (!shifts.empty()) t.shifts[static_cast<size_t>(f)] = place / weights;
    }
  }
}

void Clip::find_contacts(const FootLockDef& def, const Model& model, const std::vector<uint32_t>& feet) {
  std::vector<std::vector<Vec3>> places(feet.size());
  std::vector<JointMotion> motion(model.joints.size());
  std::vector<Pose> poses(model.joints.size());
  for (size_t f = 0; f < frames_; ++f) {
    pose(static_cast<double>(f) * frame_time_, motion);
    // The last frame of a loop equals the first.
    if (f + 1 == frames_) {
      frame(f, motion);
    }
    forward_kinematics(model.joints, motion, {}, poses);
    for (size_t k = 0; k < feet.size(); ++k) places[k].push_back(poses[feet[k]].position);
  }
  for (size_t k = 0; k < feet.size(); ++k) {
    Foot foot;
    foot.joint = feet[k];
    foot.base = static_cast<uint32_t>(model.joints[feet[k]].parent);
    const int32_t above = model.joints[foot.base].parent;
    if (above >= 0) foot.base = static_cast<uint32_t>(above);
    foot.moves.assign(frames_, {});
    const auto& x = places[k];
    const auto stands = [&](size_t f) {
      const size_t a = f > 0 ? f - 1 : 0, b = std::min(f + 1, frames_ - 1);
      const double speed = b > a ? norm(x[b] - x[a]) / (static_cast<double>(b - a) * frame_time_) : 0;
      return x[f].y < def.height && speed < def.speed;
    };
    const double blend = std::max(def.blend / frame_time_, 1e-9);
    std::vector<double> strength(frames_, 0);
    for (size_t f = 0; f < frames_;) {
      if (!stands(f)) {
        ++f;
        continue;
      }
      size_t end = f;
      Vec3 mean;
      while (end < frames_ && stands(end)) mean += x[end++];
      mean = mean / static_cast<double>(end - f);
      for (size_t i = f; i < end; ++i) slide_ = std::max(slide_, norm(x[i] - x[f]));
      for (size_t i = 0; i < frames_; ++i) {
        const double off = i < f      ? static_cast<double>(f - i)
                           : i >= end ? static_cast<double>(i - end + 1)
                                      : 0;
        const double s = off == 0 ? 1 : smooth_step(1 - off / (blend + 1));
        // Held inside a stance; near one, the offset of its nearest frame fades out.
        if (s <= strength[i]) continue;
        const size_t edge = std::clamp(i, f, end - 1);
        strength[i] = s, foot.moves[i] = (mean - x[edge]) * s;
      }
      f = end;
    }
    feet_.push_back(std::move(foot));
  }
}

Clip::Between Clip::between(double at) const {
  const double last = static_cast<double>(frames_ - 1) * frame_time_;
  const double place = within(at, 0, last, extend_).t / frame_time_;
  const auto frame = std::min(static_cast<size_t>(place), frames_ - 1);
  return {frame, frame + 1 < frames_ ? place - static_cast<double>(frame) : 0};
}

void Clip::pose(double t, std::span<JointMotion> motion) const {
  for (const Track& track : tracks_) pose_of(track, t, motion[track.joint]);
}

void Clip::pose_of(const Track& track, double t, JointMotion& m) const {
  const auto [f, share] = between(t);
  const size_t next = share > 0 ? f + 1 : f;
  if (!track.turns.empty()) m.turn = slerp(track.turns[f], track.turns[next], share);
  if (!track.values.empty()) m.value = track.values[f] + (track.values[next] - track.values[f]) * share;
  if (track.shifts.empty()) return;
  // A loop whose root travels continues from where it was.
  const double last = static_cast<double>(frames_ - 1) * frame_time_;
  const double rounds = extend_ == Extend::loop && last > 0 ? std::floor(t / last) : 0;
  Vec3 travel = (track.shifts.back() - track.shifts.front()) * rounds;
  travel.y = 0;
  m.shift = track.shifts[f] + (track.shifts[next] - track.shifts[f]) * share + travel;
}

void Clip::blend(double t, double share, LayerDef::Mode mode, std::span<JointMotion> motion) const {
  const bool adds = mode == LayerDef::Mode::additive;
  for (const Track& track : tracks_) {
    JointMotion& m = motion[track.joint];
    JointMotion own = m;
    pose_of(track, t, own);
    if (!track.turns.empty()) {
      const Quat way = adds ? conjugate(track.turns[0]) * own.turn : conjugate(m.turn) * own.turn;
      m.turn = normalized(m.turn * slerp({}, nearer({}, way), share));
    }
    if (!track.values.empty()) m.value += share * (own.value - (adds ? track.values[0] : m.value));
    if (!track.shifts.empty()) m.shift += (own.shift - (adds ? track.shifts[0] : m.shift)) * share;
  }
}

void Clip::frame(size_t f, std::span<JointMotion> motion) const {
  for (const Track& t : tracks_) {
    if (!t.turns.empty()) motion[t.joint].turn = t.turns[f];
    if (!t.values.empty()) motion[t.joint].value = t.values[f];
    if (!t.shifts.empty()) motion[t.joint].shift = t.shifts[f];
  }
}

void Clip::mark(std::span<uint8_t> known) const {
  for (const Track& t : tracks_) known[t.joint] = 1;
}

Clip::Hold Clip::hold(size_t k, double t) const {
  const auto [f, share] = between(t);
  const Foot& foot = feet_[k];
  const size_t next = share > 0 ? f + 1 : f;
  return {foot.joint, foot.base, foot.moves[f] + (foot.moves[next] - foot.moves[f]) * share};
}

}  // namespace truestep::skeleton
