#include "engine/systems/skeleton/model.h"

#include <algorithm>

namespace truestep::skeleton {

using namespace animation;

std::optional<size_t> Model::find(const std::string& id) const {
  const auto at = std::ranges::find(ids, id);
  return at == ids.end() ? std::nullopt : std::optional(static_cast<size_t>(at - ids.begin()));
}

namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& n : names) {
    if (out.size() > 200) return out + " ...";
    out += (out.empty() ? "" : ", ") + n;
  }
  return out;
}

/// The joint of this name, or a fault.
size_t joint_of(const Model& m, const std::string& pointer, const std::string& id, Driver& driver) {
  if (const auto j = m.find(id)) return *j;
  driver.fault({pointer, "unknown_name", "there is no joint \"" + id + "\"", id, listed(m.ids), "", ""});
  return 0;
}

void add_joint(const JointDef& d, const std::string& at, Model& m, Driver& driver) {
  Joint j;
  if (m.find(d.id)) {
    driver.fault({at + "/id", "duplicate_name", "another joint has this name", d.id, "", "", ""});
  }
  if (!d.parent.empty()) {
    const auto parent = m.find(d.parent);
    if (!parent) {
      driver.fault({at + "/parent", "unknown_name", "no earlier joint is called \"" + d.parent + "\"",
                    d.parent, listed(m.ids), "", ""});
    }
    j.parent = static_cast<int32_t>(parent.value_or(0));
  }
  j.kind = d.type;
  j.rest = {d.offset, free_rotation::turn(d.rest_rotation)};
  j.axis = normalized(d.axis);
  if (d.min) j.min = *d.min;
  if (d.max) j.max = *d.max;
  if (d.cone) j.cone = *d.cone;
  JointDrive drive;
  drive.order = d.order;
  if (!d.value.empty()) {
    drive.kind = JointDrive::Kind::value, drive.output = driver.add(at + "/value", d.value);
  } else if (!d.rotation.empty()) {
    drive.kind = JointDrive::Kind::rotation, drive.output = driver.add_vector(at + "/rotation", d.rotation);
  } else if (!d.turn.empty()) {
    drive.kind = JointDrive::Kind::turn, drive.output = driver.turn(at + "/turn", d.turn);
  }
  m.ids.push_back(d.id), m.joints.push_back(j), m.drives.push_back(drive);
}

void add_bones(const SkeletonDef& def, Model& m) {
  for (size_t j = 0; j < m.joints.size(); ++j) {
    const double radius = def.joints[j].radius.value_or(def.bone_radius);
    const auto add = [&](const Vec3& end) {
      if (norm(end) > 1e-9) m.bones.push_back({static_cast<uint32_t>(j), end, radius});
    };
    for (const Joint& child : m.joints) {
      if (child.parent == static_cast<int32_t>(j)) add(child.rest.position);
    }
    if (def.joints[j].end) add(*def.joints[j].end);
  }
}

void add_goal(const SkeletonDef& def, size_t k, Model& m, Driver& driver) {
  const GoalDef& d = def.goals[k];
  const std::string at = "/goals/" + std::to_string(k);
  GoalDrive g;
  g.id = d.id.empty() ? std::to_string(k) : d.id;
  g.goal.joint = static_cast<uint32_t>(joint_of(m, at + "/joint", d.joint, driver));
  if (g.goal.joint >= m.joints.size()) return;
  // The path to the root; fixed joints at its root end are skipped as a base.
  std::vector<uint32_t> way;
  for (auto j = static_cast<int32_t>(g.goal.joint); j >= 0; j = m.joints[static_cast<size_t>(j)].parent) {
    way.push_back(static_cast<uint32_t>(j));
  }
  g.goal.base = way.back();
  for (size_t i = way.size(); i-- > 0 && m.joints[g.goal.base].kind == JointKind::fixed;)
    g.goal.base = way[i];
  if (!d.base.empty()) {
    g.goal.base = static_cast<uint32_t>(joint_of(m, at + "/base", d.base, driver));
    if (std::ranges::find(way, g.goal.base) == way.end()) {
      driver.fault({at + "/base", "unsuitable_joint",
                    "\"" + d.base + "\" is not on the path to \"" + d.joint + "\"", d.base, "", "", ""});
    }
  }
  if (d.point) {
    g.goal.point = *d.point;
  } else if (const auto& end = def.joints[g.goal.joint].end) {
    g.goal.point = *end;
  }
  g.goal.weight = d.weight, g.goal.orientation_weight = d.orientation_weight, g.goal.priority = d.priority;
  g.target = driver.add_vector(at + "/target", d.target);
  g.has_orientation = !d.orientation.empty(), g.has_pole = !d.pole.empty();
  g.orientation = driver.add_vector(at + "/orientation", d.orientation);
  g.pole = driver.add_vector(at + "/pole", d.pole);
  if (def.solver == IkMethod::two_link && g.goal.base == g.goal.joint) {
    driver.fault(
        {at + "/base", "unsuitable_joint", "two_link needs a base and one joint after it", "", "", "", ""});
  }
  m.goals.push_back(std::move(g));
}

}  // namespace

