#include "engine/systems/skeleton/recording.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/text/short_number.h"
#include "engine/kernels/animation/rotations.h"

namespace truestep::skeleton {

using namespace animation;

namespace {

/// Files may give one name to several joints: those after the first get a number that no other name has.
void number_names(std::vector<RecordedJoint>& joints) {
  std::set<std::string> given, taken;
  for (const RecordedJoint& j : joints) given.insert(j.name);
  for (RecordedJoint& j : joints) {
    const std::string name = j.name;
    for (int n = 2; !taken.insert(j.name).second; ++n) {
      do {
        j.name = name + "_" + std::to_string(n);
      } while (given.contains(j.name) && ++n);
    }
  }
}

}  // namespace

Recording recording_of(const BvhMotion& m) {
  Recording out;
  out.frames = m.frames, out.frame_time = m.frame_time;
  for (const BvhJoint& j : m.joints) {
    const bool moves = std::ranges::any_of(j.channels, [](BvhChannel c) { return static_cast<int>(c) < 3; });
    out.joints.push_back({j.name, j.parent, j.offset, {}, j.end, moves});
  }
  number_names(out.joints);
  for (size_t f = 0; f < m.frames; ++f) {
    for (size_t j = 0; j < m.joints.size(); ++j) {
      const Pose local = m.local(f, j);
      out.turns.push_back(local.orientation);
      out.shifts.push_back(out.joints[j].moves ? local.position - m.joints[j].offset : Vec3{});
    }
  }
  return out;
}

namespace {

/// Values of a channel at t, clamped to its first and last key.
void sample(const GltfChannel& c, double t, double* out) {
  using B = GltfChannel::Between;
  const auto after = std::ranges::upper_bound(c.times, t);
  const size_t n = c.times.size(), next = std::min(static_cast<size_t>(after - c.times.begin()), n - 1);
  const size_t k = after == c.times.begin() ? 0 : static_cast<size_t>(after - c.times.begin()) - 1;
  const bool cubic = c.between == B::cubic;
  const auto value = [&](size_t key, size_t part) {
    return &c.values[(cubic ? 3 * key + part : key) * c.width];
  };
  const double length = c.times[next] - c.times[k];
  const double u = length > 0 ? std::clamp((t - c.times[k]) / length, 0.0, 1.0) : 0;
  const double *a = value(k, 1), *b = value(next, 1);
  if (c.path == GltfChannel::Path::rotation && c.between == B::linear) {
    const Quat q =
        slerp(normalized(Quat{a[3], a[0], a[1], a[2]}),
              nearer(normalized(Quat{a[3], a[0], a[1], a[2]}), normalized(Quat{b[3], b[0], b[1], b[2]})), u);
    out[0] = q.x, out[1] = q.y, out[2] = q.z, out[3] = q.w;
    return;
  }
  for (size_t i = 0; i < c.width; ++i) {
    if (c.between == B::step) {
      out[i] = u < 1 ? a[i] : b[i];
    } else if (!cubic) {
      out[i] = a[i] + (b[i] - a[i]) * u;
    } else {
      const double u2 = u * u, u3 = u2 * u;
      out[i] = (2 * u3 - 3 * u2 + 1) * a[i] + (u3 - 2 * u2 + u) * length * value(k, 2)[i] +
               (3 * u2 - 2 * u3) * b[i] + (u3 - u2) * length * value(next, 0)[i];
    }
  }
}

/// Exporters write scales with every other channel; one that changes something cannot be followed.
void require_constant_scale(const GltfChannel& c, const GltfNode& node) {
  const size_t row = c.width, step = c.between == GltfChannel::Between::cubic ? 3 : 1;
  for (size_t key = 0; key < c.times.size(); ++key) {
    for (size_t k = 0; k < row; ++k) {
      const double s = c.values[(key * step + (step == 3 ? 1 : 0)) * row + k];
      if (std::abs(s - node.scale) <= 1e-3 * node.scale) continue;
      throw GltfFault("/animations: the scale of node \"" + node.name + "\" becomes " + short_number(s) +
                      " at " + short_number(c.times[key]) + " s; bones keep theirs, " +
                      short_number(node.scale));
    }
  }
}

/// The relevant nodes, parents first.
std::vector<uint32_t> nodes_of(const GltfModel& m, const GltfAnimation* animation) {
  std::vector<uint8_t> wanted(m.nodes.size(), 0);
  if (!m.skins.empty()) {
    for (const uint32_t j : m.skins[0].joints) wanted[j] = 1;
  } else if (animation) {
    for (const GltfChannel& c : animation->channels)
      wanted[c.node] = c.path != GltfChannel::Path::weights || wanted[c.node];
    // Their children mark where bones end.
    for (size_t round = 0, more = 1; more && round < m.nodes.size(); ++round) {
      more = 0;
      for (size_t k = 0; k < m.nodes.size(); ++k) {
        const int32_t p = m.nodes[k].parent;
        if (!wanted[k] && p >= 0 && wanted[static_cast<size_t>(p)]) wanted[k] = 1, more = 1;
      }
    }
  }
  for (size_t k = 0; k < m.nodes.size(); ++k) {
    if (!wanted[k]) continue;
    for (int32_t p = m.nodes[k].parent; p >= 0 && !wanted[static_cast<size_t>(p)];
         p = m.nodes[static_cast<size_t>(p)].parent)
      wanted[static_cast<size_t>(p)] = 1;
  }
  std::vector<uint32_t> out;
  std::vector<size_t> depth(m.nodes.size(), 0);
  for (uint32_t k = 0; k < m.nodes.size(); ++k) {
    for (int32_t p = m.nodes[k].parent; p >= 0; p = m.nodes[static_cast<size_t>(p)].parent) ++depth[k];
    if (wanted[k]) out.push_back(k);
  }
  std::ranges::stable_sort(out, {}, [&](uint32_t k) { return depth[k]; });
  return out;
}

}  // namespace

Recording recording_of(const GltfModel& m, const std::string& name, double rate) {
  const GltfAnimation* animation = nullptr;
  for (const GltfAnimation& a : m.animations) {
    if (!animation && (name.empty() || a.name == name)) animation = &a;
  }
  if (!name.empty() && !animation) throw GltfFault("/animations: none is called \"" + name + "\"");
  if (animation) require_sound(animation->fault);
  if (!m.skins.empty()) require_sound(m.skins[0].fault);
  const std::vector<uint32_t> nodes = nodes_of(m, animation);
  if (nodes.empty()) throw GltfFault("/nodes: the file has neither a skin nor an animation of nodes");
  Recording out;
  out.frame_time = 1 / rate, out.frames = 1;
  std::vector<int32_t> place(m.nodes.size(), -1);
  std::vector<double> scale(m.nodes.size(), 1);  // for everything attached to the node
  for (const uint32_t k : nodes) {
    const GltfNode& node = m.nodes[k];
    require_sound(node.fault);
    const double outer = node.parent < 0 ? 1 : scale[static_cast<size_t>(node.parent)];
    scale[k] = outer * node.scale;
    place[k] = static_cast<int32_t>(out.joints.size());
    out.joints.push_back({node.name, node.parent < 0 ? -1 : place[static_cast<size_t>(node.parent)],
                          node.local.position * outer, node.local.orientation, std::nullopt, false});
  }
  number_names(out.joints);
  double last = 0;
  std::vector<const GltfChannel*> shifted(m.nodes.size()), turned(m.nodes.size());
  if (animation) {
    for (const GltfChannel& c : animation->channels) {
      if (place[c.node] < 0 || c.path == GltfChannel::Path::weights) continue;
      if (c.path == GltfChannel::Path::scale) {
        require_constant_scale(c, m.nodes[c.node]);
        continue;
      }
      (c.path == GltfChannel::Path::rotation ? turned : shifted)[c.node] = &c;
      last = std::max(last, c.times.back());
    }
    constexpr double kMostFrames = 1e6, kMostTurns = 2e7;
    // From time 0, whenever its first key is: what comes before a key is as at that key.
    const double frames = std::round(last * rate) + 1;
    if (frames > kMostFrames || frames * static_cast<double>(nodes.size()) > kMostTurns) {
      throw GltfFault("/animations: it lasts " + std::to_string(last) + " s, which gives too many frames");
    }
    out.frames = static_cast<size_t>(frames);
  }
  for (size_t f = 0; f < out.frames; ++f) {
    const double t = static_cast<double>(f) * out.frame_time;
    for (size_t i = 0; i < nodes.size(); ++i) {
      const uint32_t k = nodes[i];
      RecordedJoint& joint = out.joints[i];
      Quat turn;
      Vec3 shift;
      double x[4];
      if (turned[k]) {
        sample(*turned[k], t, x);
        turn = normalized(conjugate(joint.rest) * normalized(Quat{x[3], x[0], x[1], x[2]}));
      }
      if (shifted[k]) {
        sample(*shifted[k], t, x);
        const double outer = m.nodes[k].parent < 0 ? 1 : scale[static_cast<size_t>(m.nodes[k].parent)];
        shift = rotate(conjugate(joint.rest), Vec3{x[0], x[1], x[2]} * outer - joint.offset);
        joint.moves = true;
      }
      out.turns.push_back(turn), out.shifts.push_back(shift);
    }
  }
  return out;
}

RecordedSkin skin_of(const GltfModel& m, const std::string& animation) {
  const GltfAnimation* first = nullptr;
  for (const GltfAnimation& a : m.animations) {
    if (!first && (animation.empty() || a.name == animation)) first = &a;
  }
  const std::vector<uint32_t> nodes = nodes_of(m, first);
  std::vector<uint32_t> place(m.nodes.size(), 0);
  std::vector<Pose> world(m.nodes.size());
  std::vector<double> scale(m.nodes.size(), 1);
  for (uint32_t i = 0; i < nodes.size(); ++i) {
    const GltfNode& node = m.nodes[nodes[i]];
    place[nodes[i]] = i;
    const bool top = node.parent < 0;
    const Pose above = top ? Pose{} : world[static_cast<size_t>(node.parent)];
    const double outer = top ? 1 : scale[static_cast<size_t>(node.parent)];
    world[nodes[i]] = above * Pose{node.local.position * outer, node.local.orientation};
    scale[nodes[i]] = outer * node.scale;
  }
  RecordedSkin out;
  for (const GltfNode& node : m.nodes) {
    if (node.mesh < 0 || node.skin != 0) continue;
    const GltfMesh& mesh = m.meshes[static_cast<size_t>(node.mesh)];
    const GltfSkin& skin = m.skins[0];
    require_sound(mesh.fault);
    const auto base = static_cast<uint32_t>(out.vertices.size());
    if (mesh.joints.size() != mesh.positions.size()) continue;
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      Vec3 at;
      SkinWeights w;
      for (size_t i = 0; i < kMostBones; ++i) {
        const uint32_t j = mesh.joints[v][i], k = skin.joints[j];
        w.bone[i] = place[k], w.weight[i] = mesh.weights[v][i];
        Vec3 x = mesh.positions[v];
        if (!skin.binds.empty()) {
          const auto& b = skin.binds[j];
          const Vec3 p = x;
          x = {b[0] * p.x + b[4] * p.y + b[8] * p.z + b[12], b[1] * p.x + b[5] * p.y + b[9] * p.z + b[13],
               b[2] * p.x + b[6] * p.y + b[10] * p.z + b[14]};
        }
        at += (world[k].position + rotate(world[k].orientation, x * scale[k])) * w.weight[i];
      }
      out.vertices.push_back(at), out.weights.push_back(w);
    }
    for (auto t : mesh.triangles) {
      for (uint32_t& i : t) i += base;
      out.triangles.push_back(t);
    }
  }
  if (out.vertices.empty()) throw GltfFault("/skins: no mesh follows the first skin");
  return out;
}

}  // namespace truestep::skeleton
