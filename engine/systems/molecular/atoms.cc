#include "engine/systems/molecular/atoms.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/kernels/molecular/normal.h"
#include "engine/neighbours/point_grid.h"
#include "engine/systems/molecular/text_box.h"
#include "engine/systems/molecular/topology.h"
#include "engine/systems/molecular/xyz.h"

namespace truestep::molecular {
namespace {

/// Streams of random numbers.
constexpr uint64_t kVelocities = 0, kTurns = uint64_t{1} << 62;

constexpr Vec3 kFccSites[4] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};

size_t sites(const LatticeDef& d) {
  return d.arrangement == LatticeDef::Arrangement::fcc ? 4 : 1;
}
double spacing(const LatticeDef& d) {
  if (d.lattice_constant) return *d.lattice_constant;
  // A cube root with the same bits everywhere.
  const double volume = static_cast<double>(sites(d)) / d.number_density.value_or(1);
  const double a = trig::exp(trig::log(volume) / 3);
  return a - (a * a * a - volume) / (3 * a * a);
}
Vec3 extent(const LatticeDef& d) {
  return Vec3{double(d.cells[0]), double(d.cells[1]), double(d.cells[2])} * spacing(d);
}

void fill_lattice(const MolecularDef& def, Atoms& out) {
  const LatticeDef& d = *def.lattice;
  const double a = spacing(d);
  // Sites keep away from the box's sides by half their distance.
  const double inset = sites(d) == 4 ? 0.25 : 0.5;
  const Vec3 low = d.center - extent(d) * 0.5;
  std::vector<uint32_t> turn;
  for (const std::string& k : d.kinds) turn.push_back(static_cast<uint32_t>(kind_index(def, k)));
  if (turn.empty()) turn.push_back(0);
  for (int64_t z = 0; z < d.cells[2]; ++z) {
    for (int64_t y = 0; y < d.cells[1]; ++y) {
      for (int64_t x = 0; x < d.cells[0]; ++x) {
        for (size_t s = 0; s < sites(d); ++s) {
          const Vec3 at = Vec3{double(x), double(y), double(z)} + kFccSites[s] + Vec3{inset, inset, inset};
          // Simple cubic: kinds alternate along every axis, as in rock salt.
          const size_t n = sites(d) == 4 ? s : static_cast<size_t>(x + y + z);
          out.positions.push_back(low + at * a), out.kinds.push_back(turn[n % turn.size()]);
        }
      }
    }
  }
}

void fill_given(const MolecularDef& def, Atoms& out) {
  for (size_t i = 0; i < def.positions.size(); ++i) {
    const auto& names = def.position_kinds;
    const size_t k = names.empty() ? 0 : kind_index(def, names[names.size() == 1 ? 0 : i]);
    out.positions.push_back(def.positions[i]), out.kinds.push_back(static_cast<uint32_t>(k));
  }
  if (def.xyz.empty()) return;
  const XyzAtoms atoms = read_xyz(def.xyz);
  for (size_t i = 0; i < atoms.names.size(); ++i) {
    out.positions.push_back(atoms.positions[i] * def.xyz_unit);
    out.kinds.push_back(static_cast<uint32_t>(kind_index(def, atoms.names[i])));
  }
}

/// visit(place) for every molecule of water.
template <class Visit>
void for_waters(const WaterDef& d, Visit&& visit) {
  const auto at = [&](int64_t k, int64_t n) { return (double(k) - 0.5 * double(n - 1)) * d.spacing; };
  for (int64_t z = 0; z < d.cells[2]; ++z) {
    for (int64_t y = 0; y < d.cells[1]; ++y) {
      for (int64_t x = 0; x < d.cells[0]; ++x) {
        const Vec3 off{at(x, d.cells[0]), at(y, d.cells[1]), at(z, d.cells[2])};
        if (!d.radius || norm2(off) <= *d.radius * *d.radius) visit(d.center + off);
      }
    }
  }
}

void fill_water(const MolecularDef& def, uint64_t seed, Atoms& out) {
  const WaterDef& d = *def.water;
  const WaterShape shape = water_shape(def);
  const auto o = static_cast<uint32_t>(kind_index(def, d.oxygen)),
             h = static_cast<uint32_t>(kind_index(def, d.hydrogen));
  uint64_t molecule = 0;
  for_waters(d, [&](const Vec3& at) {
    const Vec3 axis = normalized(normal3(seed, kTurns, 2 * molecule));
    const Vec3 side = normalized(cross(axis, normal3(seed, kTurns, 2 * molecule + 1)), {0, 1, 0});
    ++molecule;
    const auto row = static_cast<uint32_t>(out.size());
    out.waters.push_back({row, row + 1, row + 2});
    const Vec3 down = axis * shape.height(), half = side * (0.5 * shape.hh);
    out.positions.insert(out.positions.end(), {at, at + down + half, at + down - half});
    out.kinds.insert(out.kinds.end(), {o, h, h});
  });
}

/// Normally distributed velocities without net momentum and without components along rigid sides, at exactly
/// the def's temperature.
void set_temperature(const MolecularDef& def, uint64_t seed, Atoms& out) {
  const auto mass = [&](size_t i) { return def.kinds[out.kinds[i]].mass; };
  double total = 0, twice = 0;
  Vec3 momentum;
  for (size_t i = 0; i < out.size(); ++i) {
    out.velocities[i] = normal3(seed, kVelocities, i) * std::sqrt(def.boltzmann * *def.temperature / mass(i));
  }
  for (const auto& w : out.waters) {
    const Triangle v =
        settle_velocities(water_shape(def), {out.positions[w[0]], out.positions[w[1]], out.positions[w[2]]},
                          {out.velocities[w[0]], out.velocities[w[1]], out.velocities[w[2]]});
    for (size_t k = 0; k < 3; ++k) out.velocities[w[k]] = v[k];
  }
  for (size_t i = 0; i < out.size(); ++i) momentum += out.velocities[i] * mass(i), total += mass(i);
  for (size_t i = 0; i < out.size(); ++i) {
    if (out.size() > 1) out.velocities[i] -= momentum / total;
    twice += mass(i) * norm2(out.velocities[i]);
  }
  const double freedoms =
      3.0 * static_cast<double>(out.size() - out.waters.size()) - (out.size() > 1 ? 3 : 0);
  const double scale = twice > 0 ? std::sqrt(freedoms * def.boltzmann * *def.temperature / twice) : 0;
  for (Vec3& v : out.velocities) v *= scale;
}

Cell cell_of(const MolecularDef& d) {
  const Vec3 edges = box_edges(d);
  const Vec3 center = d.box || !d.lattice ? d.center : d.lattice->center;
  if (d.sides == Sides::open) return {};
  return {d.sides, center - edges * 0.5, edges};
}

void check_places(const MolecularDef& d, const DefTable::Report& report) {
  Atoms atoms;
  atoms.cell = cell_of(d);
  fill_given(d, atoms);
  if (d.lattice) fill_lattice(d, atoms);
  if (d.water) fill_water(d, 0, atoms);
  check_topology(d, atoms.size(), report);
  std::vector<double> flat;
  for (const Vec3& x : atoms.positions) {
    const Vec3 at = atoms.cell.wrapped(x);
    flat.insert(flat.end(), {at.x, at.y, at.z});
  }
  // Large sets come from crystals, and reading a scene must be quick.
  constexpr size_t kMostCompared = 200'000;
  if (atoms.size() > kMostCompared) return;
  const double least = shortest_distance(d);
  PointGrid grid;
  grid.build(flat, std::max(least, 0.1 * d.cutoff));
  for (size_t k = 0; k < grid.size(); ++k) {
    bool found = false;
    grid.near(grid.position(k), [&](size_t begin, size_t end) {
      for (size_t q = begin; q < end && !found; ++q) {
        if (grid.point(q) >= grid.point(k)) continue;
        found = norm2(grid.position(q) - grid.position(k)) < least * least;
        if (found) {
          report(d.xyz.empty() ? "/positions" : "/xyz",
                 "atoms " + std::to_string(grid.point(q)) + " and " + std::to_string(grid.point(k)) +
                     " are nearer to each other than " + short_number(least) + " m");
        }
      }
    });
    if (found) return;
  }
}

void check_names(const MolecularDef& d, const std::vector<std::string>& names, const std::string& pointer,
                 const DefTable::Report& report) {
  for (size_t i = 0; i < names.size(); ++i) {
    if (kind_index(d, names[i]) == d.kinds.size()) {
      report(pointer + "/" + std::to_string(i), "there is no kind \"" + names[i] + "\"");
      return;
    }
  }
}

/// Whether the atoms can be counted and named.
bool check_sources(const MolecularDef& d, const DefTable::Report& report) {
  bool sound = true;
  const auto fault = [&](const std::string& pointer, const std::string& why) {
    sound = false, report(pointer, why);
  };
  for (size_t k = 0; k < d.kinds.size(); ++k) {
    if (kind_index(d, d.kinds[k].name) != k)
      fault("/kinds/" + std::to_string(k) + "/name", "two kinds have this name");
  }
  if (d.lattice) {
    const LatticeDef& l = *d.lattice;
    if (l.number_density.has_value() == l.lattice_constant.has_value()) {
      fault("/lattice", "give either number_density or lattice_constant");
    }
    check_names(d, l.kinds, "/lattice/kinds", fault);
  }
  if (d.water) {
    for (const auto& [name, pointer] :
         {std::pair(d.water->oxygen, "/water/oxygen"), std::pair(d.water->hydrogen, "/water/hydrogen")}) {
      if (kind_index(d, name) == d.kinds.size()) fault(pointer, "there is no kind \"" + name + "\"");
    }
  }
  if (d.position_kinds.size() > 1 && d.position_kinds.size() != d.positions.size()) {
    fault("/position_kinds", "give one for all, or as many as positions");
  }
  check_names(d, d.position_kinds, "/position_kinds", fault);
  if (!d.xyz.empty()) {
    try {
      const XyzAtoms atoms = read_xyz(d.xyz);
      for (size_t i = 0; i < atoms.names.size() && sound; ++i) {
        if (kind_index(d, atoms.names[i]) == d.kinds.size()) {
          fault("/xyz", "line " + std::to_string(i + 3) + ": there is no kind \"" + atoms.names[i] + "\"");
        }
      }
    } catch (const XyzFault& f) {
      fault("/xyz", "line " + std::to_string(f.line) + ": " + f.what());
    }
  }
  return sound;
}

}  // namespace

