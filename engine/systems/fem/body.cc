#include "engine/systems/fem/body.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/math/expression/names.h"
#include "engine/systems/fem/fem_choice.h"

namespace truestep::fem {

namespace {

[[noreturn]] void refuse(const std::string& pointer, const std::string& code, const std::string& message,
                         const std::string& value) {
  throw Error("scene_invalid", pointer + ": " + message, {pointer, code, message, value, "", "", ""});
}

/// Compiles the texts of some components into a program over nodes; `variables` are their names.
ExpressionRows compile(const std::vector<std::pair<std::string, std::string>>& texts,
                       const std::vector<const char*>& variables) {
  ExpressionGraph graph;
  ExpressionNames names;
  int32_t number = 0;
  for (const char* name : variables) names.add_value(name, graph.variable(number++));
  std::vector<ExpressionGraph::Node> roots;
  for (const auto& [pointer, text] : texts) {
    try {
      roots.push_back(names.require(graph, text));
    } catch (const ExpressionFault& fault) {
      refuse(pointer, "bad_expression", describe(fault, text), '"' + text.substr(0, 80) + '"');
    }
  }
  try {
    return {graph, roots};
  } catch (const ExpressionFault& fault) {
    refuse(texts.front().first, "bad_expression", fault.message,
           '"' + texts.front().second.substr(0, 80) + '"');
  }
}

void set_geometry(const FemDef& def, Body& b) {
  const Element& kind = *b.mesh.kind;
  const size_t n = kind.size(), points = kind.points.size();
  b.masses.assign(b.mesh.x.size(), 0);
  std::vector<double> share(n);
  for (size_t k = 0; k < b.mesh.cells(); ++k) {
    double volume = 0, squares = 0;
    std::fill(share.begin(), share.end(), 0);
    for (size_t q = 0; q < points; ++q) {
      const Jacobian j = jacobian(b.mesh, k, q);
      const Mat3 back = transposed(inverse(j.j));
      const double w = kind.weights[q] * j.size * b.thickness;
      b.weights.push_back(w);
      volume += w;
      for (size_t a = 0; a < n; ++a) {
        const double value = kind.shape[q * n + a];
        share[a] += w * value * value, squares += w * value * value;
        b.gradients.push_back(back * kind.gradient[q * n + a]);
      }
    }
    // The rule is exact for the squares of products; simplices have exact weights of their own.
    for (size_t a = 0; a < n; ++a) {
      b.masses[b.mesh.cell(k)[a]] +=
          def.density * volume * (kind.simplex ? kind.lump[a] : share[a] / squares);
    }
  }
}

// G_k = |J0| / |J| J0^-T grad (1 - xi_k^2) of the modes 1 - xi_k^2: with J0 taken at the centre they pass the
// patch test.
void set_modes(Body& b) {
  const Element& kind = *b.mesh.kind;
  b.modes = kind.dimension;
  std::vector<double> n(kind.size());
  std::vector<Vec3> g(kind.size());
  shape_at(kind, {}, n, g);
  for (size_t cell = 0; cell < b.mesh.cells(); ++cell) {
    Mat3 j0;
    if (kind.dimension == 2) j0.m[8] = 1;
    size_t a = 0;
    for (const uint32_t p : b.mesh.cell(cell)) {
      const Vec3 &x = b.mesh.x[p], &d = g[a++];
      j0.m[0] += x.x * d.x, j0.m[1] += x.x * d.y, j0.m[2] += x.x * d.z;
      j0.m[3] += x.y * d.x, j0.m[4] += x.y * d.y, j0.m[5] += x.y * d.z;
      j0.m[6] += x.z * d.x, j0.m[7] += x.z * d.y, j0.m[8] += x.z * d.z;
    }
    const Mat3 back = transposed(inverse(j0));
    const double middle = determinant(j0);
    for (size_t q = 0; q < kind.points.size(); ++q) {
      const double share = middle / jacobian(b.mesh, cell, q).size;
      const Vec3& xi = kind.points[q];
      const Vec3 slopes[] = {{-2 * xi.x, 0, 0}, {0, -2 * xi.y, 0}, {0, 0, -2 * xi.z}};
      for (size_t k = 0; k < b.modes; ++k) b.mode_gradients.push_back(share * (back * slopes[k]));
    }
  }
}

// Adds the integral of N_a over a facet at rest, times the traction there; returns the area.
double add_traction(const Body& b, const Facet& f, const ExpressionRows* traction, uint8_t axes,
                    const Vec3& even, std::vector<double>& out) {
  const Element& face = b.mesh.facet_kind(f);
  const size_t n = face.size();
  double whole = 0;
  for (size_t q = 0; q < face.points.size(); ++q) {
    Vec3 at, along, across;
    for (size_t a = 0; a < n; ++a) {
      const Vec3& x = b.mesh.x[b.mesh.facet_node(f, a)];
      at += face.shape[q * n + a] * x;
      along += face.gradient[q * n + a].x * x;
      across += face.gradient[q * n + a].y * x;
    }
    if (b.plane) across = {0, 0, b.thickness};
    const bool rim = b.mesh.sheet && f.face != Facet::kWhole;
    const double area = face.weights[q] * (rim ? b.thickness * norm(along) : norm(cross(along, across)));
    whole += area;
    double t[3] = {even.x, even.y, even.z};
    if (traction) {
      const ExpressionRows::Column in[] = {{&at.x, 0}, {&at.y, 0}, {&at.z, 0}};
      std::vector<ExpressionRows::Output> results;
      for (size_t c = 0; c < 3; ++c) {
        if (axes >> c & 1) results.push_back({&t[c], 1});
      }
      traction->run(in, results, 0, 1);
    }
    for (size_t a = 0; a < n; ++a) {
      for (size_t c = 0; c < 3; ++c)
        out[3 * b.mesh.facet_node(f, a) + c] += area * face.shape[q * n + a] * t[c];
    }
  }
  return whole;
}

using Texts = std::vector<std::pair<std::string, std::string>>;
template <class D>
uint8_t texts_of(const D& d, const std::string& pointer, Texts& out) {
  uint8_t axes = 0;
  const std::pair<const char*, const std::optional<std::string>*> parts[] = {
      {"/x", &d.x}, {"/y", &d.y}, {"/z", &d.z}};
  for (uint8_t c = 0; c < 3; ++c) {
    if (!*parts[c].second) continue;
    out.emplace_back(pointer + parts[c].first, **parts[c].second);
    axes = static_cast<uint8_t>(axes | 1u << c);
  }
  return axes;
}

void set_loads(const FemDef& def, Body& b) {
  b.loads.assign(3 * b.mesh.x.size(), 0);
  for (size_t k = 0; k < def.loads.size(); ++k) {
    const LoadDef& load = def.loads[k];
    const std::string pointer = "/loads/" + std::to_string(k);
    const std::vector<Facet> facets = b.mesh.facets_of(*b.mesh.find(load.on));
    if (facets.empty()) {
      refuse(pointer + "/on", "no_surface", "no face of the surface has all of its nodes in this set",
             '"' + load.on + '"');
    }
    if (load.pressure) {
      if (b.mesh.sheet && facets.front().face != Facet::kWhole)
        refuse(pointer + "/pressure", "no_surface", "no element has all of its nodes in this set",
               '"' + load.on + '"');
      for (const Facet& f : facets) b.pressures.push_back({f, *load.pressure});
      continue;
    }
    if (load.force) {
      std::vector<double> scratch(b.loads.size());
      double area = 0;
      for (const Facet& f : facets) area += add_traction(b, f, nullptr, 0, {}, scratch);
      for (const Facet& f : facets) add_traction(b, f, nullptr, 0, *load.force / area, b.loads);
      continue;
    }
    Texts texts;
    const uint8_t axes = texts_of(load, pointer, texts);
    const ExpressionRows rows = compile(texts, {"X", "Y", "Z"});
    for (const Facet& f : facets) add_traction(b, f, &rows, axes, {}, b.loads);
  }
  for (const double f : b.loads) {
    if (!std::isfinite(f))
      refuse("/loads", "not_finite", "a load is not finite somewhere on its surface", "");
  }
}

void set_holds(const FemDef& def, Body& b) {
  b.axes.assign(b.mesh.x.size(), b.plane ? 4 : 0);
  std::vector<double> held(3 * b.mesh.x.size(), NAN);
  for (size_t k = 0; k < def.holds.size(); ++k) {
    const HoldDef& d = def.holds[k];
    const std::string pointer = "/holds/" + std::to_string(k);
    Hold hold{.nodes = b.mesh.find(d.on)->nodes, .axes = 0, .displacement = {}};
    Texts texts;
    hold.axes = texts_of(d, pointer, texts);
    if (texts.empty()) {
      texts = {{pointer, "0"}, {pointer, "0"}, {pointer, "0"}};
      hold.axes = 7;
    }
    hold.displacement = compile(texts, {"t", "X", "Y", "Z"});
    // At two times, to tell whether two holds ask the same of a node.
    for (const double t : {0.0, 1.0}) {
      for (const uint32_t p : hold.nodes) {
        const Vec3& x = b.mesh.x[p];
        const ExpressionRows::Column in[] = {{&t, 0}, {&x.x, 0}, {&x.y, 0}, {&x.z, 0}};
        double want[3] = {};
        std::vector<ExpressionRows::Output> out;
        for (size_t c = 0; c < 3; ++c) {
          if (hold.axes >> c & 1) out.push_back({&want[c], 1});
        }
        hold.displacement.run(in, out, 0, 1);
        for (size_t c = 0; c < 3; ++c) {
          if (!(hold.axes >> c & 1)) continue;
          if (!std::isfinite(want[c])) {
            refuse(pointer, "not_finite", "the displacement of node " + std::to_string(p) + " is not finite",
                   "");
          }
          const bool other = b.axes[p] >> c & 1 && !(b.plane && c == 2);
          if (t == 0 && !other) held[3 * p + c] = want[c];
          if (t == 0 && other && std::abs(held[3 * p + c] - want[c]) > 1e-9 * (1 + std::abs(want[c]))) {
            refuse(pointer, "contradiction",
                   "node " + std::to_string(p) + " is fixed at another position by an earlier hold",
                   '"' + d.on + '"');
          }
        }
      }
    }
    for (const uint32_t p : hold.nodes) b.axes[p] = static_cast<uint8_t>(b.axes[p] | hold.axes);
    b.holds.push_back(std::move(hold));
  }
  for (const int64_t p : def.pins) b.pins.push_back(static_cast<uint32_t>(p));
  for (const auto* names : {&def.pinned, &def.clamped}) {
    for (const std::string& name : *names) {
      const auto& nodes = b.mesh.find(name)->nodes;
      b.pins.insert(b.pins.end(), nodes.begin(), nodes.end());
    }
  }
  std::sort(b.pins.begin(), b.pins.end());
  b.pins.erase(std::unique(b.pins.begin(), b.pins.end()), b.pins.end());
  for (const uint32_t p : b.pins) {
    for (size_t c = 0; c < 3; ++c) {
      if (std::isnan(held[3 * p + c]) || held[3 * p + c] == 0) continue;
      refuse("/holds", "contradiction", "node " + std::to_string(p) + " is pinned and displaced at once", "");
    }
  }
}

// Groups of consecutive elements, so that what a group needs lies together in memory; groups are coloured
// greedily, in their order.
void set_groups(Body& b) {
  constexpr size_t kMost = 64, kLeast = 8, kWanted = 64, kLastColour = 63;
  const size_t cells = b.mesh.cells(), size = std::clamp(cells / kWanted, kLeast, kMost);
  std::vector<uint64_t> used(b.mesh.x.size(), 0);
  std::vector<std::vector<Body::Group>> colours;
  for (uint32_t k = 0; k < cells;) {
    const Body::Group group{k, static_cast<uint32_t>(std::min(k + size, cells))};
    uint64_t taken = 0;
    for (; k < group.end; ++k) {
      for (const uint32_t p : b.mesh.cell(k)) taken |= used[p];
    }
    size_t colour = 0;
    while (colour < kLastColour && taken >> colour & 1) ++colour;
    if (colour >= colours.size()) colours.resize(colour + 1);
    colours[colour].push_back(group);
    // The last colour is never marked: its groups are kept apart below.
    if (colour == kLastColour) continue;
    for (uint32_t c = group.begin; c < group.end; ++c) {
      for (const uint32_t p : b.mesh.cell(c)) used[p] |= uint64_t{1} << colour;
    }
  }
  b.colours = {0};
  for (size_t c = 0; c < colours.size(); ++c) {
    for (const Body::Group& group : colours[c]) {
      b.groups.push_back(group);
      // Groups left without a colour may share nodes: one by one.
      if (c == kLastColour) b.colours.push_back(b.groups.size());
    }
    if (c != kLastColour) b.colours.push_back(b.groups.size());
  }
}

std::vector<uint8_t> clamped_nodes(const FemDef& def, const Mesh& mesh) {
  std::vector<uint8_t> out(mesh.x.size(), 0);
  for (const std::string& name : def.clamped) {
    for (const uint32_t p : mesh.find(name)->nodes) out[p] = 1;
  }
  return out;
}

void set_pattern(Body& b) {
  const size_t n = b.size();
  for (size_t k = 0; k < b.mesh.cells(); ++k) {
    const auto nodes = b.mesh.cell(k);
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = i + 1; j < n; ++j)
        b.pairs.push_back({std::min(nodes[i], nodes[j]), std::max(nodes[i], nodes[j])});
    }
  }
  b.bending.add_pairs(b.pairs);
  std::sort(b.pairs.begin(), b.pairs.end());
  b.pairs.erase(std::unique(b.pairs.begin(), b.pairs.end()), b.pairs.end());
  b.pairs.shrink_to_fit();
  BlockSparse pattern;
  pattern.set_pattern(b.mesh.x.size(), 3, b.pairs);
  b.slots.reserve(b.mesh.cells() * n * n);
  for (size_t k = 0; k < b.mesh.cells(); ++k) {
    for (const uint32_t i : b.mesh.cell(k)) {
      for (const uint32_t j : b.mesh.cell(k)) b.slots.push_back(pattern.slot(i, j));
    }
  }
  b.bending.find_slots(pattern);
}

}  // namespace

Body build_body(const FemDef& def) {
  Body b;
  b.mesh = build_mesh(def);
  b.plane = in_plane(def);
  b.plane_stress = b.plane && def.plane == Plane::stress;
  b.mean_volume = volume_of(def) == Volume::mean;
  if (def.incompatible_modes == Incompatible::wilson) set_modes(b);
  if (b.mesh.kind->dimension == 2) b.thickness = def.plane_thickness;
  set_geometry(def, b);
  set_loads(def, b);
  set_holds(def, b);
  if (def.plane == Plane::shell) b.bending = Bending(b.mesh, clamped_nodes(def, b.mesh), def.poisson_ratio);
  set_groups(b);
  set_pattern(b);
  return b;
}

}  // namespace truestep::fem
