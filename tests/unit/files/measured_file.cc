#include "tests/unit/files/measured_file.h"

#include <algorithm>
#include <boost/json.hpp>
#include <cmath>

#include "engine/geometry/mass_properties.h"
#include "engine/geometry/read/trc.h"
#include "engine/geometry/solid.h"
#include "engine/geometry/triangle_mesh.h"
#include "engine/scene/file_value.h"
#include "engine/systems/molecular/xyz.h"
#include "engine/systems/skeleton/recording.h"

namespace truestep::testing_files {

namespace {

std::vector<std::string> lines_of(const boost::json::value& v) {
  std::vector<std::string> out;
  for (const auto& line : v.as_array()) out.emplace_back(line.as_string());
  return out;
}

void add_word(std::string& list, const std::string& word) {
  list += (list.empty() ? "" : " ") + word;
}

void measure_points(const std::vector<Vec3>& vertices, MeasuredFile& out) {
  auto& n = out.numbers;
  n["vertices"] = static_cast<double>(vertices.size());
  n["x.max"] = n["z.max"] = -HUGE_VAL, n["y.min"] = HUGE_VAL;
  for (const Vec3& p : vertices) {
    n["x.max"] = std::max(n["x.max"], p.x), n["y.min"] = std::min(n["y.min"], p.y);
    n["z.max"] = std::max(n["z.max"], p.z);
  }
}

void measure_surface(const std::vector<Vec3>& vertices, const std::vector<uint32_t>& corners,
                     MeasuredFile& out) {
  measure_points(vertices, out);
  auto& n = out.numbers;
  n["triangles"] = static_cast<double>(corners.size() / 3);
  n["slivers"] = 0;
  for (size_t k = 0; k + 2 < corners.size(); k += 3) {
    const Vec3 a = vertices[corners[k]], b = vertices[corners[k + 1]], c = vertices[corners[k + 2]];
    const Vec3 face = cross(b - a, c - a) * 0.5;
    n["area"] += norm(face), n["facing.z"] += face.z, n["volume"] += dot(a, cross(b, c)) / 6;
    if (norm(face) < 1e-9) n["slivers"] += 1;
  }
  const Solid solid = mesh_solid(vertices, corners);
  if (solid.mesh->closed()) n["mass"] = mass_properties(solid, 1).mass;
}

void measure_value(const boost::json::value& value, MeasuredFile& out) {
  const auto& o = value.as_object();
  std::vector<Vec3> vertices;
  for (const auto& p : o.at("vertices").as_array())
    vertices.push_back(
        {p.at(0).to_number<double>(), p.at(1).to_number<double>(), p.at(2).to_number<double>()});
  if (const auto* cells = o.if_contains("cells")) {
    const size_t corners = o.at("form").as_string() == "triangles" ? 3 : 4;
    out.numbers["cells"] = static_cast<double>(cells->as_array().size() / corners);
    for (const auto& set : o.at("sets").as_array())
      add_word(out.words["sets"], std::string(set.at("name").as_string()));
    return measure_points(vertices, out);
  }
  std::vector<uint32_t> corners;
  for (const auto& c : o.at("triangles").as_array()) corners.push_back(c.to_number<uint32_t>());
  measure_surface(vertices, corners, out);
}

/// Shifts and turns of every joint at every frame, as "hand.x(0.5)" and "hand.turn(0.5)" (rad).
void measure_recording(const skeleton::Recording& r, MeasuredFile& out) {
  out.numbers["frames"] = static_cast<double>(r.frames);
  out.numbers["rate"] = 1 / r.frame_time;
  for (const auto& joint : r.joints) add_word(out.words["joints"], joint.name);
  for (size_t f = 0; f < r.frames; ++f) {
    const double t = static_cast<double>(f) * r.frame_time;
    char at[32];
    std::snprintf(at, sizeof at, "(%g)", std::round(1e6 * t) / 1e6);
    for (size_t j = 0; j < r.joints.size(); ++j) {
      const size_t row = f * r.joints.size() + j;
      const Quat& q = r.turns[row];
      const std::string& name = r.joints[j].name;
      out.numbers[name + ".x" + at] = r.shifts[row].x, out.numbers[name + ".y" + at] = r.shifts[row].y;
      out.numbers[name + ".turn" + at] =
          2 * std::atan2(std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z), std::abs(q.w));
    }
  }
}

void measure_gltf(const std::vector<std::string>& lines, MeasuredFile& out) {
  const GltfModel m = read_gltf(lines);
  if (!m.animations.empty()) measure_recording(skeleton::recording_of(m, "", 30), out);
  if (m.meshes.empty()) return;
  const GltfMesh& mesh = m.meshes[0];
  require_sound(mesh.fault);
  std::vector<uint32_t> corners;
  for (const auto& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  measure_surface(mesh.positions, corners, out);
  for (size_t k = 0; k < mesh.target_names.size(); ++k) {
    add_word(out.words["targets"], mesh.target_names[k]);
    double& most = out.numbers["target." + mesh.target_names[k]];
    for (const Vec3& offset : mesh.targets[k]) most = std::max(most, norm(offset));
  }
  if (mesh.weights.empty()) return;
  out.numbers["weight.largest"] = mesh.weights[0][0], out.numbers["joint.largest"] = mesh.joints[0][0];
}

void measure_markers(const MarkerTracks& m, MeasuredFile& out) {
  for (const std::string& name : m.names) add_word(out.words["markers"], name);
  out.numbers["frames"] = static_cast<double>(m.frames);
  for (size_t k = 0; k < m.places.size(); ++k)
    out.numbers["seen"] += m.seen[k], out.numbers["x.sum"] += m.places[k].x;
}

void measure_atoms(std::string_view text, MeasuredFile& out) {
  const molecular::XyzAtoms atoms = molecular::read_xyz(text);
  for (const std::string& name : atoms.names) add_word(out.words["atoms"], name);
  for (const Vec3& p : atoms.positions)
    out.numbers["x.sum"] += p.x, out.numbers["y.sum"] += p.y, out.numbers["z.sum"] += p.z;
  std::string& edges = out.words["lattice"];
  if (const auto lattice = molecular::read_xyz_lattice(text)) {
    for (size_t k = 0; k < 3; ++k) {
      char edge[32];
      std::snprintf(edge, sizeof edge, "%g", norm((*lattice)[k]));
      add_word(edges, edge);
    }
  }
}

void measure(std::string_view ending, std::string_view bytes, const std::string& use, MeasuredFile& out) {
  const auto as = [&](FileUse how) { return file_value(bytes, how, 1); };
  if (ending == ".bvh") {
    measure_recording(skeleton::recording_of(read_bvh(lines_of(as(FileUse::automatic)))), out);
  } else if (ending == ".gltf" || ending == ".glb") {
    measure_gltf(lines_of(as(FileUse::gltf)), out);
  } else if (ending == ".trc") {
    measure_markers(read_trc(lines_of(as(FileUse::lines))), out);
  } else if (ending == ".xyz") {
    measure_atoms(std::string(as(FileUse::text).as_string()), out);
  } else {
    measure_value(as(use == "surface" ? FileUse::surface : FileUse::automatic), out);
  }
}

}  // namespace

MeasuredFile measure_file(std::string_view ending, std::string_view bytes, const std::string& use) {
  MeasuredFile out;
  try {
    measure(ending, bytes, use, out);
  } catch (const molecular::XyzFault& f) {
    out.refused = "line " + std::to_string(f.line) + ": " + f.what();
  } catch (const std::exception& f) {
    out.refused = f.what();
  }
  return out;
}

}  // namespace truestep::testing_files