size_t kind_index(const MolecularDef& def, std::string_view name) {
  const auto is = [&](const KindDef& k) { return k.name == name; };
  return static_cast<size_t>(std::find_if(def.kinds.begin(), def.kinds.end(), is) - def.kinds.begin());
}

WaterShape water_shape(const MolecularDef& def) {
  const WaterDef& d = *def.water;
  return {def.kinds[kind_index(def, d.oxygen)].mass, def.kinds[kind_index(def, d.hydrogen)].mass, d.length,
          2 * d.length * trig::sin(0.5 * d.angle)};
}

double shortest_distance(const MolecularDef& def) {
  double sigma = 0;
  for (const KindDef& k : def.kinds) sigma = std::max(sigma, k.sigma);
  return sigma > 0 ? 0.01 * sigma : 1e-3 * def.cutoff;
}

Vec3 box_edges(const MolecularDef& d) {
  if (d.box) return *d.box;
  if (d.lattice && d.lattice->cells.size() == 3) return extent(*d.lattice);
  return box_of_text(d);
}

size_t atom_count(const MolecularDef& d) {
  double n = static_cast<double>(d.positions.size());
  if (d.lattice && d.lattice->cells.size() == 3) {
    const auto& c = d.lattice->cells;
    n += double(c[0]) * double(c[1]) * double(c[2]) * static_cast<double>(sites(*d.lattice));
  }
  if (d.water && d.water->cells.size() == 3) {
    const auto& c = d.water->cells;
    n += 3 * double(c[0]) * double(c[1]) * double(c[2]) * (d.water->radius ? 0.6 : 1);
  }
  // What the text says of itself, without reading the rest.
  if (!d.xyz.empty()) n += static_cast<double>(std::count(d.xyz.begin(), d.xyz.end(), '\n'));
  return static_cast<size_t>(std::min(n, 1e15));
}