Model build_model(const SkeletonDef& def, Driver& driver) {
  Model m;
  for (size_t j = 0; j < def.joints.size(); ++j) {
    add_joint(def.joints[j], "/joints/" + std::to_string(j), m, driver);
  }
  m.root_position = driver.add_vector("/root_position", def.root_position);
  m.root_rotation = driver.add_vector("/root_rotation", def.root_rotation);
  m.root_order = def.root_order;
  add_bones(def, m);
  for (size_t k = 0; k < def.goals.size() && !m.joints.empty(); ++k) add_goal(def, k, m, driver);
  m.rest.resize(m.joints.size());
  const std::vector<JointMotion> still(m.joints.size());
  forward_kinematics(m.joints, still, {}, m.rest);
  return m;
}

namespace {

/// Joints from one to another, or a fault.
std::vector<uint32_t> chain(const TubeDef& t, const std::string& at, const Model& m, Driver& driver) {
  const size_t from = joint_of(m, at + "/from", t.from, driver);
  const size_t to = t.to.empty() ? from : joint_of(m, at + "/to", t.to, driver);
  std::vector<uint32_t> way;
  for (auto j = static_cast<int32_t>(to); j >= static_cast<int32_t>(from);
       j = m.joints[static_cast<size_t>(j)].parent) {
    way.push_back(static_cast<uint32_t>(j));
  }
  std::ranges::reverse(way);
  if (way.empty() || way[0] != from) {
    driver.fault({at + "/to", "unsuitable_joint", "\"" + t.to + "\" does not come after \"" + t.from + "\"",
                  t.to, "", "", ""});
    return {};
  }
  return way;
}

void weigh(Model& m, const std::vector<BoneSegment>& segments, const std::vector<uint32_t>& joint_of_segment,
           double falloff, size_t first) {
  for (size_t i = first; i < m.skin.size(); ++i) {
    SkinWeights w = weights_by_distance(segments, m.skin[i], falloff);
    for (uint32_t& b : w.bone) b = joint_of_segment[b];
    m.weights.push_back(w);
  }
}

void add_tube(const TubeDef& t, const std::string& at, double falloff, Model& m, Driver& driver) {
  const std::vector<uint32_t> way = chain(t, at, m, driver);
  if (way.empty()) return;
  std::vector<Vec3> line;
  for (const uint32_t j : way) line.push_back(m.rest[j].position);
  for (const Bone& b : m.bones) {
    if (b.joint != way.back()) continue;
    line.push_back(m.rest[b.joint].position + rotate(m.rest[b.joint].orientation, b.end));
    break;
  }
  std::vector<BoneSegment> segments;
  std::vector<uint32_t> joint_of_segment;
  double total = 0;
  for (size_t k = 0; k + 1 < line.size(); ++k) {
    segments.push_back({line[k], line[k + 1]}), joint_of_segment.push_back(way[k]);
    total += norm(line[k + 1] - line[k]);
  }
  if (!(total > 0)) {
    driver.fault(
        {at + "/from", "unsuitable_joint", "there is no bone to put a skin around", t.from, "", "", ""});
    return;
  }
  const size_t first = m.skin.size();
  const auto around = static_cast<uint32_t>(t.around), rings = static_cast<uint32_t>(t.rings);
  Vec3 side = normalized(line[1] - line[0]);
  side = normalized(std::abs(side.z) < 0.9 ? cross(side, Vec3{0, 0, 1}) : cross(side, Vec3{1, 0, 0}));
  m.skin.push_back(line.front());
  for (uint32_t r = 0; r < rings; ++r) {
    const double share = static_cast<double>(r) / (rings - 1);
    double s = share * total;
    size_t k = 0;
    while (k + 2 < line.size() && s > norm(line[k + 1] - line[k])) s -= norm(line[k + 1] - line[k]), ++k;
    const Vec3 u = normalized(line[k + 1] - line[k]);
    side = normalized(side - u * dot(u, side), side);
    const Vec3 up = cross(u, side);
    // Rounded at both ends, over a length equal to the radius there.
    const double end_radius = t.end_radius.value_or(t.radius);
    double radius = t.radius + share * (end_radius - t.radius);
    const double from_end = std::min(share, 1 - share) * total, round = std::min(radius, 0.5 * total);
    if (from_end < round) {
      const double x = 1 - from_end / round;
      radius *= std::max(0.35, std::sqrt(std::max(0.0, 1 - x * x)));
    }
    for (uint32_t a = 0; a < around; ++a) {
      const auto [sin, cos] = trig::sincos(6.283185307179586 * a / around);
      m.skin.push_back(line[k] + u * s + (side * cos + up * sin) * radius);
    }
  }
  m.skin.push_back(line.back());
  const auto base = static_cast<uint32_t>(first), last = static_cast<uint32_t>(m.skin.size() - 1);
  const auto vertex = [&](uint32_t ring, uint32_t a) { return base + 1 + ring * around + a % around; };
  for (uint32_t a = 0; a < around; ++a) {
    m.triangles.push_back({base, vertex(0, a + 1), vertex(0, a)});
    for (uint32_t r = 0; r + 1 < rings; ++r) {
      m.triangles.push_back({vertex(r, a), vertex(r, a + 1), vertex(r + 1, a)});
      m.triangles.push_back({vertex(r, a + 1), vertex(r + 1, a + 1), vertex(r + 1, a)});
    }
    m.triangles.push_back({vertex(rings - 1, a), vertex(rings - 1, a + 1), last});
  }
  weigh(m, segments, joint_of_segment, falloff, first);
}

}  // namespace

