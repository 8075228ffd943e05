#include "engine/geometry/read/gltf/nodes.h"

#include <cmath>

namespace truestep::gltf {

namespace {

constexpr size_t kMostNodes = 100'000;

/// x, y, z, w of the rotation with these columns, by its largest component (Shepperd 1978).
void rotation_of(const Vec3* c, double* q) {
  const double xx = c[0].x, yy = c[1].y, zz = c[2].z, trace = xx + yy + zz;
  const double four[] = {1 + 2 * xx - trace, 1 + 2 * yy - trace, 1 + 2 * zz - trace, 1 + trace};
  size_t k = 0;
  for (size_t i = 1; i < 4; ++i) {
    if (four[i] > four[k]) k = i;
  }
  const double a = std::sqrt(four[k]), f = 0.5 / a;
  const double yz = c[1].z - c[2].y, zx = c[2].x - c[0].z, xy = c[0].y - c[1].x;
  const double sxy = c[0].y + c[1].x, szx = c[2].x + c[0].z, syz = c[1].z + c[2].y;
  const double all[4][4] = {{0, sxy, szx, yz}, {sxy, 0, syz, zx}, {szx, syz, 0, xy}, {yz, zx, xy, 0}};
  for (size_t i = 0; i < 4; ++i) q[i] = i == k ? 0.5 * a : all[k][i] * f;
}

void place(const Value& v, GltfNode& node) {
  double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
  const auto take = [&](const char* name, double* out, size_t count) {
    const Value a = v.member(name);
    if (!a.there()) return false;
    if (a.size() != count) fail(a.where(), "must have " + std::to_string(count) + " numbers");
    for (size_t k = 0; k < count; ++k) out[k] = a[k].number();
    return true;
  };
  double m[16];
  if (take("matrix", m, 16)) {
    Vec3 axis[3];
    for (size_t k = 0; k < 3; ++k) {
      axis[k] = {m[4 * k], m[4 * k + 1], m[4 * k + 2]};
      s[k] = norm(axis[k]);
      if (!(s[k] > 0)) fail(v.where() + "/matrix", "is singular");
      axis[k] = axis[k] / s[k];
    }
    const double skew =
        std::abs(dot(axis[0], axis[1])) + std::abs(dot(axis[0], axis[2])) + std::abs(dot(axis[1], axis[2]));
    if (skew > 1e-3 || dot(cross(axis[0], axis[1]), axis[2]) < 0)
      fail(v.where() + "/matrix", "shears or mirrors");
    rotation_of(axis, q);
    for (size_t k = 0; k < 3; ++k) t[k] = m[12 + k];
  } else {
    take("translation", t, 3), take("rotation", q, 4), take("scale", s, 3);
  }
  if (!(s[0] > 0) || std::abs(s[1] - s[0]) > 1e-3 * s[0] || std::abs(s[2] - s[0]) > 1e-3 * s[0]) {
    fail(v.where() + "/scale", "must be the same in all directions");
  }
  const Quat turn{q[3], q[0], q[1], q[2]};
  const double length = std::sqrt(turn.w * turn.w + turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
  if (!(length > 1e-6)) fail(v.where() + "/rotation", "is not a rotation");
  node.local = {{t[0], t[1], t[2]}, normalized(turn)};
  node.scale = s[0];
}

}  // namespace

std::vector<GltfNode> read_nodes(const Value& document) {
  std::vector<GltfNode> all;
  const Value nodes = document.member("nodes");
  const size_t n = nodes.size();
  if (n > kMostNodes) fail("/nodes", "there are more than " + std::to_string(kMostNodes));
  all.resize(n);
  for (size_t k = 0; k < n; ++k) {
    GltfNode& node = all[k];
    node.name = nodes[k].member("name").text_or("node" + std::to_string(k));
    try {
      place(nodes[k], node);
    } catch (const GltfFault& f) {
      node.fault = f.what();
    }
    const Value children = nodes[k].member("children");
    for (size_t c = 0; c < children.size(); ++c) {
      GltfNode& child = all[children[c].index(n, "node")];
      if (child.parent >= 0) fail(children[c].where(), "the node already has a parent");
      child.parent = static_cast<int32_t>(k);
    }
  }
  // Every node has at most one parent, so a chain of parents longer than the number of nodes is a cycle.
  std::vector<uint8_t> sound(n, 0);
  for (size_t k = 0; k < n; ++k) {
    size_t steps = 0;
    for (auto j = static_cast<int32_t>(k); j >= 0 && !sound[static_cast<size_t>(j)];
         j = all[static_cast<size_t>(j)].parent) {
      if (++steps > n) fail("/nodes/" + std::to_string(k), "is its own ancestor");
    }
    for (auto j = static_cast<int32_t>(k); j >= 0 && !sound[static_cast<size_t>(j)];
         j = all[static_cast<size_t>(j)].parent) {
      sound[static_cast<size_t>(j)] = 1;
    }
  }
  return all;
}

}  // namespace truestep::gltf