void check_atoms(const MolecularDef& d, const DefTable::Report& report) {
  constexpr size_t kMost = 4'000'000;
  if (!check_sources(d, report)) return;
  const size_t n = atom_count(d);
  if (n == 0) return report("", "there are no atoms: give lattice, positions, xyz or water");
  if (n > kMost)
    return report("/lattice/cells",
                  std::string("there are more than ").append(std::to_string(kMost)) + " atoms");
  if (!d.velocities.empty() && d.velocities.size() != d.positions.size()) {
    return report("/velocities", "needs as many velocities as positions, or none");
  }
  if (d.sides == Sides::periodic) {
    if (!check_text_box(d, box_edges(d), report)) return;
    if (!d.box && !d.lattice && box_of_text(d) == Vec3{}) return report("/box", "a periodic box needs edges");
    const Vec3 e = cell_of(d).edges;
    const double least = std::min({e.x, e.y, e.z});
    if (!(least >= 2 * d.cutoff)) {
      return report("/box", "every edge must be at least two cut-offs, " + short_number(2 * d.cutoff) +
                                " m, or an atom would meet two images of another");
    }
    if (!(least >= d.cutoff + d.skin)) return report("/skin", "an edge must be at least cut-off + skin");
  }
  check_places(d, report);
}

Atoms make_atoms(const MolecularDef& def, uint64_t seed) {
  Atoms out;
  out.cell = cell_of(def);
  // Those with given positions come first: positions refer to the first rows.
  fill_given(def, out);
  if (def.lattice) fill_lattice(def, out);
  if (def.water) fill_water(def, seed, out);
  out.velocities.assign(out.size(), {});
  if (def.temperature) set_temperature(def, seed, out);
  for (size_t i = 0; i < def.velocities.size(); ++i) out.velocities[i] = def.velocities[i];
  return out;
}

}  // namespace truestep::molecular