void build_skin(const SkinDef& def, Model& m, Driver& driver) {
  for (size_t k = 0; k < def.tubes.size(); ++k) {
    add_tube(def.tubes[k], "/skin/tubes/" + std::to_string(k), def.falloff, m, driver);
  }
  const size_t first = m.skin.size();
  m.skin.insert(m.skin.end(), def.vertices.begin(), def.vertices.end());
  for (size_t k = 0; k + 2 < def.triangles.size(); k += 3) {
    std::array<uint32_t, 3> t;
    for (size_t i = 0; i < 3; ++i)
      t[i] = static_cast<uint32_t>(first + static_cast<size_t>(def.triangles[k + i]));
    m.triangles.push_back(t);
  }
  if (def.vertices.empty()) return;
  if (!def.file_weights.empty()) {
    m.weights.insert(m.weights.end(), def.file_weights.begin(), def.file_weights.end());
    return;
  }
  std::vector<BoneSegment> segments;
  std::vector<uint32_t> joint_of_segment;
  for (const Bone& b : m.bones) {
    const Pose& p = m.rest[b.joint];
    segments.push_back({p.position, p.position + rotate(p.orientation, b.end)});
    joint_of_segment.push_back(b.joint);
  }
  if (segments.empty()) {
    driver.fault(
        {"/skin/vertices", "no_bones", "there is no bone that the skin could follow", "", "", "", ""});
    return;
  }
  weigh(m, segments, joint_of_segment, def.falloff, first);
}

}  // namespace truestep::skeleton
